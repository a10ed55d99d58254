"""Scores at places in space: a field's E against samples of it, each with its own noise.

A sample t = μ + ε of known variance v lets the noise be taken out of squared errors: E[(x − t)²] is
(x − μ)² + v.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from irradia.core.errors import InputError
from irradia.metrics import mae, mean_ratio, relmse


@dataclass(frozen=True)
class SpaceScores:
    """E against samples.

    Attributes:
        n_points: How many places.
        mse: Mean squared error over places and channels, noise and all, in E².
        mse_noise: What of it the samples' noise alone gives.
        mse_noise_free: The difference: an estimate without bias that noise can push below 0.
        relmse: See :func:`irradia.metrics.relmse`.
        mae: Mean absolute error, in the unit of E.
        mean_ratio: Mean of the test over that of the samples.
        mean: Mean of the samples, for scale.
        is_noise: Whether the error is no larger than the noise.
    """

    n_points: int
    mse: float
    mse_noise: float
    mse_noise_free: float
    relmse: float
    mae: float
    mean_ratio: float
    mean: float
    is_noise: bool

    def to_json(self) -> dict[str, Any]:
        """Plain values."""
        return dict(vars(self))


def score_in_space(values: NDArray, samples: NDArray, variance: NDArray) -> SpaceScores:
    """Scores E at places.

    Args:
        values: (N, 3) what is judged, or (N, C) coefficients.
        samples: (N, 3) estimates of the truth, which ``values`` don't depend on.
        variance: (N,) of each sample's mean, averaged over channels; 0 where the truth is known.

    Raises:
        InputError: Shapes differ, there is nothing to score, or something is NaN or infinite.
    """
    x, t = np.asarray(values, np.float64), np.asarray(samples, np.float64)
    if x.shape != t.shape or x.ndim != 2 or len(variance) != len(x) or len(x) == 0:
        raise InputError(f"expected as many values as samples, found {x.shape} and {t.shape}")
    if not (np.isfinite(x).all() and np.isfinite(t).all()):
        raise InputError("expected finite light, found NaN or infinity")
    mse, noise = float(np.mean((x - t) ** 2)), float(np.mean(variance, dtype=np.float64))
    return SpaceScores(
        n_points=len(x),
        mse=mse,
        mse_noise=noise,
        mse_noise_free=mse - noise,
        relmse=relmse(x, t),
        mae=mae(x, t),
        mean_ratio=mean_ratio(x, t),
        mean=float(t.mean()),
        is_noise=mse <= noise,
    )
