"""Error over time: one bake after another at growing sample counts, and the time to a given error."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from statistics import median

import numpy as np

from irradia.metrics import mean_ratio, relmse_without_reference_noise


@dataclass(frozen=True)
class Reference:
    """Two independent estimates of the truth on the compared texels, (N, 3) each."""

    first: np.ndarray
    second: np.ndarray

    @property
    def mean(self) -> np.ndarray:
        """The best estimate."""
        return 0.5 * (self.first + self.second)

    @property
    def relative_rmse(self) -> float:
        """What noise is left in :attr:`mean`: half the RMSE between the two."""
        difference = relmse_without_reference_noise(self.first, self.second, self.second)
        return 0.5 * math.sqrt(difference)

    def error_of(self, values: np.ndarray) -> float:
        """Relative RMSE: the root of relMSE, the reference's own noise taken out."""
        return math.sqrt(max(relmse_without_reference_noise(values, self.first, self.second), 0.0))


@dataclass(frozen=True)
class Point:
    """All repeats at one sample count.

    Attributes:
        seconds, errors: One of each repeat.
        mean_ratio: Of the repeats' average to the reference.
    """

    samples: int
    seconds: tuple[float, ...]
    errors: tuple[float, ...]
    mean_ratio: float

    @property
    def time_s(self) -> float:
        """Median time."""
        return median(self.seconds)

    @property
    def error(self) -> float:
        """Median error."""
        return median(self.errors)


Bake = Callable[[int, int], tuple[np.ndarray, float]]  # (samples, seed) → values, seconds


def measure_curve(
    bake: Bake,
    reference: Reference,
    samples: Sequence[int],
    *,
    until: float,
    repeats: int,
    limit_s: float,
) -> list[Point]:
    """Bakes at each sample count in turn until the error falls below ``until``, or a bake takes too long.

    Args:
        bake: What is measured.
        reference: The truth.
        samples: Ascending counts.
        until: Relative RMSE.
        repeats: Bakes at each count, with seeds from 1.
        limit_s: No count is tried after one whose bakes took longer.
    """
    curve = []
    for count in samples:
        runs = [bake(count, seed) for seed in range(1, repeats + 1)]
        average = np.mean([values for values, _ in runs], axis=0)
        point = Point(
            samples=count,
            seconds=tuple(seconds for _, seconds in runs),
            errors=tuple(reference.error_of(values) for values, _ in runs),
            mean_ratio=mean_ratio(average, reference.mean),
        )
        curve.append(point)
        if point.error < until or point.time_s > limit_s:
            break
    return curve


def time_to_error(curve: Sequence[Point], target: float) -> float | None:
    """Seconds at which the curve first reaches an error, between points on log-log axes.

    None where it is never reached; the first point's time where that is already better, since no
    bake is faster than the smallest.
    """
    for before, after in zip([None, *curve], curve, strict=False):
        if after.error > target:
            continue
        if before is None:
            return after.time_s
        share = math.log(before.error / target) / math.log(before.error / after.error)
        return before.time_s * (after.time_s / before.time_s) ** share
    return None


def error_floor(curve: Sequence[Point]) -> float:
    """The error that no number of samples removes: b of error² = a/n + b², from the last two points.

    Zero where the two still fall like noise alone.
    """
    if len(curve) < 2:
        return 0.0
    first, last = curve[-2], curve[-1]
    noise = (first.error**2 - last.error**2) / (1.0 / first.samples - 1.0 / last.samples)
    return math.sqrt(max(last.error**2 - noise / last.samples, 0.0))
