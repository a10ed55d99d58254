"""Hash grids: corners of eight samples at once, then table entries one by one.

Forward goes level by level, all threads on one, so that a level's table stays in the last-level cache. Right
before, the table is read once in order, which memory likes better than the jumps that follow: that nearly
halves the time. Prefetches didn't help, nor reading a level while the one before it is looked up.

Backward needs no atomics: a level belongs to one thread, which adds into scratch memory of its own (at most
4 MB at 2^19 × 2), and then sweeps Adam over that level. The largest levels come first, so that threads end
together.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from irradia.field.backends.numba_adam import Adam, Learned, adam_sweep
from irradia.field.backends.numba_compile import inner, kernel, take
from irradia.field.backends.numba_encoding import F32, TILE, NumbaEncoding
from irradia.field.backends.numba_team import Team
from irradia.field.backends.numba_vector import (
    floor,
    fma,
    join2,
    lane,
    load2,
    load8,
    rounded_product,
    select,
    splat2,
    splat8,
    store2,
    store8,
    store_uint8,
    touch,
    whole8,
)
from irradia.field.encodings.hash_grid import HashGrid

_RUN = 16  # tiles of a forward task
_PIECES = 4  # in which a level's table is read before its first task
_CORNERS = 8
_LINE = 16  # floats of a cache line
_ALL_BITS = np.uint32(0xFFFFFFFF)


class Levels(NamedTuple):
    """The grids as kernels see them, (L,) each; see :class:`irradia.field.encodings.hash_grid.Level`.

    Attributes:
        largest_first: Their numbers by falling size.
        primes: (3,) factors of the hash.
        n_features: Of an entry.
    """

    scale: F32
    offset: F32
    resolution: NDArray[np.uint32]
    first: NDArray[np.int64]
    n_entries: NDArray[np.int64]
    dense: NDArray[np.bool_]
    largest_first: NDArray[np.int64]
    primes: NDArray[np.uint32]
    n_features: int


class NumbaHashGrid(NumbaEncoding[HashGrid]):
    """The fast version of :class:`irradia.field.encodings.hash_grid.HashGrid`."""

    def __init__(self, encoding: HashGrid, team: Team) -> None:
        super().__init__(encoding, team)
        self._levels = _levels(encoding)
        self._entries = np.zeros((team.n_threads, _CORNERS, TILE), np.uint32)
        self._weights = np.zeros((team.n_threads, _CORNERS, TILE), np.float32)
        self._gradient: F32 | None = None  # only training needs it

    def forward(self, points: F32, parameters: F32, features: F32, row: int) -> None:
        """See the base class."""
        self.team.run(_forward, points, parameters, features, row, self._levels, self._entries, self._weights)

    def learn(self, points: F32, gradients: F32, row: int, learned: Learned, adam: Adam) -> None:
        """See the base class."""
        if self._gradient is None:
            largest = int(self._levels.n_entries.max()) * self.encoding.n_features
            self._gradient = np.zeros((self.team.n_threads, largest), np.float32)
        self.team.run(
            _learn,
            points,
            gradients,
            row,
            learned,
            adam,
            self._levels,
            self._entries,
            self._weights,
            self._gradient,
        )


def _levels(encoding: HashGrid) -> Levels:
    levels = encoding.levels()
    n_entries = np.array([level.n_entries for level in levels], np.int64)
    return Levels(
        np.array([level.scale for level in levels], np.float32),
        np.array([level.offset for level in levels], np.float32),
        np.array([level.resolution for level in levels], np.uint32),
        np.array([level.first for level in levels], np.int64),
        n_entries,
        np.array([level.dense for level in levels], np.bool_),
        np.argsort(-n_entries, kind="stable"),
        np.array(encoding.primes, np.uint32),
        encoding.n_features,
    )


@kernel
def _forward(thread, next_task, points, table, features, row, levels, entries, weights):
    """Interpolates features; task: a run of tiles on one level.

    Args:
        thread, next_task: See numba_team.py.
        points: (3, n_tiles · 256).
        table: (P,), levels one after another.
        features: (n_tiles, rows, 272), written.
        row: Of the first level's first feature.
        levels: Levels.
        entries: (threads, 8, 256) scratch memory for corners' entries.
        weights: (threads, 8, 256) scratch memory for their weights.
    """
    n_tiles = features.shape[0]
    n_runs = (n_tiles + _RUN - 1) // _RUN
    entry, weight = entries[thread], weights[thread]
    n_features = levels.n_features
    while True:
        task = take(next_task)
        level, step = task // (_PIECES + n_runs), task % (_PIECES + n_runs)
        if level >= len(levels.scale):
            break
        own = _table_of(level, table, levels)
        if step < _PIECES:
            if n_tiles * TILE * _CORNERS > len(own) // _LINE:  # more jumps than lines
                _bring(own, step, _PIECES)
            continue
        first_row = row + level * n_features
        first_tile = (step - _PIECES) * _RUN
        for tile in range(first_tile, min(first_tile + _RUN, n_tiles)):
            _corners(points, tile * TILE, levels, level, entry, weight)
            if n_features == 2:  # the usual, compiled for it
                _gather(own, entry, weight, 2, features[tile], first_row)
            elif n_features == 4:
                _gather(own, entry, weight, 4, features[tile], first_row)
            else:
                _gather(own, entry, weight, n_features, features[tile], first_row)


@inner
def _table_of(level, table, levels):
    """A level's part of the parameters."""
    first, stop = levels.first[level], levels.first[level] + levels.n_entries[level]
    return table[first * levels.n_features : stop * levels.n_features]


