"""Scores of a picture against a path-traced reference, each beside the reference's own noise.

The reference is the mean of two independent halves a and b. What separates the halves is noise alone, with
four times the variance of what their mean has, so the score of a against b tells the noise of any figure:
a quarter of it where the figure is quadratic in the error, half of it where it is (nearly) linear, as FLIP
is for small errors. A figure at or under that says only that the error can't be seen in this reference.

Only pixels that show the scene count. The backdrop is the same in both pictures, and would make any field
look the better the more of it is seen.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from irradia.metrics import compare, flip, flip_exposures, flip_where, relmse_without_reference_noise

_STANDARD_ERRORS = 2.0  # within as many, a mean is as good as equal


@dataclass(frozen=True)
class Figure:
    """One score.

    Attributes:
        value: The score.
        noise: What the reference's noise alone would give.
        is_noise: Whether the score says no more than that.
    """

    value: float
    noise: float
    is_noise: bool


@dataclass(frozen=True)
class PictureScores:
    """A picture against its reference.

    Attributes:
        flip, psnr_db, relmse, mean_ratio, p95: See :func:`irradia.metrics.compare`; ``p95`` is the 95th
            percentile of the relative error.
        relmse_noise_free: relMSE without what the reference's noise adds to it.
        flip_start_ev, flip_stop_ev: Exposures that FLIP looked at, stops.
        error: (H, W) FLIP by pixel, 0 where nothing counts.
        scene_share: Share of the pixels that count.
        whole_flip: Mean HDR-FLIP over the whole picture, backdrop and all.
    """

    flip: Figure
    psnr_db: Figure
    relmse: Figure
    mean_ratio: Figure
    p95: Figure
    relmse_noise_free: float
    flip_start_ev: int
    flip_stop_ev: int
    error: NDArray[np.float32]
    scene_share: float
    whole_flip: float

    @property
    def figures(self) -> dict[str, Figure]:
        """All that have a noise, by name."""
        return {name: getattr(self, name) for name in ("flip", "psnr_db", "relmse", "mean_ratio", "p95")}

    def to_json(self) -> dict[str, Any]:
        """Plain values, without the picture of errors."""
        plain: dict[str, Any] = {
            name: {"value": figure.value, "noise": figure.noise, "is_noise": figure.is_noise}
            for name, figure in self.figures.items()
        }
        plain["relmse_noise_free"] = self.relmse_noise_free
        plain["flip_exposures_ev"] = [self.flip_start_ev, self.flip_stop_ev]
        plain["scene_share"], plain["whole_flip"] = self.scene_share, self.whole_flip
        return plain


def score_picture(
    picture: NDArray, half_a: NDArray, half_b: NDArray, scene: NDArray[np.bool_] | None = None
) -> PictureScores:
    """Scores linear radiance (H, W, 3) against the mean of two independent references like it.

    Args:
        picture: What is judged.
        half_a: A reference.
        half_b: Another of equal quality.
        scene: (H, W) pixels that count, those that show the scene; all by default.

    Raises:
        InputError: Sizes differ, or values are NaN or infinite.
    """
    counted = np.ones(half_a.shape[:2], np.bool_) if scene is None else scene
    reference = 0.5 * (half_a + half_b)
    found, noise = compare(picture, reference, counted), compare(half_a, half_b, counted)
    exposures = flip_exposures(reference[counted])
    between_halves = flip_where(half_a, half_b, counted, exposures)[counted]
    whole = found.flip if counted.all() else flip(picture, reference, exposures).mean
    return PictureScores(
        flip=_figure(found.flip, float(between_halves.mean(dtype=np.float64)) / 2.0),
        psnr_db=_psnr(found.psnr_db, noise.psnr_db + 10.0 * math.log10(4.0)),
        relmse=_figure(found.relmse, noise.relmse / 4.0),
        mean_ratio=_ratio(found.mean_ratio, half_a[counted], half_b[counted]),
        p95=_figure(found.relative_error_p95, noise.relative_error_p95 / 2.0),
        relmse_noise_free=relmse_without_reference_noise(picture[counted], half_a[counted], half_b[counted]),
        flip_start_ev=exposures.start_ev,
        flip_stop_ev=exposures.stop_ev,
        error=flip_where(picture, reference, counted, exposures),
        scene_share=float(counted.mean()),
        whole_flip=whole,
    )


def _figure(value: float, noise: float) -> Figure:
    return Figure(value, noise, is_noise=value <= noise)


def _psnr(value_db: float, noise_db: float) -> Figure:
    return Figure(value_db, noise_db, is_noise=value_db >= noise_db)


def _ratio(ratio: float, half_a: NDArray, half_b: NDArray) -> Figure:
    """A ratio of means, whose noise is the standard error of the reference's mean."""
    difference = 0.5 * (np.asarray(half_a, np.float64) - half_b)
    mean = float(np.mean(half_a + half_b, dtype=np.float64)) / 2.0
    error = float(np.sqrt(np.mean(difference**2) / difference.size)) / max(mean, 1e-30)
    return Figure(ratio, error, is_noise=abs(ratio - 1.0) <= _STANDARD_ERRORS * error)
