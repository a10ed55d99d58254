"""How the Dr.Jit backend lays out a batch, and what its kernels share.

A batch is cut into tiles of 512 samples, the last filled up with copies of the batch's last sample, whose
gradient is 0. Features, activations and their gradients are (n_tiles, rows, 512): neighbouring threads touch
neighbouring samples, and a layer is one batched matrix product over the tiles. Rows are a multiple of eight,
the alignment of Dr.Jit's fast products on CUDA; the first row after the features is 1 and carries the bias.

Whatever changes from batch to batch, its size included, comes to kernels as arrays: Python numbers would be
compiled in.
"""

from __future__ import annotations

from dataclasses import dataclass
from types import ModuleType
from typing import Any

import drjit as dr
import numpy as np

TILE = 512  # samples; also the chunk in which gradients of matrices are summed
F = Any  # a drjit.llvm.Float or drjit.cuda.Float
U = Any  # a UInt of either


@dataclass
class Shape:
    """A batch's size, for kernels.

    Attributes:
        n: Samples, UInt of one value.
        n_padded: Those of whole tiles, likewise.
    """

    n: U
    n_padded: U


@dataclass
class Points:
    """Where samples lie, or their normals.

    Attributes:
        values: (3 n,) x, y, z of one sample after the other.
        n: Samples, UInt of one value.
    """

    values: F
    n: U

    def at(self, sample: U, axis: U | int, in_cube: bool) -> F:
        """One coordinate; ``in_cube`` brings a normal's from [−1, 1] into [0, 1]."""
        value = dr.gather(type(self.values), self.values, dr.minimum(sample, self.n - 1) * 3 + axis)
        return value * 0.5 + 0.5 if in_cube else value


def n_tiles(n: int) -> int:
    """Tiles of a batch."""
    return -(-n // TILE)


def whole_rows(n_features: int) -> int:
    """Rows of a tile with so many features and the bias."""
    return -(-(n_features + 1) // 8) * 8


def shape_of(jit: ModuleType, n: int) -> Shape:
    """The size of a batch of ``n``."""
    return Shape(dr.opaque(jit.UInt, n), dr.opaque(jit.UInt, n_tiles(n) * TILE))


def upload(jit: ModuleType, values: Any) -> F:
    """A copy of an array in its own memory; on the CPU Dr.Jit would otherwise go on reading NumPy's."""
    return dr.opaque(jit.Float(np.ascontiguousarray(values, np.float32).ravel()))


def address(sample: U, row: U | int, n_rows: int) -> U:
    """Where a row's value for a sample stands in (n_tiles, n_rows, 512)."""
    return (sample // TILE * n_rows + row) * TILE + sample % TILE


def write(target: F, value: F, place: U) -> None:
    """Stores values at places that no other thread or call of the same kernel writes to.

    Dr.Jit isn't told so by default, and launches a kernel for each call.
    """
    dr.scatter(target, value, place, mode=dr.ReduceMode.NoConflicts)
