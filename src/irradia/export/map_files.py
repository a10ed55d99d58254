"""Lightmaps in the formats that engines read: one file per page and format, and all of them back.

docs/formats.md compares the formats. Every file says what its values are (``irradia:quantity``), what a
stored 1 stands for (``irradia:unit``) and the map's power-of-two scale; ``formats.lightmap`` lists the keys.
"""

from __future__ import annotations

import difflib
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from irradia.core.errors import InputError
from irradia.core.files import write_atomic
from irradia.formats.ktx2_texels import Encoding
from irradia.formats.lightmap import LightmapFile, page_attributes, page_path, unit_of, write_lightmap_page

DEFAULT_FORMATS = ("exr",)
_RIM_PX = 2  # one that a bilinear lookup reaches, and one for a uv's rounding
_RIM_WEIGHT = 0.25  # a lookup there is mostly of the chart's own texels


@dataclass(frozen=True)
class MapFormat:
    """A way to store pages.

    Attributes:
        name: As ``--format`` takes it.
        ending: Of the file's name; page 1's goes before the last dot.
        write: Writes one page: path, lightmap, page, mip levels where the format has them.
    """

    name: str
    ending: str
    write: Callable[[Path, LightmapFile, int, int], None]


@dataclass(frozen=True)
class MapPage:
    """One page as it was read.

    Attributes:
        rgb: (H, W, 3) linear E/π.
        coverage: (H, W) share of each texel that charts cover; None where the format doesn't say.
    """

    rgb: NDArray[np.float32]
    coverage: NDArray[np.float32] | None


def write_maps(
    folder: Path | str,
    lightmap: LightmapFile,
    formats: Sequence[str] = DEFAULT_FORMATS,
    *,
    n_levels: int = 1,
    name: str = "lightmap",
) -> list[Path]:
    """Writes every page in every format, one file at a time, each whole or not at all.

    Args:
        folder: Where to: ``lightmap.exr``, ``lightmap.1.exr``, ``lightmap.rgb9e5.ktx2``, ….
        lightmap: What.
        formats: Names of ``FORMATS``.
        n_levels: Mip levels of KTX2 files.
        name: What the files' names begin with.

    Returns:
        The files, format by format, page 0 first.

    Raises:
        InputError: A format is unknown.
    """
    paths = []
    for chosen in [_format(each) for each in formats]:
        for page in range(len(lightmap.pages)):
            path = page_path(Path(folder) / (name + chosen.ending), page)
            chosen.write(path, lightmap, page, n_levels)
            paths.append(path)
    return paths


def parse_formats(text: str) -> tuple[str, ...]:
    """``"exr,ktx2-half"`` as names of ``FORMATS``, each once, in the order given; ``"all"`` as all.

    Raises:
        InputError: One is unknown, or there is none.
    """
    names = [name.strip().lower() for name in text.split(",") if name.strip()]
    if not names:
        raise InputError("expected at least one format", where="--format", fix=f"Choose of {_all_names()}.")
    if names == ["all"]:
        return tuple(FORMATS)
    return tuple(dict.fromkeys(_format(name).name for name in names))


def read_map(path: Path | str) -> NDArray[np.float32]:
    """Reads one page of any of the formats as (H, W, 3) linear E/π; errors as :func:`read_map_page`."""
    return read_map_page(path).rgb


def is_map(path: Path | str) -> bool:
    """Whether a file is a page of ours by its ending and its attributes, whose pixels aren't read.

    Radiance HDR files hold E/π as it is, ours like any other: they need no telling apart, and count as no.
    """
    from irradia.formats.lightmap import is_lightmap
    from irradia.formats.rgbm import is_rgbm_png

    suffix = Path(path).suffix.lower()
    tells = {".exr": is_lightmap, ".png": is_rgbm_png, ".ktx2": lambda _: True}
    return suffix in tells and tells[suffix](path)


def read_map_page(path: Path | str) -> MapPage:
    """Reads one page of any of the formats.

    Raises:
        InputError: No such file, no lightmap of ours, damaged, or too large.
    """
    reader = _READERS.get(Path(path).suffix.lower())
    if reader is None:
        raise InputError(
            f"expected a lightmap ending in {', '.join(_READERS)}, found {Path(path).name}", where=str(path)
        )
    try:
        rgb, attributes, coverage = reader(path)
        return MapPage(rgb * np.float32(unit_of(attributes, path)), coverage)
    except MemoryError as error:
        raise InputError("this map takes more memory than there is", where=str(path)) from error


def texel_weights(lightmap: LightmapFile, page: int) -> NDArray[np.float32]:
    """How much errors of a page's texels count in BC6H, and texels in smaller mip levels.

    (H, W): 1 on charts, less on the rim that bilinear lookups reach, 0 beyond and where nothing is.
    """
    covered = lightmap.coverage[page] > 0.0
    reached = covered.copy()
    for rows in (reached, reached.T):
        for _ in range(_RIM_PX):
            before = rows.copy()
            rows[1:] |= before[:-1]
            rows[:-1] |= before[1:]
    filled = (lightmap.pages[page] > 0.0).any(axis=-1)
    return np.where(covered, 1.0, np.where(reached & filled, _RIM_WEIGHT, 0.0)).astype(np.float32)


