"""Hash grids in Dr.Jit; :mod:`irradia.field.encodings.hash_grid` says what they are.

``drjit.nn.HashGridEncoding`` isn't used: it computes scale · x + ½ with one rounding where ours has two,
which moves gradients, and its tables are sized and its dense levels wrapped otherwise.
"""

from __future__ import annotations

from collections.abc import Iterator
from types import ModuleType

import drjit as dr
import numpy as np

from irradia.field.backends.drjit_encoding import Constants, Lookup
from irradia.field.backends.drjit_table import DrJitTable, whole
from irradia.field.backends.drjit_tiles import F, U
from irradia.field.encodings.hash_grid import CORNERS, HashGrid


class DrJitHashGrid(DrJitTable[HashGrid]):
    """A block is a level; all levels are one kernel that reads their sizes from arrays."""

    def __init__(self, encoding: HashGrid, jit: ModuleType, first: int) -> None:
        super().__init__(encoding, jit, first, encoding.n_levels)
        sizes = [level.n_entries for level in encoding.levels() if not level.dense]
        self._masks = all(size & (size - 1) == 0 for size in sizes)

    def constants(self) -> Constants:
        """A value per level of what :class:`~irradia.field.encodings.hash_grid.Level` says."""
        levels = self.encoding.levels()
        scales = self.jit.Float(np.array([level.scale for level in levels], np.float32))
        offsets = self.jit.Float(np.array([level.offset for level in levels], np.float32))
        sizes = [(level.resolution, level.first, level.n_entries, level.dense) for level in levels]
        names = ("resolution", "first", "n_entries", "dense")
        found = {
            name: dr.opaque(self.jit.UInt(np.array(values, np.uint32)))
            for name, values in zip(names, zip(*sizes, strict=True), strict=True)
        }
        zero = dr.opaque(self.jit.Float, 0.0)
        return found | {"scale": dr.opaque(scales), "offset": dr.opaque(offsets), "zero": zero}

    def corners(self, at: Lookup, grid: U) -> Iterator[tuple[U, F]]:
        """Those of the sample's cell."""
        level = {
            name: dr.gather(type(values), values, grid)
            for name, values in at.constants.items()
            if name != "zero"
        }
        cells, fractions = [], []
        for axis in range(3):
            x = dr.clip(at.coordinate(axis), 0.0, 1.0)
            # The product has to be rounded before the sum. A product followed by a sum might be fused, this
            # can't be: the compiler doesn't know that it adds 0.
            position = dr.fma(level["scale"], x, at.constants["zero"]) + level["offset"]
            cell = dr.floor(position)
            cells.append(whole(self.jit, cell))
            fractions.append(position - cell)
        for corner in CORNERS:
            weight = self.jit.Float(1.0)
            for beyond, fraction in zip(corner, fractions, strict=True):
                weight *= fraction if beyond else 1.0 - fraction
            at_corner = [cell + beyond for cell, beyond in zip(cells, corner, strict=True)]
            yield level["first"] + self._entry(level, at_corner), weight

    def _entry(self, level: dict[str, U], corner: list[U]) -> U:
        """Of a corner, in its level."""
        x, y, z = corner
        resolution, n_entries = level["resolution"], level["n_entries"]
        # At most r + r² + r³, which is less than twice the entries of a dense level.
        dense = x + resolution * (y + resolution * z)
        dense = dr.select(dense >= n_entries, dense - n_entries, dense)
        mixed = self.jit.UInt(0)
        for cell, prime in zip(corner, self.encoding.primes, strict=True):
            mixed ^= cell * self.jit.UInt(prime)
        hashed = mixed & (n_entries - 1) if self._masks else mixed % n_entries
        return dr.select(level["dense"] == 1, dense, hashed)
