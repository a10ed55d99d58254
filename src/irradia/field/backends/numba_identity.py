"""The fast version of :class:`irradia.field.encodings.Identity`: rows are copied."""

from __future__ import annotations

from irradia.field.backends.numba_compile import inner, kernel, take
from irradia.field.backends.numba_encoding import F32, TILE, NumbaEncoding
from irradia.field.backends.numba_vector import load8, store8
from irradia.field.backends.numba_vector_type import LANES
from irradia.field.encodings import Identity


class NumbaIdentity(NumbaEncoding[Identity]):
    """Copies the points."""

    def forward(self, points: F32, parameters: F32, features: F32, row: int) -> None:
        """As the base says."""
        self.team.run(_copy_all, points, features, row)


@kernel
def _copy_all(_thread, next_task, points, features, row):
    index = take(next_task)
    while index < len(features):
        copy_points(points, index * TILE, features[index], row)
        index = take(next_task)


@inner
def copy_points(points, first, tile, row):
    """Writes a tile's points, the batch's from sample ``first`` on, to three rows of the tile."""
    for axis in range(3):
        for s in range(0, TILE, LANES):
            store8(tile, (row + axis, s), load8(points, (axis, first + s)))