def _write_exr(path: Path, lightmap: LightmapFile, page: int, _levels: int, *, half: bool) -> None:
    write_lightmap_page(path, lightmap, page, half=half)


def _write_hdr(path: Path, lightmap: LightmapFile, page: int, _levels: int) -> None:
    from irradia.formats.hdr import write_hdr

    write_hdr(path, lightmap.pages[page], _text(lightmap, page, 1.0))


def _write_rgbm(path: Path, lightmap: LightmapFile, page: int, _levels: int, *, gamma: float) -> None:
    from irradia.formats.rgbm import RgbmCoding, write_rgbm_png

    coding = RgbmCoding(gamma=gamma)
    values = _over_scale(lightmap, page)
    clipped = int(np.count_nonzero((values > coding.largest).any(axis=-1)))
    text = _text(lightmap, page, lightmap.scale) | {"irradia:rgbm_clipped": str(clipped)}
    write_rgbm_png(path, values, coding, text)


def _write_ktx2(path: Path, lightmap: LightmapFile, page: int, n_levels: int, *, encoding: Encoding) -> None:
    from irradia.formats.ktx2 import encode_ktx2

    data = encode_ktx2(
        _over_scale(lightmap, page)[None],
        encoding,
        _text(lightmap, page, lightmap.scale),
        coverage=texel_weights(lightmap, page)[None],
        n_levels=n_levels,
    )
    with write_atomic(path) as stream:
        stream.write(data)


def _over_scale(lightmap: LightmapFile, page: int) -> NDArray[np.float32]:
    return np.asarray(lightmap.pages[page], np.float32) * np.float32(1.0 / lightmap.scale)


def _text(lightmap: LightmapFile, page: int, unit: float) -> dict[str, str]:
    return {key: str(value) for key, value in page_attributes(lightmap, page, unit).items()}


# Stored colour, attributes, coverage.
_Page = tuple[NDArray[np.float32], "dict[str, str | int | float]", "NDArray[np.float32] | None"]


def _read_exr(path: Path | str) -> _Page:
    from irradia.formats.exr import read_exr_image, rgb_from_channels

    image = read_exr_image(path)
    coverage = image.channels.get("coverage")
    rgb = rgb_from_channels(image.channels, str(path))
    return rgb, dict(image.metadata), None if coverage is None else coverage.astype(np.float32)


def _read_hdr(path: Path | str) -> _Page:
    from irradia.formats.hdr import read_hdr_image

    image = read_hdr_image(path)
    return image.rgb, dict(image.metadata), None


def _read_rgbm(path: Path | str) -> _Page:
    from irradia.formats.rgbm import read_rgbm_png

    image = read_rgbm_png(path)
    return image.rgb, dict(image.metadata), None


def _read_ktx2(path: Path | str) -> _Page:
    from irradia.formats.ktx2 import decode_ktx2

    try:
        data = Path(path).read_bytes()
    except OSError as error:
        raise InputError(f"can't read this texture: {error.strerror}", where=str(path)) from error
    texture = decode_ktx2(data, str(path))
    if len(texture.pages) != 1:
        raise InputError(f"expected one page, found {len(texture.pages)} layers", where=str(path))
    return texture.pages[0], dict(texture.metadata), None


def _format(name: str) -> MapFormat:
    found = FORMATS.get(name)
    if found is None:
        near = difflib.get_close_matches(name, FORMATS, n=1)
        fix = f"Did you mean {near[0]}?" if near else f"Choose of {_all_names()}."
        raise InputError(f"expected a lightmap format, found {name!r}", where="--format", fix=fix)
    return found


def _all_names() -> str:
    return ", ".join(FORMATS)


FORMATS: dict[str, MapFormat] = {
    item.name: item
    for item in (
        MapFormat("exr", ".exr", partial(_write_exr, half=False)),
        MapFormat("exr-half", ".half.exr", partial(_write_exr, half=True)),
        MapFormat("hdr", ".hdr", _write_hdr),
        MapFormat("rgbm", ".rgbm.png", partial(_write_rgbm, gamma=2.0)),
        MapFormat("rgbm-linear", ".rgbm-linear.png", partial(_write_rgbm, gamma=1.0)),
        MapFormat("ktx2-half", ".half.ktx2", partial(_write_ktx2, encoding="half")),
        MapFormat("ktx2-rgb9e5", ".rgb9e5.ktx2", partial(_write_ktx2, encoding="rgb9e5")),
        MapFormat("ktx2-bc6h", ".bc6h.ktx2", partial(_write_ktx2, encoding="bc6h")),
    )
}
_READERS: dict[str, Callable[[Path | str], _Page]] = {
    ".exr": _read_exr,
    ".hdr": _read_hdr,
    ".png": _read_rgbm,
    ".ktx2": _read_ktx2,
}
