"""Tables of learned features that are interpolated: what hash grids and tri-planes share."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Iterator
from types import ModuleType
from typing import TypeVar

import drjit as dr

from irradia.field.backends.drjit_encoding import DrJitEncoding, Lookup
from irradia.field.backends.drjit_fixed_point import add
from irradia.field.backends.drjit_tiles import F, U
from irradia.field.encodings.hash_grid import HashGrid
from irradia.field.encodings.tri_plane import TriPlane

T = TypeVar("T", HashGrid, TriPlane)
_MOST_AT_ONCE = 8  # features of one load


class DrJitTable(DrJitEncoding[T]):
    """Entries of ``n_features`` values, some of which a sample sees in each of several grids.

    A block is a grid and a group of features that are contiguous, so that they are loaded as one packet.
    """

    n_grids: int

    def __init__(self, encoding: T, jit: ModuleType, first: int, n_grids: int) -> None:
        super().__init__(encoding, jit, first)
        n_features = encoding.n_features
        fitting = (s for s in (_MOST_AT_ONCE, 4, 2) if n_features % s == 0 and first % s == 0)
        self.block_size = next(fitting, 1)
        self._n_groups = n_features // self.block_size
        self.n_blocks = n_grids * self._n_groups

    @abstractmethod
    def corners(self, at: Lookup, grid: U) -> Iterator[tuple[U, F]]:
        """Entry, of the whole table, and weight of each corner that a sample sees in a grid."""

    def features(self, at: Lookup, parameters: F) -> list[F]:
        """See the base class."""
        values = [self.jit.Float(0.0)] * self.block_size
        for packet, weight in self._packets(at):
            found = dr.gather(self.jit.ArrayXf, parameters, packet, shape=(self.block_size, dr.width(packet)))
            values = [dr.fma(weight, found[i], value) for i, value in enumerate(values)]
        return values

    def scatter(self, at: Lookup, gradients: list[F], scale: F, target: F) -> None:
        """See the base class."""
        for packet, weight in self._packets(at):
            for i, gradient in enumerate(gradients):
                add(self.jit, target, weight * gradient * scale, packet * self.block_size + i)

    def _packets(self, at: Lookup) -> Iterator[tuple[U, F]]:
        """Corners in units of what is loaded at once."""
        grid, group = at.block // self._n_groups, at.block % self._n_groups
        first = self.first // self.block_size
        for entry, weight in self.corners(at, grid):
            yield first + entry * self._n_groups + group, weight


def whole(jit: ModuleType, cell: F) -> U:
    """A cell's number as an index. That of a point which is no number is 0, so that nothing else is read."""
    return jit.UInt(dr.select(cell >= 0.0, cell, 0.0))
