"""Smooth interpolation that never overshoots."""

from __future__ import annotations

import numpy as np

from irradia.scene.types import F64


def monotone_cubic(x: F64, y: F64, at: F64) -> F64:
    """Cubic Hermite interpolation through (x, y), monotone between neighbours.

    This work is based on: Fritsch and Butland 1984, "A method for constructing local monotone
    piecewise cubic interpolants": slopes are weighted harmonic means of the neighbouring secants,
    and 0 where those differ in sign. The ends take their only secant.

    Args:
        x: (N,) ascending, N ≥ 2.
        y: (N, K) values, one column a curve.
        at: (M,) where to look; outside of x the ends' values hold.

    Returns:
        (M, K).
    """
    step = np.diff(x)[:, None]
    secant = np.diff(y, axis=0) / step
    slope = np.concatenate([secant[:1], _inner_slopes(step, secant), secant[-1:]])
    at = np.clip(at, x[0], x[-1])
    cell = np.clip(np.searchsorted(x, at, side="right") - 1, 0, len(x) - 2)
    h = step[cell]
    t = (at - x[cell])[:, None] / h
    value = (1.0 + 2.0 * t) * (1.0 - t) ** 2 * y[cell] + t * t * (3.0 - 2.0 * t) * y[cell + 1]
    return value + h * t * (1.0 - t) * ((1.0 - t) * slope[cell] - t * slope[cell + 1])


def _inner_slopes(step: F64, secant: F64) -> F64:
    """(N − 2, K)."""
    before, after = secant[:-1], secant[1:]
    w_before, w_after = 2.0 * step[1:] + step[:-1], step[1:] + 2.0 * step[:-1]
    agrees = before * after > 0.0
    harmonic = np.where(agrees, w_before / np.where(agrees, before, 1.0), 1.0)
    harmonic = harmonic + np.where(agrees, w_after / np.where(agrees, after, 1.0), 0.0)
    return np.where(agrees, (w_before + w_after) / harmonic, 0.0)
