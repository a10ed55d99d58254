"""Errors value by value, of linear images of any shape.

Those with a small number in the denominator first divide both images by the reference's mean, so
that a change of units (lux or watts, a brighter sun) changes no figure; at a mean of 1 they are the
ones in the papers. Values are channels: red, green and blue count alike.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

EPSILON = 0.01  # of the squared mean in relMSE, of the mean elsewhere


def relmse(test: NDArray, reference: NDArray) -> float:
    """Relative mean squared error: mean((x − r)² / (r² + 0.01)), in units of the reference's mean.

    Rousselle et al., "Adaptive Sampling and Reconstruction using Greedy Error Minimization", 2011,
    section 5.1, with ε = 0.01 as is usual since; ours divides by the mean first.
    """
    x, r = _in_units_of_mean(test, reference)
    return float(np.mean((x - r) ** 2 / (r**2 + EPSILON)))


def smape(test: NDArray, reference: NDArray) -> float:
    """Symmetric mean absolute error, in [0, 1]: mean(|x − r| / (|x| + |r| + 0.01)).

    In units of the reference's mean. Without the factor 2 that some authors put before it.
    """
    x, r = _in_units_of_mean(test, reference)
    return float(np.mean(np.abs(x - r) / (np.abs(x) + np.abs(r) + EPSILON)))


def mae(test: NDArray, reference: NDArray) -> float:
    """Mean absolute error, in the images' own units."""
    return float(np.mean(np.abs(np.asarray(test, np.float64) - np.asarray(reference, np.float64))))


def mean_ratio(test: NDArray, reference: NDArray) -> float:
    """Mean of the test over the reference's: 1 without bias. Two black images give 1."""
    x, r = float(np.mean(test, dtype=np.float64)), float(np.mean(reference, dtype=np.float64))
    if r == 0.0:
        return 1.0 if x == 0.0 else float("inf")
    return x / r


def relative_error_p95(test: NDArray, reference: NDArray) -> float:
    """95th percentile of |x − r| / (|r| + 0.01), in units of the reference's mean."""
    x, r = _in_units_of_mean(test, reference)
    return float(np.percentile(np.abs(x - r) / (np.abs(r) + EPSILON), 95.0))


def reference_mean(reference: NDArray) -> float:
    """What "units of the reference's mean" divides by: the mean magnitude, 1 for a black image."""
    return float(np.mean(np.abs(reference), dtype=np.float64)) or 1.0


def _in_units_of_mean(test: NDArray, reference: NDArray) -> tuple[NDArray, NDArray]:
    mean = reference_mean(reference)
    return np.asarray(test, np.float64) / mean, np.asarray(reference, np.float64) / mean
