"""Colour as numbers: the sRGB curve, Rec.709 luminance, and the exposure of previews."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

LUMINANCE_WEIGHTS = (0.2126, 0.7152, 0.0722)  # of linear Rec.709, ITU-R BT.709
MIDDLE_GREY = 0.18


def srgb_from_linear(linear: ArrayLike) -> NDArray[np.float32]:
    """Encodes linear values for display (IEC 61966-2-1); values outside [0, 1] are clipped."""
    clipped = np.clip(np.asarray(linear, np.float32), 0.0, 1.0)
    curved = 1.055 * np.power(clipped, 1.0 / 2.4) - 0.055
    return np.where(clipped <= 0.0031308, 12.92 * clipped, curved).astype(np.float32)


def linear_from_srgb(srgb: ArrayLike) -> NDArray[np.float32]:
    """Decodes display values in [0, 1] to linear ones (IEC 61966-2-1)."""
    coded = np.asarray(srgb, np.float32)
    curved = np.power(np.maximum(coded + 0.055, 0.0) / 1.055, 2.4)
    return np.where(coded <= 0.04045, coded / 12.92, curved).astype(np.float32)


def luminance(rgb: ArrayLike) -> NDArray[np.float32]:
    """Luminance of linear Rec.709, (…, 3) → (…)."""
    return np.asarray(rgb, np.float32) @ np.array(LUMINANCE_WEIGHTS, np.float32)


def automatic_exposure_ev(rgb: ArrayLike) -> float:
    """The exposure, in stops, that shows linear ``rgb`` (…, 3) well: multiply it by ``2**ev``.

    The geometric mean of the luminances above zero becomes middle grey. Black images get 0.
    """
    lit = luminance(rgb)
    lit = lit[np.isfinite(lit) & (lit > 0.0)].astype(np.float64)
    if lit.size == 0:
        return 0.0
    return float(np.log2(MIDDLE_GREY) - np.log2(lit, out=lit).mean())


def preview_srgb8(rgb: ArrayLike, exposure_ev: float) -> NDArray[np.uint8]:
    """8-bit sRGB pixels of linear ``rgb`` at an exposure in stops."""
    exposed = np.asarray(rgb, np.float32) * np.float32(2.0**exposure_ev)
    return np.round(srgb_from_linear(exposed) * 255.0).astype(np.uint8)


def picture_srgb8(rgb: ArrayLike, exposure_ev: float) -> NDArray[np.uint8]:
    """8-bit sRGB pixels for people to look at: highlights roll off instead of clipping.

    Below half of white nothing changes; above, each channel approaches white exponentially, with
    the same slope at the join.
    """
    exposed = np.maximum(np.asarray(rgb, np.float32), 0.0) * np.float32(2.0**exposure_ev)
    shoulder = 1.0 - 0.5 * np.exp(1.0 - 2.0 * np.maximum(exposed, 0.5))
    return np.round(srgb_from_linear(np.where(exposed > 0.5, shoulder, exposed)) * 255.0).astype(np.uint8)
