"""The fast version of :class:`irradia.field.encodings.TriPlane`.

A texel's features lie side by side, so a lookup blends vectors of eight features, and those of eight samples
are transposed into rows of the tile. Features beyond whole eights go one by one.

Forward goes plane by plane, all threads on one, as a plane is about what a core's cache holds. Backward, a
task is eight features of a plane over all samples: so no two tasks add to the same value, and the order of a
sum doesn't depend on the threads.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from irradia.field.backends.numba_adam import Adam, Learned, adam_sweep
from irradia.field.backends.numba_compile import inner, kernel, take
from irradia.field.backends.numba_encoding import F32, TILE, NumbaEncoding
from irradia.field.backends.numba_team import Team
from irradia.field.backends.numba_transpose import transpose8
from irradia.field.backends.numba_vector import (
    floor,
    fma,
    load8,
    rounded_product,
    select,
    splat8,
    store8,
    store_uint8,
    whole8,
)
from irradia.field.backends.numba_vector_type import LANES
from irradia.field.encodings import TriPlane
from irradia.field.encodings.tri_plane import PLANES

_SWEEP = 1 << 14  # values that a task takes through Adam
_N_PLANES = len(PLANES)


class Planes(NamedTuple):
    """The planes as kernels see them, with memory for each thread.

    Attributes:
        axes: (3, 2) coordinates along columns and rows.
        scale, offset: Texel coordinates are ``scale * x + offset``.
        resolution: Texels a side.
        n_features: Of a texel.
        texel: (threads, 256) where each sample's first texel stands in the flat array.
        weight: (threads, 4, 256) of it, of that to its right, and of the two in the next row.
        seen: (threads, 16) sums of what was read ahead; the compiler would leave unused reads out.
    """

    axes: NDArray[np.int64]
    scale: np.float32
    offset: np.float32
    resolution: int
    n_features: int
    texel: NDArray[np.uint32]
    weight: F32
    seen: F32


class NumbaTriPlane(NumbaEncoding[TriPlane]):
    """Keeps the gradient of all planes between their scatter and Adam's sweep."""

    def __init__(self, encoding: TriPlane, team: Team) -> None:
        super().__init__(encoding, team)
        self._planes = Planes(
            np.array(PLANES, np.int64),
            *encoding.texel_from_unit,
            encoding.resolution,
            encoding.n_features,
            np.zeros((team.n_threads, TILE), np.uint32),
            np.zeros((team.n_threads, 4, TILE), np.float32),
            np.zeros((team.n_threads, 16), np.float32),
        )
        self._gradient: F32 | None = None  # only training needs it

    def forward(self, points: F32, parameters: F32, features: F32, row: int) -> None:
        """See the base class."""
        self.team.run(_look_up, points, parameters, features, row, self._planes)

    def learn(self, points: F32, gradients: F32, row: int, learned: Learned, adam: Adam) -> None:
        """See the base class."""
        if self._gradient is None:
            self._gradient = np.zeros(self.encoding.n_parameters, np.float32)
        self.team.run(_scatter, points, gradients, row, self._gradient, self._planes)
        self.team.run(_sweep, learned, self._gradient, adam)


# --- where samples fall ----------------------------------------------------------------------------------


@inner
def _locate(points, first, plane, planes, texel, weight):
    """Where 256 samples' first texels stand, and the weights of the four from there."""
    across, down = planes.axes[plane, 0], planes.axes[plane, 1]
    resolution = planes.resolution
    for s in range(0, TILE, LANES):
        column, u = _cell(load8(points, (across, first + s)), planes)
        row, v = _cell(load8(points, (down, first + s)), planes)
        number = (row + plane * resolution) * resolution + column
        store_uint8(texel, s, number * planes.n_features)
        store8(weight, (0, s), (1.0 - u) * (1.0 - v))
        store8(weight, (1, s), u * (1.0 - v))
        store8(weight, (2, s), (1.0 - u) * v)
        store8(weight, (3, s), u * v)


