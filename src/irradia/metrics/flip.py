"""HDR-FLIP with exposures that a little noise can't move.

Andersson et al., "Visualizing Errors in Rendered High Dynamic Range Images", 2021, by its authors'
package flip-evaluator. There the first exposure follows from the brightest pixel, which in a path
traced image is often noise. Ours takes the 99th percentile, and whole stops.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from irradia.core.colour import luminance
from irradia.core.errors import InternalError

PIXELS_PER_DEGREE = 67.0  # a 0.7 m wide 4K display seen from 0.7 m: FLIP's default
_BRIGHT_PERCENTILE = 99.0
_MAX_EXPOSURES = 16


@dataclass(frozen=True)
class FlipExposures:
    """The exposures that HDR-FLIP looks at: from ``start_ev`` to ``stop_ev`` stops, one a stop.

    Two at least: given a single one, flip-evaluator finds no error anywhere.
    """

    start_ev: int
    stop_ev: int

    def __post_init__(self) -> None:
        if self.stop_ev <= self.start_ev:
            raise InternalError(f"expected two exposures at least, found {self.start_ev} to {self.stop_ev}")

    @property
    def count(self) -> int:
        """How many."""
        return self.stop_ev - self.start_ev + 1


@dataclass(frozen=True)
class FlipResult:
    """HDR-FLIP's error.

    Attributes:
        error: (H, W) float32 in [0, 1].
        exposures: What it was computed at.
    """

    error: NDArray[np.float32]
    exposures: FlipExposures

    @property
    def mean(self) -> float:
        """Mean over all pixels."""
        return float(self.error.mean(dtype=np.float64))


def flip_exposures(reference: NDArray) -> FlipExposures:
    """Exposures for a reference (…, 3): its 99th percentile shown as 1, up to its median shown as 1.

    Where these are closer than a stop, one stop more is looked at.
    """
    lit = luminance(reference).astype(np.float64)
    lit = lit[lit > 0.0]
    if lit.size == 0:
        return FlipExposures(0, 1)
    bright, middle = np.percentile(lit, [_BRIGHT_PERCENTILE, 50.0])
    start = round(-math.log2(bright))
    stop = round(-math.log2(middle))
    return FlipExposures(start, min(max(start + 1, stop), start + _MAX_EXPOSURES - 1))


def flip(test: NDArray, reference: NDArray, exposures: FlipExposures | None = None) -> FlipResult:
    """HDR-FLIP of two (H, W, 3) linear images, at 67 pixels per degree.

    Args:
        test: Linear values; negative ones count as 0.
        reference: As ``test``.
        exposures: Those of the reference, by default; pass one set to compare several images.
    """
    from flip_evaluator import evaluate

    exposures = exposures or flip_exposures(reference)
    error, _, _ = evaluate(
        np.ascontiguousarray(np.maximum(reference, 0.0), np.float32),
        np.ascontiguousarray(np.maximum(test, 0.0), np.float32),
        "HDR",
        applyMagma=False,
        computeMeanError=False,
        parameters={
            "ppd": PIXELS_PER_DEGREE,
            "startExposure": float(exposures.start_ev),
            "stopExposure": float(exposures.stop_ev),
            "numExposures": exposures.count,
            "tonemapper": "ACES",
        },
    )
    return FlipResult(np.asarray(error, np.float32).reshape(reference.shape[:2]), exposures)
