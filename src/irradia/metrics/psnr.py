"""Peak signal-to-noise ratio of what a viewer sees."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from irradia.core.colour import automatic_exposure_ev, srgb_from_linear


def psnr(test: NDArray, reference: NDArray) -> float:
    """PSNR in dB of (…, 3) linear images, both exposed automatically for the reference and sRGB-coded.

    The peak is 1, where display values clip. Equal images give infinity.
    """
    exposure = np.float32(2.0 ** automatic_exposure_ev(reference))
    shown_test = srgb_from_linear(np.asarray(test, np.float32) * exposure).astype(np.float64)
    shown_reference = srgb_from_linear(np.asarray(reference, np.float32) * exposure)
    mse = float(np.mean((shown_test - shown_reference) ** 2))
    return -10.0 * math.log10(mse) if mse > 0.0 else math.inf
