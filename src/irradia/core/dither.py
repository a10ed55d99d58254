"""8-bit sRGB that keeps means: between two codes a fixed pattern decides, in linear light."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from irradia.core.colour import linear_from_srgb, srgb_from_linear

_CODES = linear_from_srgb(np.arange(257) / 255.0)  # one beyond the last, for its upper neighbour
_CHANNEL_SHIFT_PX = (0, 23, 47)  # so that the channels' patterns don't agree: grey noise would show more


def dithered_srgb8(linear: ArrayLike, *, first_row: int = 0) -> NDArray[np.uint8]:
    """Codes whose decoded mean over any few texels is the mean of what was coded.

    Rounding loses shade: at a hundredth of white codes are 4 % apart, at a thousandth 30 %, and an
    even surface keeps its error everywhere. Here a texel takes the upper code as often as it lies
    near it. Exact codes, 0 among them, stay as they are; values outside [0, 1] are clipped.

    Args:
        linear: (H, W, 3) linear.
        first_row: Of the image that these rows belong to, so that bands join without a seam.
    """
    clipped = np.clip(np.asarray(linear, np.float32), 0.0, 1.0)
    # A value that is a code is not to fall below it by rounding; one that was lifted falls back.
    lower = np.floor(srgb_from_linear(clipped) * 255.0 + 1e-3).astype(np.int16)
    lower -= _CODES[lower] > clipped
    share = (clipped - _CODES[lower]) / (_CODES[lower + 1] - _CODES[lower])
    height, width = clipped.shape[:2]
    return np.minimum(lower + (share > _thresholds(height, width, first_row)), 255).astype(np.uint8)


def _thresholds(height: int, width: int, first_row: int) -> NDArray[np.float32]:
    """(H, W, 3) interleaved gradient noise: any 3 × 3 texels have thresholds spread evenly over [0, 1).

    This work is based on: Jorge Jimenez, "Next Generation Post Processing in Call of Duty: Advanced
    Warfare", SIGGRAPH 2014 courses.
    """
    y = np.arange(first_row, first_row + height)[:, None, None]
    x = np.arange(width)[None, :, None] + np.array(_CHANNEL_SHIFT_PX)
    return np.modf(52.9829189 * np.modf(0.06711056 * x + 0.00583715 * y)[0])[0].astype(np.float32)
