"""A soft one-hot vector of each coordinate (Müller et al. 2019, section 4.3)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from irradia.core.errors import InputError
from irradia.field.encoding import Array, Encoding


@dataclass(frozen=True)
class OneBlob(Encoding):
    """How much of a bump of radius 1 / bins, centred on a coordinate, lies in each bin of [0, 1].

    The bump is tiny-cuda-nn's quartic 15/16 (1 − u²)², near the paper's Gaussian. Ours doesn't wrap from 1
    to 0, since opposite faces of a box aren't neighbours. Coordinate by coordinate, then by bin.

    Attributes:
        n_bins: Of each coordinate.
    """

    name: ClassVar[str] = "one_blob"

    n_bins: int = 16

    def __post_init__(self) -> None:
        if not 1 <= self.n_bins <= 128:
            raise InputError(f"expected 1–128 bins, found {self.n_bins}")

    @property
    def n_outputs(self) -> int:
        """3 · bins."""
        return 3 * self.n_bins

    def forward(self, x: Array, parameters: Array) -> Array:
        """Shares (N, 3 · bins)."""
        edges = np.arange(self.n_bins + 1)
        below_edge = _quartic_cdf(edges - x[:, :, None].astype(np.float64) * self.n_bins)
        return np.diff(below_edge, axis=-1).reshape(len(x), self.n_outputs).astype(parameters.dtype)


def _quartic_cdf(u: Array) -> Array:
    """∫ 15/16 (1 − u²)² from −1; 0 below and 1 above ±1."""
    u = np.clip(u, -1.0, 1.0)
    square = u * u
    return 0.5 + 15.0 / 16.0 * u * (1.0 - 2.0 / 3.0 * square + 0.2 * square * square)
