"""The lightmap file: one OpenEXR file per page, ``lightmap.exr``, ``lightmap.1.exr``, ….

Single-part files and not one multi-part file, because most tools (Blender, Unity, Photoshop) open only
a file's first part. Channels R, G and B are E/π itself in float32, linear Rec.709, whatever the scale;
``coverage`` is the share of the texel that charts cover, and dilated texels beyond charts have 0.

Attributes (text or number) of every page::

    irradia:version    1
    irradia:quantity   irradiance_over_pi: the radiance of a white diffuse surface, W·sr⁻¹·m⁻²
    irradia:scale      power of two; values over it have their 99.9th percentile near 1: what
                       encodings of little range divide by
    irradia:exposure   stops: multiply by 2^exposure for a preview
    irradia:page       this page, from 0
    irradia:pages      how many there are
    irradia:provenance JSON
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from irradia.core.colour import automatic_exposure_ev
from irradia.core.errors import InputError
from irradia.formats.exr import ExrImage, read_exr_image, read_exr_metadata, rgb_from_channels, write_exr

VERSION = 1
QUANTITY = "irradiance_over_pi"
SCALE_PERCENTILE = 99.9
_PREFIX = "irradia:"
_MAX_PAGES = 1024


@dataclass(frozen=True)
class LightmapFile:
    """All pages of a lightmap.

    Attributes:
        pages: (P, H, W, 3) float32 E/π, linear Rec.709, row 0 at v = 0.
        coverage: (P, H, W) float32 in [0, 1]; 0 where no chart lies.
        scale: Power of two near the 99.9th percentile of what is covered.
        exposure_ev: Automatic exposure for previews, in stops.
        quantity: What a value is.
        provenance: Anything that JSON holds: inputs, config, seed, versions, device, times.
    """

    pages: NDArray[np.float32]
    coverage: NDArray[np.float32]
    scale: float
    exposure_ev: float
    quantity: str = QUANTITY
    provenance: Mapping[str, Any] = field(default_factory=dict)

    @property
    def covered(self) -> NDArray[np.bool_]:
        """(P, H, W): where a chart touches the texel."""
        return self.coverage > 0.0


def make_lightmap(
    pages: NDArray[np.float32], coverage: NDArray[np.float32], provenance: Mapping[str, Any] | None = None
) -> LightmapFile:
    """A lightmap of pages (P, H, W, 3) whose scale and exposure come from the covered texels."""
    lit = pages[coverage > 0.0]
    return LightmapFile(
        pages=np.asarray(pages, np.float32),
        coverage=np.asarray(coverage, np.float32),
        scale=power_of_two_scale(lit),
        exposure_ev=automatic_exposure_ev(lit),
        provenance=provenance or {},
    )


def power_of_two_scale(values: NDArray, percentile: float = SCALE_PERCENTILE) -> float:
    """The power of two nearest, in stops, to the brightest channel's percentile; 1 for black.

    Args:
        values: (…, 3).
        percentile: Of the texels' largest channels.
    """
    if values.size == 0:
        return 1.0
    high = float(np.percentile(values.reshape(-1, 3).max(axis=1), percentile))
    return 2.0 ** round(np.log2(high)) if high > 0.0 else 1.0


def page_path(path: Path | str, page: int) -> Path:
    """``lightmap.exr`` for page 0, ``lightmap.1.exr`` for page 1 and so on."""
    first = Path(path)
    return first if page == 0 else first.with_name(f"{first.stem}.{page}{first.suffix}")


def write_lightmap(path: Path | str, lightmap: LightmapFile) -> tuple[Path, ...]:
    """Writes one file per page and returns their paths, page 0 first."""
    paths = tuple(page_path(path, page) for page in range(len(lightmap.pages)))
    for page, file in enumerate(paths):
        channels = {name: lightmap.pages[page, ..., index] for index, name in enumerate("RGB")}
        channels["coverage"] = lightmap.coverage[page].astype(np.float32)
        write_exr(file, channels, _attributes(lightmap, page))
    return paths


def read_lightmap(path: Path | str) -> LightmapFile:
    """Reads a lightmap by its first page; the others lie beside it.

    Raises:
        InputError: A page is missing, damaged, of another size, or no lightmap of this version.
    """
    first = read_exr_image(path)
    n_pages = _count(first, "pages", path)
    if not 1 <= n_pages <= _MAX_PAGES:
        raise InputError(f"expected 1 to {_MAX_PAGES} pages, found {n_pages}", where=str(path))
    images = [first, *(read_exr_image(page_path(path, page)) for page in range(1, n_pages))]
    for page, image in enumerate(images):
        _check_page(image, first, page, page_path(path, page))
    return LightmapFile(
        pages=np.stack([rgb_from_channels(image.channels, str(path)) for image in images]),
        coverage=np.stack([image.channels["coverage"].astype(np.float32) for image in images]),
        scale=float(_attribute(first, "scale", path)),
        exposure_ev=float(_attribute(first, "exposure", path)),
        quantity=str(_attribute(first, "quantity", path)),
        provenance=_provenance(first, path),
    )


def is_lightmap(path: Path | str) -> bool:
    """Whether an OpenEXR file is a lightmap's page, as ``irradia compare`` asks."""
    return _PREFIX + "quantity" in read_exr_metadata(path)


def _attributes(lightmap: LightmapFile, page: int) -> dict[str, str | int | float]:
    values: dict[str, str | int | float] = {
        "version": VERSION,
        "quantity": lightmap.quantity,
        "scale": lightmap.scale,
        "exposure": lightmap.exposure_ev,
        "page": page,
        "pages": len(lightmap.pages),
        "provenance": json.dumps(lightmap.provenance, sort_keys=True),
    }
    return {_PREFIX + key: value for key, value in values.items()}


def _attribute(image: ExrImage, key: str, path: Path | str) -> str | int | float:
    value = image.metadata.get(_PREFIX + key)
    if value is None:
        raise InputError(
            f"expected a lightmap, but attribute '{_PREFIX}{key}' is missing",
            where=str(path),
            fix="Make one with `irradia bake`.",
        )
    return value


def _count(image: ExrImage, key: str, path: Path | str) -> int:
    value = _attribute(image, key, path)
    if not isinstance(value, int):
        raise InputError(f"expected '{_PREFIX}{key}' to be a whole number, found {value!r}", where=str(path))
    return value


def _check_page(image: ExrImage, first: ExrImage, page: int, path: Path) -> None:
    version = _count(image, "version", path)
    if version != VERSION:
        raise InputError(f"expected lightmap version {VERSION}, found {version}", where=str(path))
    if _count(image, "page", path) != page or _count(image, "pages", path) != _count(first, "pages", path):
        raise InputError("this page belongs to another lightmap", where=str(path), fix="Bake again.")
    if "coverage" not in image.channels:
        raise InputError("expected a channel 'coverage'", where=str(path))
    if image.channels["coverage"].shape != first.channels["coverage"].shape:
        raise InputError("this page has another size than the first", where=str(path), fix="Bake again.")


def _provenance(image: ExrImage, path: Path | str) -> dict[str, Any]:
    try:
        return dict(json.loads(str(_attribute(image, "provenance", path))))
    except (ValueError, TypeError) as error:
        raise InputError(f"its provenance is no JSON object: {error}", where=str(path)) from error
