"""Multi-resolution hash grid (Müller et al. 2022, section 3), in tiny-cuda-nn's conventions.

Level l has scale_l = b^l · base − 1 with b = (max / base)^(1 / (levels − 1)), and resolution
r_l = ceil(scale_l) + 1. A point lies at scale_l · x + ½; its cell's eight corners are interpolated linearly.
A level whose r_l³ corners fit its table is dense, x fastest; others are hashed.

Where ours differs:

- scale_l is computed in double precision and then rounded to float, so that a level meant to have
  resolution 2048 has it; exp2f may give 2049.
- scale_l · x + ½ rounds twice, in float; tiny-cuda-nn fuses it. Whatever computes a gradient must round the
  same way: unrounded positions move gradients by 6e-3 at resolution 2048.
- A point outside [0, 1] is clamped to it, so cells are never negative.

At x = 1 a corner may lie one beyond a dense level. As in tiny-cuda-nn its index runs on into the next row,
and wraps at the table's end.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from dataclasses import dataclass
from typing import ClassVar, Literal

import numpy as np
from numpy.typing import NDArray

from irradia.core.errors import InputError
from irradia.field.encoding import Array, Encoding, TensorSlot

PRIMES = (1, 2654435761, 805459861)  # of x, y and z
CORNERS = tuple(itertools.product((0, 1), repeat=3))


@dataclass(frozen=True)
class Level:
    """One grid, as kernels want it.

    Attributes:
        scale: Cells along the box; a float32.
        offset: In cells; a point lies at ``scale * x + offset``.
        resolution: Corners along an axis; the stride of dense levels.
        first: Of its entries in the flat table, which holds ``n_features`` values for each.
        n_entries: Of its own.
        dense: Whether corners are numbered, or else hashed.
    """

    scale: np.float32
    offset: np.float32
    resolution: int
    first: int
    n_entries: int
    dense: bool


@dataclass(frozen=True)
class HashGrid(Encoding):
    """Learned features on the corners of grids, from coarse to fine.

    Attributes:
        n_levels: Grids.
        log2_table_size: The most entries of a level, as a power of two.
        n_features: Values of an entry.
        base_resolution, max_resolution: Of the coarsest and finest grid; those between grow geometrically.
        full_levels: Every level stores ``2**log2_table_size`` entries, needed or not.
        hash_all: Dense levels are hashed too; some PyTorch ports do that.
        convention: ``tiny-cuda-nn``, as above; ``floor``, as some PyTorch ports: r_l = floor(b^l · base),
            and a point lies at r_l · x.
        primes: Factors of x, y and z in the hash.
    """

    name: ClassVar[str] = "hash"

    n_levels: int = 16
    log2_table_size: int = 19
    n_features: int = 2
    base_resolution: int = 16
    max_resolution: int = 2048
    full_levels: bool = False
    hash_all: bool = False
    convention: Literal["tiny-cuda-nn", "floor"] = "tiny-cuda-nn"
    primes: tuple[int, int, int] = PRIMES

    def __post_init__(self) -> None:
        if not (1 <= self.n_levels <= 32 and 1 <= self.n_features <= 16 and 3 <= self.log2_table_size <= 28):
            found = f"{self.n_levels}, {self.n_features} and {self.log2_table_size}"
            raise InputError(f"expected 1–32 levels, 1–16 features, tables of 2^3–2^28, found {found}")
        if not 2 <= self.base_resolution <= self.max_resolution <= 1 << 20:
            found = f"{self.base_resolution} to {self.max_resolution}"
            raise InputError(f"expected resolutions that grow from at least 2 to at most 2^20, found {found}")
        if self.convention not in ("tiny-cuda-nn", "floor"):
            raise InputError(f"expected the convention tiny-cuda-nn or floor, found {self.convention!r}")
        if len(self.primes) != 3 or not all(isinstance(p, int) and 0 < p < 1 << 32 for p in self.primes):
            raise InputError(f"expected three factors below 2^32, found {self.primes}")

    @property
    def n_outputs(self) -> int:
        """Features of all levels, the coarsest first."""
        return self.n_levels * self.n_features

    def levels(self) -> tuple[Level, ...]:
        """The grids, the coarsest first."""
        found: list[Level] = []
        first = 0
        for index in range(self.n_levels):
            level = self._level(index, first)
            found.append(level)
            first += level.n_entries
        return tuple(found)

    def tensors(self) -> tuple[TensorSlot, ...]:
        """One table (entries, features) a level."""
        return tuple(
            TensorSlot(f"level.{i}", (level.n_entries, self.n_features))
            for i, level in enumerate(self.levels())
        )

    def init(self, rng: np.random.Generator) -> NDArray[np.float32]:
        """Uniform in ±1e-4, as in the paper."""
        return rng.uniform(-1e-4, 1e-4, self.n_parameters).astype(np.float32)

    def forward(self, x: Array, parameters: Array) -> Array:
        """Interpolated features (N, levels · features)."""
        table = parameters.reshape(-1, self.n_features)
        features = np.zeros((len(x), self.n_levels, self.n_features), parameters.dtype)
        for i, level in enumerate(self.levels()):
            for entry, weight in self._corners(level, x):
                features[:, i] += weight[:, None].astype(parameters.dtype) * table[entry]
        return features.reshape(len(x), self.n_outputs)

    def backward(self, x: Array, parameters: Array, gradient: Array) -> Array:
        """Spreads each feature's gradient over its eight corners."""
        table = np.zeros_like(parameters).reshape(-1, self.n_features)
        for i, level in enumerate(self.levels()):
            of_level = gradient[:, i * self.n_features : (i + 1) * self.n_features]
            for entry, weight in self._corners(level, x):
                np.add.at(table, entry, weight[:, None].astype(parameters.dtype) * of_level)
        return table.ravel()

    def _level(self, index: int, first: int) -> Level:
        growth = np.log2(self.max_resolution / self.base_resolution) * index / max(self.n_levels - 1, 1)
        cells = 2.0**growth * self.base_resolution
        if self.convention == "tiny-cuda-nn":
            scale, offset = np.float32(cells - 1.0), np.float32(0.5)
            resolution = int(np.ceil(scale)) + 1
        else:
            # A resolution meant to be whole mustn't fall below it by rounding.
            scale, offset = np.float32(np.floor(np.float32(cells))), np.float32(0.0)
            resolution = int(scale) + 1  # n cells have n + 1 corners
        n_entries = 1 << self.log2_table_size
        if not self.full_levels:
            n_entries = min(-(-(resolution**3) // 8) * 8, n_entries)
        dense = not self.hash_all and resolution**3 <= n_entries
        return Level(scale, offset, resolution, first, n_entries, dense)

    def _corners(self, level: Level, x: Array) -> Iterator[tuple[NDArray[np.int64], Array]]:
        """(N,) entry in the flat table and (N,) weight of each of a cell's corners."""
        position = level.scale * np.clip(x, 0.0, 1.0).astype(np.float32) + level.offset
        cell = np.floor(position)
        fraction = (position - cell).astype(np.float64)  # exact in float32 too
        for corner in CORNERS:
            weight = np.where(corner, fraction, 1.0 - fraction).prod(axis=1)
            yield level.first + self._entry(level, cell.astype(np.int64) + corner), weight

    def _entry(self, level: Level, corner: NDArray[np.int64]) -> NDArray[np.int64]:
        if level.dense:
            strides = np.array([1, level.resolution, level.resolution**2])
            return (corner @ strides) % level.n_entries
        mixed = corner.astype(np.uint32) * np.array(self.primes, np.uint32)  # wraps at 2³²
        return np.bitwise_xor.reduce(mixed, axis=1).astype(np.int64) % level.n_entries
