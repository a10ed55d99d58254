"""Does light come through walls? Errors next to walls beside those everywhere else."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

NEAR_WALL_M = 0.05
MIN_POINTS = 50  # on either side; fewer say nothing


@dataclass(frozen=True)
class LeakRatio:
    """Errors near walls over errors elsewhere.

    Attributes:
        n_near, n_elsewhere: Places on either side.
        rmse_near, rmse_elsewhere: Root mean squared errors there, the samples' noise taken out.
        ratio: Their quotient; None where there are too few places, or elsewhere no error stands out
            from the noise.
    """

    n_near: int
    n_elsewhere: int
    rmse_near: float
    rmse_elsewhere: float
    ratio: float | None


def leak_ratio(
    values: NDArray, samples: NDArray, variance: NDArray, distance_m: NDArray, near_m: float = NEAR_WALL_M
) -> LeakRatio:
    """RMSE within ``near_m`` of walls over RMSE elsewhere.

    Args:
        values: (N, 3) E that is judged.
        samples: (N, 3) estimates of the truth.
        variance: (N,) of each sample, averaged over channels.
        distance_m: (N,) from each place to the nearest surface.
        near_m: What counts as near.
    """
    squared = np.mean((np.asarray(values, np.float64) - samples) ** 2, axis=1) - variance
    near = distance_m <= near_m
    n_near, n_elsewhere = int(near.sum()), int((~near).sum())
    enough = min(n_near, n_elsewhere) >= MIN_POINTS
    here, there = (_root_mean(squared[side]) for side in (near, ~near))
    return LeakRatio(n_near, n_elsewhere, here, there, here / there if enough and there > 0.0 else None)


def _root_mean(squared: NDArray) -> float:
    """Of errors less noise, which may come out below 0."""
    return float(np.sqrt(max(float(squared.mean()), 0.0))) if len(squared) else 0.0
