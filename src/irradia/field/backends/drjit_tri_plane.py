"""Tri-planes in Dr.Jit; :mod:`irradia.field.encodings.tri_plane` says what they are."""

from __future__ import annotations

from collections.abc import Iterator
from types import ModuleType

import drjit as dr

from irradia.field.backends.drjit_encoding import Constants, Lookup
from irradia.field.backends.drjit_table import DrJitTable, whole
from irradia.field.backends.drjit_tiles import F, U
from irradia.field.encodings.tri_plane import PLANES, TriPlane


class DrJitTriPlane(DrJitTable[TriPlane]):
    """A block is a plane and a group of features."""

    def __init__(self, encoding: TriPlane, jit: ModuleType, first: int) -> None:
        super().__init__(encoding, jit, first, len(PLANES))

    def constants(self) -> Constants:
        """A 0 that the compiler doesn't know of; see drjit_hash_grid.py."""
        return {"zero": dr.opaque(self.jit.Float, 0.0)}

    def corners(self, at: Lookup, grid: U) -> Iterator[tuple[U, F]]:
        """The four texels around a sample."""
        # xy, xz, yz: columns run along x, x, y and rows along y, z, z.
        column, u = self._cell(at, dr.select(grid == 2, self.jit.UInt(1), 0))
        row, v = self._cell(at, dr.select(grid == 0, self.jit.UInt(1), 2))
        for down, of_row in ((0, 1.0 - v), (1, v)):
            for across, of_column in ((0, 1.0 - u), (1, u)):
                line = grid * self.encoding.resolution + row + down
                yield line * self.encoding.resolution + column + across, of_row * of_column

    def _cell(self, at: Lookup, axis: U) -> tuple[U, F]:
        """The texel before a coordinate, and how far that is beyond its centre."""
        scale, offset = map(float, self.encoding.texel_from_unit)
        last = float(self.encoding.resolution - 1)
        position = dr.fma(self.jit.Float(scale), at.coordinate(axis), at.constants["zero"]) + offset
        position = dr.clip(position, 0.0, last)
        cell = dr.minimum(dr.floor(position), last - 1.0)
        return whole(self.jit, cell), position - cell
