"""How far two images or lightmaps are apart: pure functions on arrays."""

from irradia.metrics.comparison import Comparison, compare, flip_where
from irradia.metrics.flip import FlipExposures, FlipResult, flip, flip_exposures
from irradia.metrics.pixelwise import mae, mean_ratio, relative_error_p95, relmse, smape
from irradia.metrics.psnr import psnr
from irradia.metrics.unbiased import relmse_between_means, relmse_without_reference_noise

__all__ = [
    "Comparison",
    "FlipExposures",
    "FlipResult",
    "compare",
    "flip",
    "flip_exposures",
    "flip_where",
    "mae",
    "mean_ratio",
    "psnr",
    "relative_error_p95",
    "relmse",
    "relmse_between_means",
    "relmse_without_reference_noise",
    "smape",
]
