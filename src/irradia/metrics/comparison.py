"""All metrics of two images or lightmaps at once."""

from __future__ import annotations

import math
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from irradia.core.errors import InputError
from irradia.metrics.flip import FlipExposures, flip, flip_exposures
from irradia.metrics.pixelwise import mae, mean_ratio, relative_error_p95, relmse, smape
from irradia.metrics.psnr import psnr


@dataclass(frozen=True)
class Comparison:
    """How far a test is from a reference; each metric's function says what it is exactly.

    Attributes:
        n_pixels: Pixels, or covered texels, that counted.
        flip: Mean HDR-FLIP, from ``flip_start_ev`` to ``flip_stop_ev`` stops.
        psnr_db: Of display values at the reference's automatic exposure.
        relmse, smape, mae, mean_ratio, relative_error_p95: Of linear values.
        reference_mean: For scale.
    """

    n_pixels: int
    flip: float
    flip_start_ev: int
    flip_stop_ev: int
    psnr_db: float
    relmse: float
    smape: float
    mae: float
    mean_ratio: float
    relative_error_p95: float
    reference_mean: float

    def to_json(self) -> dict[str, Any]:
        """Plain values; what is infinite (PSNR of equal images) becomes null, since JSON has no infinity."""
        return {k: v if math.isfinite(v) else None for k, v in asdict(self).items()}


def compare(test: NDArray, reference: NDArray, mask: NDArray[np.bool_] | None = None) -> Comparison:
    """Compares linear images.

    Args:
        test: (H, W, 3), or (P, H, W, 3) for pages.
        reference: As ``test``.
        mask: (H, W) or (P, H, W); where False nothing counts, and FLIP sees black in both.

    Raises:
        InputError: Shapes differ, values are NaN or infinite, or the mask leaves nothing.
    """
    x, r = np.asarray(test, np.float32), np.asarray(reference, np.float32)
    counted = np.ones(r.shape[:-1], bool) if mask is None else np.asarray(mask, bool)
    _check(x, r, counted)
    inside_x, inside_r = x[counted], r[counted]
    exposures = flip_exposures(inside_r)
    return Comparison(
        n_pixels=int(counted.sum()),
        flip=_masked_flip(x, r, counted),
        flip_start_ev=exposures.start_ev,
        flip_stop_ev=exposures.stop_ev,
        psnr_db=psnr(inside_x, inside_r),
        relmse=relmse(inside_x, inside_r),
        smape=smape(inside_x, inside_r),
        mae=mae(inside_x, inside_r),
        mean_ratio=mean_ratio(inside_x, inside_r),
        relative_error_p95=relative_error_p95(inside_x, inside_r),
        reference_mean=float(inside_r.mean(dtype=np.float64)),
    )


def flip_where(
    test: NDArray, reference: NDArray, counted: NDArray[np.bool_], exposures: FlipExposures | None = None
) -> NDArray[np.float32]:
    """HDR-FLIP's error (H, W) of two images (H, W, 3), both black where nothing counts; 0 there.

    Args:
        test: Linear values.
        reference: As ``test``.
        counted: (H, W) pixels that count; some must.
        exposures: Those of what counts of the reference, by default.
    """
    exposures = exposures or flip_exposures(reference[counted])
    inside = counted[..., None]
    found = flip(np.where(inside, test, 0.0), np.where(inside, reference, 0.0), exposures)
    return np.where(counted, found.error, np.float32(0.0))


def _masked_flip(test: NDArray, reference: NDArray, counted: NDArray[np.bool_]) -> float:
    """Mean over counted pixels of all pages, at exposures common to the pages."""
    exposures = flip_exposures(reference[counted])
    height, width = reference.shape[-3:-1]
    total = 0.0
    for x, r, inside in zip(
        test.reshape(-1, height, width, 3),
        reference.reshape(-1, height, width, 3),
        counted.reshape(-1, height, width),
        strict=True,
    ):
        total += float(flip_where(x, r, inside, exposures).sum(dtype=np.float64))
    return total / float(counted.sum())


def _check(test: NDArray, reference: NDArray, counted: NDArray[np.bool_]) -> None:
    if test.shape != reference.shape or reference.ndim not in (3, 4) or reference.shape[-1] != 3:
        raise InputError(
            f"expected two images of one size, found {_size(test)} and {_size(reference)}",
            fix="Render or bake both at the same resolution.",
        )
    if counted.shape != reference.shape[:-1]:
        raise InputError(f"expected a mask of {reference.shape[:-1]}, found {counted.shape}")
    if not counted.any():
        raise InputError("the mask leaves no pixel to compare")
    for name, image in (("first", test), ("second", reference)):
        bad = int(counted.sum()) - int(np.isfinite(image[counted]).all(axis=-1).sum())
        if bad:
            raise InputError(f"the {name} image has {bad} pixels that are NaN or infinite")


def _size(image: NDArray) -> str:
    return " × ".join(str(n) for n in image.shape)
