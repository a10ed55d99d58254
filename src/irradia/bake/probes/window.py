"""Windowing: as little smoothing as makes irradiance non-negative.

A truncated series rings: behind a bright light it falls below zero. Each probe's bands are damped by
w(l) = 1 / (1 + λ l² (l + 1)²), which minimises the squared Laplacian (Sloan 2008, "Stupid Spherical
Harmonics Tricks", section "Windowing"), with the smallest λ that keeps E ≥ 0; L0, and so the mean,
stays as it is. Ours differs in looking at irradiance instead of radiance, since that is what probes are
read for: the cosine lobe has removed most ringing already, so λ is smaller.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from irradia.core.sh import BAND, fibonacci_sphere, irradiance_weights

N_DIRECTIONS = 1000
# E at the dimmest of the directions must exceed this share of the mean E: between them, at most 0.06
# apart, a series of order 2 can dip by that much, and rounding to half takes far less.
_MARGIN = 5e-3
_STEPS = 32
_PROBES_AT_ONCE = 4096


def window(
    coefficients: NDArray[np.float32],
) -> tuple[NDArray[np.float32], NDArray[np.float64]]:
    """Damps the bands of each probe until irradiance is nowhere negative.

    All channels of a probe share one λ, so that hues don't shift between directions.

    Args:
        coefficients: (N, 9, 3) of radiance; L0 must not be negative.

    Returns:
        The damped coefficients and λ (N,), 0 where nothing had to be done.
    """
    result = coefficients.copy()
    strength = np.zeros(len(coefficients))
    for first in range(0, len(coefficients), _PROBES_AT_ONCE):
        part = slice(first, first + _PROBES_AT_ONCE)
        result[part], strength[part] = _window_some(coefficients[part])
    return result, strength


def band_weights(strength: NDArray[np.float64]) -> NDArray[np.float64]:
    """(…, 9) factors of the coefficients for λ (…)."""
    squared_laplacian = (BAND * (BAND + 1.0)) ** 2
    return 1.0 / (1.0 + strength[..., None] * squared_laplacian)


def _window_some(
    coefficients: NDArray[np.float32],
) -> tuple[NDArray[np.float32], NDArray[np.float64]]:
    """Bisection for the probes that need it, all at once."""
    series = coefficients.astype(np.float64)
    basis = irradiance_weights(fibonacci_sphere(N_DIRECTIONS))
    strength = np.zeros(len(series))
    wanting = np.flatnonzero(~_holds(series, strength, basis))
    if len(wanting) == 0:
        return coefficients, strength
    low, high = np.zeros(len(wanting)), np.ones(len(wanting))
    for _ in range(_STEPS):
        middle = 0.5 * (low + high)
        enough = _holds(series[wanting], _strength(middle), basis)
        low, high = np.where(enough, low, middle), np.where(enough, middle, high)
    strength[wanting] = _strength(high)
    damped = series * band_weights(strength)[..., None]
    return damped.astype(np.float32), strength


def _strength(share: NDArray[np.float64]) -> NDArray[np.float64]:
    """λ on a scale from 0 to 1, where 1 leaves nothing but L0."""
    return share / np.maximum(1.0 - share, 1e-12)


def _holds(
    series: NDArray[np.float64], strength: NDArray[np.float64], basis: NDArray[np.float64]
) -> NDArray[np.bool_]:
    """(N,) whether E keeps its margin in all directions and channels."""
    damped = series * band_weights(strength)[..., None]
    e = np.einsum("di,nic->ndc", basis, damped, optimize=True)
    mean = basis[0, 0] * series[:, None, 0, :]
    return np.all(e >= _MARGIN * mean, axis=(1, 2))