@inner
def _cell(x, planes):
    """The texel before a coordinate, and how far beyond its centre."""
    place = rounded_product(x, planes.scale) + planes.offset  # rounds twice, as the definition does
    last = np.float32(planes.resolution - 1)
    place = select(place > 0.0, select(place > last, last, place), 0.0)  # NaN goes to 0
    whole = floor(place)
    whole = select(whole > last - np.float32(1.0), last - np.float32(1.0), whole)
    return whole8(whole), place - whole


# --- forward ---------------------------------------------------------------------------------------------


@kernel
def _look_up(thread, next_task, points, parameters, features, row, planes):
    """Interpolates features; task: a tile on one plane.

    Args:
        thread, next_task: See numba_team.py.
        points: (3, n_tiles · 256).
        parameters: (P,).
        features: (n_tiles, rows, 272), written.
        row: Of the first feature.
        planes: Planes.
    """
    n_tiles, n_features = len(features), planes.n_features
    texel, weight = planes.texel[thread], planes.weight[thread]
    down = planes.resolution * n_features
    while True:
        task = take(next_task)
        plane, tile = task // n_tiles, task % n_tiles
        if plane >= _N_PLANES:
            break
        _locate(points, tile * TILE, plane, planes, texel, weight)
        first_row = row + plane * n_features
        eights = n_features // LANES * LANES
        _look_up_eights(parameters, texel, weight, features[tile], first_row, eights, n_features, down)
        for f in range(eights, n_features):
            _look_up_one(parameters, texel, weight, features[tile], first_row, f, n_features, down)


@inner
def _look_up_eights(parameters, texel, weight, tile, row, stop, across, down):
    """Features up to ``stop`` of a tile; ``across`` and ``down`` are the ways to neighbouring texels."""
    for s in range(0, TILE, LANES):
        for f in range(0, stop, LANES):
            a = _blend(parameters, texel, weight, s, f, across, down)
            b = _blend(parameters, texel, weight, s + 1, f, across, down)
            c = _blend(parameters, texel, weight, s + 2, f, across, down)
            d = _blend(parameters, texel, weight, s + 3, f, across, down)
            e = _blend(parameters, texel, weight, s + 4, f, across, down)
            g = _blend(parameters, texel, weight, s + 5, f, across, down)
            h = _blend(parameters, texel, weight, s + 6, f, across, down)
            i = _blend(parameters, texel, weight, s + 7, f, across, down)
            a, b, c, d, e, g, h, i = transpose8(a, b, c, d, e, g, h, i)
            store8(tile, (row + f, s), a)
            store8(tile, (row + f + 1, s), b)
            store8(tile, (row + f + 2, s), c)
            store8(tile, (row + f + 3, s), d)
            store8(tile, (row + f + 4, s), e)
            store8(tile, (row + f + 5, s), g)
            store8(tile, (row + f + 6, s), h)
            store8(tile, (row + f + 7, s), i)


@inner
def _blend(parameters, texel, weight, s, f, across, down):
    """Eight features of one sample."""
    at = np.int64(texel[s]) + f
    total = splat8(weight[0, s]) * load8(parameters, at)
    total = fma(splat8(weight[1, s]), load8(parameters, at + across), total)
    total = fma(splat8(weight[2, s]), load8(parameters, at + down), total)
    return fma(splat8(weight[3, s]), load8(parameters, at + down + across), total)


@inner
def _look_up_one(parameters, texel, weight, tile, row, f, across, down):
    """One feature of a tile."""
    for s in range(TILE):
        at = np.int64(texel[s]) + f
        tile[row + f, s] = (
            weight[0, s] * parameters[at]
            + weight[1, s] * parameters[at + across]
            + weight[2, s] * parameters[at + down]
            + weight[3, s] * parameters[at + down + across]
        )


# --- backward --------------------------------------------------------------------------------------------


