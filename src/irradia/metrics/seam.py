"""How visible a lightmap's cuts are: what bilinear filtering reads on either side of them."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

DARK = 0.01  # of the pages' mean; darker places are compared with this instead of with themselves


def seam_difference(pages: NDArray, page: NDArray, position_px: NDArray, *, dark: float = DARK) -> NDArray:
    """Relative difference of filtered light across seams.

    Args:
        pages: (P, H, W, C) linear.
        page: (M, 2) page of each point on either side.
        position_px: (M, 2, 2) side, then x and y in texels, texel centres at + 0.5.
        dark: Least denominator, in units of the pages' mean.

    Returns:
        (M,) largest difference of any channel over the mean of both sides and all channels.
    """
    one = bilinear(pages, page[:, 0], position_px[:, 0])
    other = bilinear(pages, page[:, 1], position_px[:, 1])
    least = dark * float(np.abs(pages).mean(dtype=np.float64))
    magnitude = 0.5 * (np.abs(one) + np.abs(other)).mean(axis=1)
    return np.abs(one - other).max(axis=1) / np.maximum(np.maximum(magnitude, least), 1e-30)


def bilinear(pages: NDArray, page: NDArray, position_px: NDArray) -> NDArray:
    """(M, C) filtered values at positions (M, 2) of pages (M,), clamped at their borders."""
    height, width = pages.shape[1:3]
    corner = np.asarray(position_px, np.float64) - 0.5
    low = np.floor(corner).astype(np.int64)
    fx, fy = (corner - low).T[..., None]
    x = np.clip([low[:, 0], low[:, 0] + 1], 0, width - 1)
    y = np.clip([low[:, 1], low[:, 1] + 1], 0, height - 1)
    upper = pages[page, y[0], x[0]] * (1 - fx) + pages[page, y[0], x[1]] * fx
    lower = pages[page, y[1], x[0]] * (1 - fx) + pages[page, y[1], x[1]] * fx
    return upper * (1 - fy) + lower * fy
