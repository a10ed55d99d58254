"""RGBM: HDR colour in the four bytes of an RGBA texel, as a PNG that says how to decode it.

A stored texel (R, G, B, M), each in [0, 1], stands for (range · M · RGB)^gamma. With range 8 and gamma 2
that is PlayCanvas's RGBM; gamma 1 is the linear kind, coarser in the dark and cheaper in a shader. Texels
are data and not colour: sample them without an sRGB transform, and decode before filtering where it can be.

The PNG's text chunks hold ``irradia:rgbm_range``, ``irradia:rgbm_gamma`` and whatever the caller adds.
"""

from __future__ import annotations

import math
import warnings
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from irradia.core.errors import InputError
from irradia.formats.bands import map_bands
from irradia.formats.limits import check_image_size
from irradia.formats.png import write_png

U8 = NDArray[np.uint8]
RANGE_KEY, GAMMA_KEY = "irradia:rgbm_range", "irradia:rgbm_gamma"
_BAND_ROWS = 128


@dataclass(frozen=True)
class RgbmCoding:
    """What a texel stands for.

    Attributes:
        range: Largest value before the power is taken.
        gamma: 1 (linear) or 2 (as PlayCanvas).
    """

    range: float = 8.0
    gamma: float = 2.0

    @property
    def largest(self) -> float:
        """The largest value that can be stored."""
        return self.range**self.gamma


@dataclass(frozen=True)
class RgbmImage:
    """A decoded file.

    Attributes:
        rgb: (H, W, 3) float32.
        coding: How it was stored.
        metadata: All of the file's text.
    """

    rgb: NDArray[np.float32]
    coding: RgbmCoding
    metadata: Mapping[str, str] = field(default_factory=dict)


def encode_rgbm(rgb: NDArray, coding: RgbmCoding = RgbmCoding()) -> U8:
    """(H, W, 3) linear values to (H, W, 4) bytes; negative ones and NaN become 0, large ones the largest.

    M is the smallest that holds the largest channel, so that RGB uses all of its steps.
    """
    texels = np.empty((*rgb.shape[:2], 4), np.uint8)

    def encode(band: slice) -> None:
        rows = np.nan_to_num(np.asarray(rgb[band], np.float32), posinf=np.inf)
        coded = np.minimum(np.maximum(rows, 0.0) ** np.float32(1.0 / coding.gamma) / coding.range, 1.0)
        multiplier = np.maximum(np.ceil(coded.max(axis=-1, keepdims=True) * 255.0), 1.0)
        texels[band, :, :3] = np.round(coded * (255.0 * 255.0) / multiplier)
        texels[band, :, 3:] = multiplier

    map_bands(encode, len(rgb), _BAND_ROWS)
    return texels


def decode_rgbm(texels: U8, coding: RgbmCoding = RgbmCoding()) -> NDArray[np.float32]:
    """(H, W, 4) bytes to (H, W, 3) linear values."""
    product = texels[..., :3].astype(np.float32) * texels[..., 3:]
    return (product * np.float32(coding.range / 255.0**2)) ** np.float32(coding.gamma)


def write_rgbm_png(
    path: Path | str,
    rgb: NDArray,
    coding: RgbmCoding = RgbmCoding(),
    metadata: Mapping[str, str] | None = None,
) -> None:
    """Writes (H, W, 3) linear values as an RGBA PNG; see the module for its text."""
    text = {RANGE_KEY: repr(float(coding.range)), GAMMA_KEY: repr(float(coding.gamma)), **(metadata or {})}
    write_png(path, encode_rgbm(rgb, coding), text)


def read_rgbm_png(path: Path | str) -> RgbmImage:
    """Reads what :func:`write_rgbm_png` wrote.

    Raises:
        InputError: No such file, no RGBA PNG, cut short, absurdly large, or without range and gamma.
    """
    texels, metadata = _read_rgba(path)
    coding = RgbmCoding(_number(metadata, RANGE_KEY, path), _number(metadata, GAMMA_KEY, path))
    if not coding.gamma <= 4.0 or coding.range > 2.0**16:
        raise InputError(f"expected a range to 65536 and a gamma to 4, found {coding}", where=str(path))
    return RgbmImage(decode_rgbm(texels, coding), coding, metadata)


def is_rgbm_png(path: Path | str) -> bool:
    """Whether a file is a PNG that says how to decode it; its pixels aren't read."""
    from PIL import Image

    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", Image.DecompressionBombWarning)
            with Image.open(path, formats=("PNG",)) as image:
                return RANGE_KEY in image.info
    except (OSError, ValueError, SyntaxError, Image.DecompressionBombError):
        return False


def _read_rgba(path: Path | str) -> tuple[U8, dict[str, str]]:
    from PIL import Image

    try:
        with warnings.catch_warnings():
            # Ours is the limit that counts, and it is checked before memory is asked for.
            warnings.simplefilter("ignore", Image.DecompressionBombWarning)
            with Image.open(path, formats=("PNG",)) as image:
                check_image_size(*image.size, str(path))
                if image.mode != "RGBA":
                    raise InputError(f"expected an RGBA PNG, found mode {image.mode}", where=str(path))
                text = {str(key): value for key, value in image.info.items() if isinstance(value, str)}
                return np.asarray(image), text
    except (OSError, ValueError, SyntaxError, Image.DecompressionBombError) as error:
        raise InputError(f"the PNG can't be read: {error}", where=str(path)) from error


def _number(metadata: Mapping[str, str], key: str, path: Path | str) -> float:
    try:
        value = float(metadata.get(key, ""))
    except ValueError:
        value = math.nan
    if not (math.isfinite(value) and value > 0.0):
        raise InputError(
            f"expected text '{key}' with a number above 0, found {metadata.get(key)!r}",
            where=str(path),
            fix="Without it nobody can tell what the texels stand for: write the map again.",
        )
    return value