@inner
def _bring(table, share, n_shares):
    """Brings a share of a table into the caches, in order."""
    for i in range(share * len(table) // n_shares, (share + 1) * len(table) // n_shares, _LINE):
        touch(table, i)


@inner
def _corners(points, first, levels, level, entry, weight):
    """Entries in a level's table, and weights, of the corners around 256 samples."""
    scale, offset = levels.scale[level], levels.offset[level]
    dense, resolution = levels.dense[level], levels.resolution[level]
    n_entries = np.uint32(levels.n_entries[level])
    step_x, step_y, step_z = levels.primes[0], levels.primes[1], levels.primes[2]
    if dense:
        step_x, step_y, step_z = np.uint32(1), resolution, np.uint32(resolution * resolution)
    mask = _ALL_BITS  # for tables of another size than a power of two, which are rare
    if n_entries & (n_entries - 1) == 0:
        mask = np.uint32(n_entries - 1)
    for s in range(0, TILE, 8):
        x0, fx = _cell(load8(points, (0, first + s)), scale, offset)
        y0, fy = _cell(load8(points, (1, first + s)), scale, offset)
        z0, fz = _cell(load8(points, (2, first + s)), scale, offset)
        corner = 0
        for dx in range(2):
            x, wx = (x0 + dx) * step_x, select(dx == 1, fx, 1.0 - fx)
            for dy in range(2):
                y, wxy = (y0 + dy) * step_y, wx * select(dy == 1, fy, 1.0 - fy)
                for dz in range(2):
                    z = (z0 + dz) * step_z
                    if dense:
                        at = x + y + z
                        at = select(at >= n_entries, at - n_entries, at)
                    else:
                        at = (x ^ y ^ z) & mask
                    store_uint8(entry, (corner, s), at)
                    store8(weight, (corner, s), wxy * select(dz == 1, fz, 1.0 - fz))
                    corner += 1
    if not dense and mask == _ALL_BITS:
        for corner in range(_CORNERS):
            for s in range(TILE):
                entry[corner, s] %= n_entries


@inner
def _cell(x, scale, offset):
    """The cell that holds a coordinate, and how far into it."""
    x = select(x > 0.0, select(x > 1.0, splat8(1.0), x), splat8(0.0))  # NaN goes to 0
    position = rounded_product(x, scale) + offset  # rounds twice, as the definition does
    cell = floor(position)
    return whole8(cell), position - cell


@inner
def _gather(table, entry, weight, n_features, features, row):
    """Interpolates a tile's features of one level, two at a time."""
    for s in range(TILE):
        for f in range(0, n_features - 1, 2):
            pair = splat2(0.0)
            for corner in range(_CORNERS):
                at = np.int64(entry[corner, s]) * n_features + f
                pair = fma(splat2(weight[corner, s]), load2(table, at), pair)
            features[row + f, s] = lane(pair, 0)
            features[row + f + 1, s] = lane(pair, 1)
        if n_features % 2:
            last, total = n_features - 1, np.float32(0.0)
            for corner in range(_CORNERS):
                total += weight[corner, s] * table[np.int64(entry[corner, s]) * n_features + last]
            features[row + last, s] = total


@kernel
def _learn(thread, next_task, points, gradients, row, learned, adam, levels, entries, weights, scratch):
    """Spreads gradients over the corners of a level and takes a step of Adam there; task: a level.

    Args:
        thread, next_task: See numba_team.py.
        points: (3, n_tiles · 256).
        gradients: (n_tiles, rows, 272).
        row: Of the first level's first feature.
        learned: Learned.
        adam: Adam.
        levels: Levels.
        entries, weights: (threads, 8, 256) scratch memory, as in forward.
        scratch: (threads, largest level) zeros, and zeros again afterwards.
    """
    entry, weight, gradient = entries[thread], weights[thread], scratch[thread]
    n_features = levels.n_features
    while True:
        task = take(next_task)
        if task >= len(levels.scale):
            break
        level = levels.largest_first[task]
        first_row = row + level * n_features
        _bring(gradient[: levels.n_entries[level] * n_features], 0, 1)
        for tile in range(gradients.shape[0]):
            _corners(points, tile * TILE, levels, level, entry, weight)
            if n_features == 2:
                _scatter(gradient, entry, weight, 2, gradients[tile], first_row)
            elif n_features == 4:
                _scatter(gradient, entry, weight, 4, gradients[tile], first_row)
            else:
                _scatter(gradient, entry, weight, n_features, gradients[tile], first_row)
        size = levels.n_entries[level] * n_features
        adam_sweep(learned, levels.first[level] * n_features, size, gradient, adam)


@inner
def _scatter(table, entry, weight, n_features, gradients, row):
    """Adds a tile's gradients of one level to its corners, the other way round."""
    for s in range(TILE):
        for f in range(0, n_features - 1, 2):
            pair = join2(gradients[row + f, s], gradients[row + f + 1, s])
            for corner in range(_CORNERS):
                at = np.int64(entry[corner, s]) * n_features + f
                store2(table, at, fma(splat2(weight[corner, s]), pair, load2(table, at)))
        if n_features % 2:
            last = n_features - 1
            for corner in range(_CORNERS):
                at = np.int64(entry[corner, s]) * n_features + last
                table[at] += weight[corner, s] * gradients[row + last, s]
