"""How far a field is from samples that it wasn't trained on, without the samples' own noise.

A sample t is the truth plus noise of a known variance v, which knows nothing of the field p. So
E[(p − t)²] = (p − truth)² + v, and subtracting the mean of v leaves the field's own error. Where what is
left is below v itself, the figure says more of the samples than of the field, and is flagged; where it is
below the standard error with which its mean is known, that error stands in its place.
"""

from __future__ import annotations

import math
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from irradia.core.sh import fibonacci_sphere, light_on
from irradia.field.backend import F32, Evaluator
from irradia.field.spec import FieldFrame
from irradia.formats.samples import SampleFile

AT_MOST = 1 << 16  # samples that a validation looks at
PEAK_PERCENTILE = 99.9
EPSILON = 0.01  # of the squared mean, as in metrics.relmse
_CHUNK_ROWS = 1 << 14


@dataclass(frozen=True)
class Figures:
    """Errors of a field.

    Attributes:
        n_samples: Looked at.
        psnr_db: Of E, linear; the peak is the 99.9th percentile of the samples' E.
        relmse: Mean of (p − t)² / (t² + 0.01) of E in units of the samples' mean, as
            :func:`irradia.metrics.relmse`.
        mean_ratio: Mean E of the field over the samples'.
        mae: Mean absolute error of what the file holds, E or coefficients, in its units and with the
            samples' noise: what the Unity project publishes.
        noise_relmse: relMSE that the samples' noise alone would give, which is subtracted; None where the
            file doesn't know it, and nothing is.
        under_noise: What is left of relMSE or of the squared error is less than was subtracted.
    """

    n_samples: int
    psnr_db: float
    relmse: float
    mean_ratio: float
    mae: float
    noise_relmse: float | None
    under_noise: bool

    def to_json(self) -> dict[str, Any]:
        """Plain values by name."""
        return asdict(self)


@dataclass(frozen=True)
class Judge:
    """Samples to judge a field by, in memory.

    Attributes:
        x: (N, 3) positions in [0, 1]³.
        normal: (N, 3) that E is asked for; of SH samples, directions spread over the sphere.
        feeds_normal: Whether the field takes the normal, or gives coefficients.
        values: (N, C) of the file: E or coefficients.
        variance: (N,) of E, or None where it isn't known.
        scale: Of the frame.
    """

    x: F32
    normal: F32
    feeds_normal: bool
    values: F32
    variance: F32 | None
    scale: float

    def __len__(self) -> int:
        return len(self.x)

    def figures(self, evaluator: Evaluator) -> Figures:
        """Judges a field."""
        chunks = [slice(first, first + _CHUNK_ROWS) for first in range(0, len(self), _CHUNK_ROWS)]
        normal = self.normal if self.feeds_normal else None
        outputs = [evaluator(self.x[c], None if normal is None else normal[c]) for c in chunks]
        found = np.concatenate(outputs).astype(np.float64) * self.scale
        truth = self.values.astype(np.float64)
        mae = float(np.mean(np.abs(found - truth)))
        return _figures(self._irradiance(found), self._irradiance(truth), self.variance, mae)

    def _irradiance(self, values: NDArray[np.float64]) -> NDArray[np.float64]:
        """E (N, 3)."""
        return values if self.feeds_normal else irradiance_of(values, self.normal)


def judge(samples: SampleFile, rows: NDArray[np.int64], frame: FieldFrame) -> Judge:
    """Reads rows to judge a field by.

    Args:
        samples: Their file.
        rows: Their numbers, ascending; of more than ``AT_MOST``, so many are taken evenly.
        frame: Of the field.
    """
    if len(rows) > AT_MOST:
        rows = rows[np.arange(AT_MOST) * len(rows) // AT_MOST]
    table = np.array(samples.rows[rows])
    n_values, feeds_normal = samples.info.n_values, samples.info.has_normals
    normal = table[:, 3:6] if feeds_normal else _directions(len(table))
    known = bool(np.any(table[:, -1] > 0.0))
    return Judge(
        frame.to_unit(table[:, :3]),
        np.ascontiguousarray(normal),
        feeds_normal,
        table[:, -1 - n_values : -1],
        table[:, -1] if known else None,
        frame.scale,
    )


def irradiance_of(coefficients: NDArray[np.float64], normals: F32) -> NDArray[np.float64]:
    """E (N, 3) of flattened coefficients (N, 12 or 27) at unit normals (N, 3)."""
    return light_on(coefficients.reshape(len(coefficients), -1, 3), normals)


def _directions(n: int) -> F32:
    """(n, 3) spread over the sphere, in an order that has nothing to do with that of positions."""
    return fibonacci_sphere(n)[np.random.default_rng(n).permutation(n)].astype(np.float32)


def _figures(found: NDArray, truth: NDArray, variance: F32 | None, mae: float) -> Figures:
    mean = float(np.mean(np.abs(truth))) or 1.0
    weight = 1.0 / (truth**2 + EPSILON * mean**2)
    squared = (found - truth) ** 2
    noise = np.zeros_like(truth) if variance is None else _by_channel(variance, truth)
    mse, mse_noise = _without_noise(squared, noise)
    relmse, relmse_noise = _without_noise(squared * weight, noise * weight)
    peak = float(np.percentile(np.abs(truth), PEAK_PERCENTILE)) or 1.0
    return Figures(
        n_samples=len(truth),
        psnr_db=10.0 * math.log10(peak**2 / mse) if mse > 0.0 else math.inf,
        relmse=relmse,
        mean_ratio=_ratio(float(np.mean(found)), float(np.mean(truth))),
        mae=mae,
        noise_relmse=None if variance is None else relmse_noise,
        under_noise=mse < mse_noise or relmse < relmse_noise,
    )


def _by_channel(variance: F32, truth: NDArray) -> NDArray:
    """Variance (N, 3) from its mean over channels, as if each were as noisy for its light as the others."""
    squared = truth**2
    total = squared.sum(axis=1, keepdims=True)
    share = np.divide(squared, total, out=np.full_like(squared, 1.0 / 3.0), where=total > 0.0)
    return 3.0 * variance[:, None] * share


def _without_noise(error: NDArray, noise: NDArray) -> tuple[float, float]:
    """The mean of an error less that of its noise, at least its standard error; and the noise."""
    by_sample = np.mean(error - noise, axis=1)
    standard_error = float(np.std(by_sample)) / math.sqrt(len(by_sample))
    mean_noise = float(np.mean(noise))
    left = float(np.mean(by_sample))
    return (max(left, standard_error) if mean_noise > 0.0 else left), mean_noise


def _ratio(found: float, truth: float) -> float:
    if truth == 0.0:
        return 1.0 if found == 0.0 else math.inf
    return found / truth
