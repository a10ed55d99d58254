"""The lightmap file: one OpenEXR file per page, ``lightmap.exr``, ``lightmap.1.exr``, ….

Single-part files and not one multi-part file, because most tools (Blender, Unity, Photoshop) open only
a file's first part. Channels R, G and B are E/π in units of ``irradia:unit``, linear Rec.709: E/π itself in
float32, or E/π over the scale in half floats, so that they don't overflow. ``coverage`` is the share of the
texel that charts cover, and dilated texels beyond charts have 0. Further channels hold whatever the bake
knows of texels, under its name: ``validity`` in [0, 1], ``samples`` as a count.

Attributes (text or number) of every page, of this and of the other formats that hold lightmaps::

    irradia:version    2; 1 was the same without a unit, which was 1
    irradia:quantity   irradiance_over_pi: the radiance of a white diffuse surface, W·sr⁻¹·m⁻²
    irradia:unit       power of two: what a stored 1 stands for; 1 or the scale
    irradia:scale      power of two; values over it have their 99.9th percentile near 1: what
                       encodings of little range divide by
    irradia:exposure   stops: multiply by 2^exposure for a preview
    irradia:page       this page, from 0
    irradia:pages      how many there are
    irradia:provenance JSON; in OpenEXR files alone
"""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from irradia.core.colour import automatic_exposure_ev
from irradia.core.errors import InputError
from irradia.formats.exr import ExrImage, read_exr_image, read_exr_metadata, rgb_from_channels, write_exr
from irradia.formats.limits import HALF_MAX

VERSION = 2
QUANTITY = "irradiance_over_pi"
SCALE_PERCENTILE = 99.9
PREFIX = "irradia:"
_READABLE = (1, VERSION)
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
        extra: Further channels by name, each (P, H, W); float16, float32 and uint32 keep their type.
    """

    pages: NDArray[np.float32]
    coverage: NDArray[np.float32]
    scale: float
    exposure_ev: float
    quantity: str = QUANTITY
    provenance: Mapping[str, Any] = field(default_factory=dict)
    extra: Mapping[str, NDArray] = field(default_factory=dict)

    @property
    def covered(self) -> NDArray[np.bool_]:
        """(P, H, W): where a chart touches the texel."""
        return self.coverage > 0.0


def make_lightmap(
    pages: NDArray[np.float32],
    coverage: NDArray[np.float32],
    provenance: Mapping[str, Any] | None = None,
    extra: Mapping[str, NDArray] | None = None,
) -> LightmapFile:
    """A lightmap of pages (P, H, W, 3) whose scale and exposure come from the covered texels."""
    lit = pages[coverage > 0.0]
    return LightmapFile(
        pages=np.asarray(pages, np.float32),
        coverage=np.asarray(coverage, np.float32),
        scale=power_of_two_scale(lit),
        exposure_ev=automatic_exposure_ev(lit),
        provenance=provenance or {},
        extra=extra or {},
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


def write_lightmap(path: Path | str, lightmap: LightmapFile, *, half: bool = False) -> tuple[Path, ...]:
    """Writes one file per page and returns their paths, page 0 first; see :func:`write_lightmap_page`."""
    paths = tuple(page_path(path, page) for page in range(len(lightmap.pages)))
    for page, file in enumerate(paths):
        write_lightmap_page(file, lightmap, page, half=half)
    return paths


def write_lightmap_page(path: Path | str, lightmap: LightmapFile, page: int, *, half: bool = False) -> None:
    """Writes one page.

    Args:
        path: Its file.
        lightmap: Of which it is a part.
        page: Which.
        half: Whether colours and coverage become half floats, colours after division by the scale.
    """
    unit = lightmap.scale if half else 1.0
    dtype = np.float16 if half else np.float32
    rgb = half_over(lightmap.pages[page], unit) if half else lightmap.pages[page]
    channels: dict[str, NDArray] = {name: rgb[..., index] for index, name in enumerate("RGB")}
    channels["coverage"] = lightmap.coverage[page].astype(dtype)
    channels.update({name: plane[page] for name, plane in lightmap.extra.items()})
    provenance = json.dumps(lightmap.provenance, sort_keys=True)
    write_exr(path, channels, page_attributes(lightmap, page, unit) | {PREFIX + "provenance": provenance})


def half_over(rgb: NDArray, unit: float) -> NDArray[np.float16]:
    """Values over ``unit`` as half floats; those beyond their range become the largest."""
    over = np.asarray(rgb, np.float32) * np.float32(1.0 / unit)
    return np.clip(over, -HALF_MAX, HALF_MAX, out=over).astype(np.float16)


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
    unit = np.float32(unit_of(first.metadata, path))
    return LightmapFile(
        pages=np.stack([rgb_from_channels(image.channels, str(path)) * unit for image in images]),
        coverage=np.stack([image.channels["coverage"].astype(np.float32) for image in images]),
        scale=float(_attribute(first, "scale", path)),
        exposure_ev=float(_attribute(first, "exposure", path)),
        quantity=str(_attribute(first, "quantity", path)),
        provenance=_provenance(first, path),
        extra={name: np.stack([image.channels[name] for image in images]) for name in _extra(first)},
    )


def is_lightmap(path: Path | str) -> bool:
    """Whether an OpenEXR file is a lightmap's page, as ``irradia compare`` asks."""
    return PREFIX + "quantity" in read_exr_metadata(path)


