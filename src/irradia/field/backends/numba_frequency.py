"""The fast version of :class:`irradia.field.encodings.Frequency`."""

from __future__ import annotations

from irradia.field.backends.numba_compile import inner, kernel, take
from irradia.field.backends.numba_encoding import F32, TILE, NumbaEncoding
from irradia.field.backends.numba_identity import copy_points
from irradia.field.backends.numba_math import sin_cos_of_quadrant
from irradia.field.backends.numba_vector import load8, nearest, store8, whole8
from irradia.field.backends.numba_vector_type import LANES
from irradia.field.encodings import Frequency

_HALF_PI = 1.5707963267948966


class NumbaFrequency(NumbaEncoding[Frequency]):
    """Counts in quarter turns, 2^(k+1) · x: doubling is exact, and so is taking the whole ones away."""

    def forward(self, points: F32, parameters: F32, features: F32, row: int) -> None:
        """As the base says."""
        encoding = self.encoding
        self.team.run(_all_waves, points, features, row, encoding.n_frequencies, encoding.include_identity)


@kernel
def _all_waves(_thread, next_task, points, features, row, n_frequencies, include_identity):
    index = take(next_task)
    while index < len(features):
        tile, first_wave = features[index], row
        if include_identity:
            copy_points(points, index * TILE, tile, row)
            first_wave += 3
        for axis in range(3):
            _waves(points, axis, index * TILE, tile, first_wave + 2 * n_frequencies * axis, n_frequencies)
        index = take(next_task)


@inner
def _waves(points, axis, first, tile, row, n_frequencies):
    """Sine and cosine rows of one coordinate of a tile."""
    for s in range(0, TILE, LANES):
        quarters = load8(points, (axis, first + s))
        for k in range(n_frequencies):
            quarters = quarters + quarters
            whole = nearest(quarters)
            sine, cosine = sin_cos_of_quadrant((quarters - whole) * _HALF_PI, whole8(whole))
            store8(tile, (row + 2 * k, s), sine)
            store8(tile, (row + 2 * k + 1, s), cosine)