@kernel
def _scatter(thread, next_task, points, gradients, row, totals, planes):
    """Adds every sample's gradient to four texels of each plane; task: up to eight features of a plane.

    Args:
        thread, next_task: See numba_team.py.
        points: (3, n_tiles · 256).
        gradients: (n_tiles, rows, 272).
        row: Of the first feature.
        totals: (P,), added to.
        planes: Planes.
    """
    n_features = planes.n_features
    texel, weight = planes.texel[thread], planes.weight[thread]
    down = planes.resolution * n_features
    while True:
        task = take(next_task)
        # Neighbouring tasks are on different planes: features of one texel share a cache line.
        plane, f = task % _N_PLANES, task // _N_PLANES * LANES
        if f >= n_features:
            break
        first_row = row + plane * n_features
        for tile in range(len(gradients)):
            _locate(points, tile * TILE, plane, planes, texel, weight)
            if f + LANES <= n_features:
                planes.seen[thread, 0] = _touch(gradients[tile], first_row + f)
                _scatter_eight(totals, texel, weight, gradients[tile], first_row, f, n_features, down)
            else:
                for one in range(f, n_features):
                    _scatter_one(totals, texel, weight, gradients[tile], first_row, one, n_features, down)


@inner
def _touch(tile, row):
    """Reads eight rows in order, which memory likes better than all at once (5.0 → 2.9 ms of a step)."""
    total = np.float32(0.0)
    for i in range(row, row + LANES):
        for s in range(0, TILE, 16):
            total += tile[i, s]
    return total


@inner
def _scatter_eight(totals, texel, weight, tile, row, f, across, down):
    """Eight features of a tile."""
    for s in range(0, TILE, LANES):
        a, b = load8(tile, (row + f, s)), load8(tile, (row + f + 1, s))
        c, d = load8(tile, (row + f + 2, s)), load8(tile, (row + f + 3, s))
        e, g = load8(tile, (row + f + 4, s)), load8(tile, (row + f + 5, s))
        h, i = load8(tile, (row + f + 6, s)), load8(tile, (row + f + 7, s))
        a, b, c, d, e, g, h, i = transpose8(a, b, c, d, e, g, h, i)
        _spread(totals, texel, weight, s, f, a, across, down)
        _spread(totals, texel, weight, s + 1, f, b, across, down)
        _spread(totals, texel, weight, s + 2, f, c, across, down)
        _spread(totals, texel, weight, s + 3, f, d, across, down)
        _spread(totals, texel, weight, s + 4, f, e, across, down)
        _spread(totals, texel, weight, s + 5, f, g, across, down)
        _spread(totals, texel, weight, s + 6, f, h, across, down)
        _spread(totals, texel, weight, s + 7, f, i, across, down)


@inner
def _spread(totals, texel, weight, s, f, gradient, across, down):
    """Adds eight features' gradients of one sample."""
    at = np.int64(texel[s]) + f
    _add(totals, at, splat8(weight[0, s]), gradient)
    _add(totals, at + across, splat8(weight[1, s]), gradient)
    _add(totals, at + down, splat8(weight[2, s]), gradient)
    _add(totals, at + down + across, splat8(weight[3, s]), gradient)


@inner
def _add(totals, at, weight, gradient):
    store8(totals, at, fma(weight, gradient, load8(totals, at)))


@inner
def _scatter_one(totals, texel, weight, tile, row, f, across, down):
    """One feature of a tile."""
    for s in range(TILE):
        at, gradient = np.int64(texel[s]) + f, tile[row + f, s]
        totals[at] += weight[0, s] * gradient
        totals[at + across] += weight[1, s] * gradient
        totals[at + down] += weight[2, s] * gradient
        totals[at + down + across] += weight[3, s] * gradient


@kernel
def _sweep(thread, next_task, learned, gradient, adam):
    """Takes all values through Adam, and zeroes their gradient; task: a range of them."""
    while True:
        start = take(next_task) * _SWEEP
        if start >= len(gradient):
            break
        count = min(_SWEEP, len(gradient) - start)
        adam_sweep(learned, start, count, gradient[start : start + count], adam)