def page_attributes(lightmap: LightmapFile, page: int, unit: float) -> dict[str, str | int | float]:
    """What a page's file says of it, whatever its format; see the module. Without provenance.

    Args:
        lightmap: Of which the page is a part.
        page: Which.
        unit: What a stored 1 stands for.
    """
    values: dict[str, str | int | float] = {
        "version": VERSION,
        "quantity": lightmap.quantity,
        "unit": unit,
        "scale": lightmap.scale,
        "exposure": lightmap.exposure_ev,
        "page": page,
        "pages": len(lightmap.pages),
    }
    return {PREFIX + key: value for key, value in values.items()}


def unit_of(attributes: Mapping[str, str | int | float], path: Path | str) -> float:
    """What a stored 1 stands for, by a page's attributes as numbers or as text.

    Raises:
        InputError: They are no lightmap's, of another version, or the unit is no power of two.
    """
    quantity, version = attributes.get(PREFIX + "quantity"), attributes.get(PREFIX + "version")
    if quantity is None:
        raise _no_lightmap("quantity", path)
    if str(version) not in map(str, _READABLE):
        raise InputError(f"expected lightmap version {VERSION}, found {version}", where=str(path))
    found = attributes.get(PREFIX + "unit", 1.0)
    try:
        unit = float(found)
    except ValueError:
        unit = math.nan
    # Within the range of a float32 whatever is stored.
    if not 2.0**-100 <= unit <= 2.0**100 or math.frexp(unit)[0] != 0.5:
        raise InputError(f"expected '{PREFIX}unit' to be a power of two, found {found!r}", where=str(path))
    return unit


def _attribute(image: ExrImage, key: str, path: Path | str) -> str | int | float:
    value = image.metadata.get(PREFIX + key)
    if value is None:
        raise _no_lightmap(key, path)
    return value


def _no_lightmap(key: str, path: Path | str) -> InputError:
    return InputError(
        f"expected a lightmap, but attribute '{PREFIX}{key}' is missing",
        where=str(path),
        fix="Make one with `irradia bake`.",
    )


def _extra(image: ExrImage) -> list[str]:
    return sorted(set(image.channels) - {*"RGB", "coverage"})


def _count(image: ExrImage, key: str, path: Path | str) -> int:
    value = _attribute(image, key, path)
    if not isinstance(value, int):
        raise InputError(f"expected '{PREFIX}{key}' to be a whole number, found {value!r}", where=str(path))
    return value


def _check_page(image: ExrImage, first: ExrImage, page: int, path: Path) -> None:
    unit_of(image.metadata, path)
    if _count(image, "page", path) != page or _count(image, "pages", path) != _count(first, "pages", path):
        raise InputError("this page belongs to another lightmap", where=str(path), fix="Bake again.")
    if "coverage" not in image.channels:
        raise InputError("expected a channel 'coverage'", where=str(path))
    if set(image.channels) != set(first.channels):
        raise InputError("this page has other channels than the first", where=str(path), fix="Bake again.")
    if image.channels["coverage"].shape != first.channels["coverage"].shape:
        raise InputError("this page has another size than the first", where=str(path), fix="Bake again.")


def _provenance(image: ExrImage, path: Path | str) -> dict[str, Any]:
    try:
        return dict(json.loads(str(_attribute(image, "provenance", path))))
    except (ValueError, TypeError) as error:
        raise InputError(f"its provenance is no JSON object: {error}", where=str(path)) from error
