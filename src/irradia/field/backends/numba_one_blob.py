"""The fast version of :class:`irradia.field.encodings.OneBlob`."""

from __future__ import annotations

import numpy as np

from irradia.field.backends.numba_compile import inner, kernel, take
from irradia.field.backends.numba_encoding import F32, TILE, NumbaEncoding
from irradia.field.backends.numba_vector import fma, load8, select, splat8, store8
from irradia.field.backends.numba_vector_type import LANES
from irradia.field.encodings import OneBlob


class NumbaOneBlob(NumbaEncoding[OneBlob]):
    """Takes the bump's integral once at each edge of a bin."""

    def forward(self, points: F32, parameters: F32, features: F32, row: int) -> None:
        """As the base says."""
        self.team.run(_all_shares, points, features, row, self.encoding.n_bins)


@kernel
def _all_shares(_thread, next_task, points, features, row, n_bins):
    index = take(next_task)
    while index < len(features):
        for axis in range(3):
            _shares(points, axis, index * TILE, features[index], row + n_bins * axis, n_bins)
        index = take(next_task)


@inner
def _shares(points, axis, first, tile, row, n_bins):
    """Rows of one coordinate of a tile."""
    minus_bins = splat8(np.float32(-n_bins))
    for s in range(0, TILE, LANES):
        x = load8(points, (axis, first + s))
        below = _quartic_cdf8(x * minus_bins)
        for b in range(n_bins):
            # Rounded once: a product of its own would round by more than a bump's slope forgives.
            below_next = _quartic_cdf8(fma(x, minus_bins, splat8(np.float32(b + 1))))
            store8(tile, (row + b, s), below_next - below)
            below = below_next


@inner
def _quartic_cdf8(u):
    """∫ 15/16 (1 − u²)² from −1; 0 below and 1 above ±1."""
    u = select(u > 1.0, 1.0, select(u < -1.0, -1.0, u))
    square = u * u
    return u * (square * (square * 0.1875 - 0.625) + 0.9375) + 0.5
