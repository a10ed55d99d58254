"""The fast version of :class:`irradia.field.encodings.TriPlane`.

A texel's features lie side by side, so a lookup blends vectors of eight features, and those of eight samples
are transposed into rows of the tile. Features beyond whole eights go one by one.

Backward, a task is one plane and eight features of it, over all samples: so no two tasks add to the same
value, and a sum's order doesn't depend on the threads.
"""

from __future__ import annotations

import numpy as np

from irradia.field.backends.numba_adam import Adam, Learned, adam_sweep
from irradia.field.backends.numba_encoding import F32, TILE, NumbaEncoding
from irradia.field.backends.numba_team import Team
from irradia.field.backends.numba_transpose import transpose8
from irradia.field.backends.numba_vector import (
    LANES,
    floor,
    fma,
    inner,
    kernel,
    load8,
    rounded_product,
    select,
    splat8,
    store8,
    store_uint8,
    take,
    whole8,
)
from irradia.field.encodings import TriPlane
from irradia.field.encodings.tri_plane import PLANES

_SWEEP = 1 << 14  # values that a task takes through Adam
_N_PLANES = len(PLANES)


class NumbaTriPlane(NumbaEncoding[TriPlane]):
    """Keeps the gradient of all planes between their scatter and Adam's sweep."""

    def __init__(self, encoding: TriPlane, team: Team) -> None:
        super().__init__(encoding, team)
        scale, offset = encoding.texel_from_unit
        self._grid = (encoding.resolution, encoding.n_features, scale, offset)
        # Of eight samples for each thread: the first texel, in a cache line of its own, and the four weights.
        self._texels = np.zeros((team.n_threads, _N_PLANES, 16), np.uint32)
        self._weights = np.zeros((team.n_threads, _N_PLANES, 4, LANES), np.float32)
        self._gradient = np.zeros(0, np.float32)

    def forward(self, points: F32, parameters: F32, features: F32, row: int) -> None:
        """As the base says."""
        scratch = (self._texels, self._weights)
        self.team.run(_look_up_all, points, parameters, features, row, self._grid, scratch)

    def learn(self, points: F32, gradients: F32, row: int, learned: Learned, adam: Adam) -> None:
        """As the base says."""
        if not self._gradient.size:
            self._gradient = np.zeros(self.encoding.n_parameters, np.float32)
        scratch = (self._texels, self._weights)
        self.team.run(_scatter_all, points, self._gradient, gradients, row, self._grid, scratch)
        self.team.run(_sweep_all, learned, self._gradient, adam)


# --- where a sample falls --------------------------------------------------------------------------------


@inner
def _cell8(points, axis, sample, grid):
    """Texel coordinates of eight samples: whole part as integers, and the rest."""
    resolution, _, scale, offset = grid
    # The product is rounded by itself, as in the definition.
    place = rounded_product(load8(points, (axis, sample)), scale) + offset
    last = np.float32(resolution - 1)
    place = select(place > 0.0, select(place > last, last, place), 0.0)  # NaN goes to 0
    whole = floor(place)
    whole = select(whole > last - np.float32(1.0), last - np.float32(1.0), whole)
    return whole8(whole), place - whole


@inner
def _store_corners(texels, weights, plane, across, down, grid):
    """Writes the first texel of eight samples on a plane, and the weights of the four from there."""
    resolution = grid[0]
    (i, u), (j, v) = across, down
    store_uint8(texels, (plane, 0), (j + plane * resolution) * resolution + i)
    store8(weights, (plane, 0, 0), (1.0 - u) * (1.0 - v))
    store8(weights, (plane, 1, 0), u * (1.0 - v))
    store8(weights, (plane, 2, 0), (1.0 - u) * v)
    store8(weights, (plane, 3, 0), u * v)


# --- forward ---------------------------------------------------------------------------------------------


@kernel
def _look_up_all(thread, next_task, points, parameters, features, row, grid, scratch):
    texels, weights = scratch[0][thread], scratch[1][thread]
    index = take(next_task)
    while index < len(features):
        for s in range(0, TILE, LANES):
            sample = index * TILE + s
            x = _cell8(points, 0, sample, grid)
            y = _cell8(points, 1, sample, grid)
            z = _cell8(points, 2, sample, grid)
            _store_corners(texels, weights, 0, x, y, grid)
            _store_corners(texels, weights, 1, x, z, grid)
            _store_corners(texels, weights, 2, y, z, grid)
            for plane in range(_N_PLANES):
                _look_up(parameters, texels, weights, plane, features[index], row + plane * grid[1], s, grid)
        index = take(next_task)


@inner
def _look_up(parameters, texels, weights, plane, tile, row, s, grid):
    """All features of eight samples on a plane."""
    n_features = grid[1]
    for f in range(0, n_features - LANES + 1, LANES):
        a = _blend(parameters, texels, weights, plane, 0, f, grid)
        b = _blend(parameters, texels, weights, plane, 1, f, grid)
        c = _blend(parameters, texels, weights, plane, 2, f, grid)
        d = _blend(parameters, texels, weights, plane, 3, f, grid)
        e = _blend(parameters, texels, weights, plane, 4, f, grid)
        g = _blend(parameters, texels, weights, plane, 5, f, grid)
        h = _blend(parameters, texels, weights, plane, 6, f, grid)
        i = _blend(parameters, texels, weights, plane, 7, f, grid)
        a, b, c, d, e, g, h, i = transpose8(a, b, c, d, e, g, h, i)
        store8(tile, (row + f, s), a)
        store8(tile, (row + f + 1, s), b)
        store8(tile, (row + f + 2, s), c)
        store8(tile, (row + f + 3, s), d)
        store8(tile, (row + f + 4, s), e)
        store8(tile, (row + f + 5, s), g)
        store8(tile, (row + f + 6, s), h)
        store8(tile, (row + f + 7, s), i)
    for f in range(n_features // LANES * LANES, n_features):
        for lane in range(LANES):
            at, across, down = _address(texels, plane, lane, f, grid)
            tile[row + f, s + lane] = (
                weights[plane, 0, lane] * parameters[at]
                + weights[plane, 1, lane] * parameters[at + across]
                + weights[plane, 2, lane] * parameters[at + down]
                + weights[plane, 3, lane] * parameters[at + down + across]
            )


@inner
def _address(texels, plane, lane, feature, grid):
    """Where a sample's first texel stands in the flat array, and the ways to its neighbours."""
    resolution, n_features, _, _ = grid
    return np.int64(texels[plane, lane]) * n_features + feature, n_features, resolution * n_features


@inner
def _blend(parameters, texels, weights, plane, lane, feature, grid):
    """Eight features of one sample."""
    at, across, down = _address(texels, plane, lane, feature, grid)
    total = splat8(weights[plane, 0, lane]) * load8(parameters, at)
    total = fma(splat8(weights[plane, 1, lane]), load8(parameters, at + across), total)
    total = fma(splat8(weights[plane, 2, lane]), load8(parameters, at + down), total)
    return fma(splat8(weights[plane, 3, lane]), load8(parameters, at + down + across), total)


# --- backward --------------------------------------------------------------------------------------------


@kernel
def _scatter_all(thread, next_task, points, gradient, gradients, row, grid, scratch):
    """Adds every sample's gradient to four texels of each plane."""
    texels, weights = scratch[0][thread], scratch[1][thread]
    n_features = grid[1]
    n_tasks = _N_PLANES * ((n_features + LANES - 1) // LANES)
    task = take(next_task)
    while task < n_tasks:
        # Threads start on different planes: eights of one plane share cache lines.
        plane, feature = task % _N_PLANES, task // _N_PLANES * LANES
        across, down = (0, 1) if plane == 0 else ((0, 2) if plane == 1 else (1, 2))
        first_row = row + plane * n_features + feature
        for index in range(len(gradients)):
            for s in range(0, TILE, LANES):
                sample = index * TILE + s
                u, v = _cell8(points, across, sample, grid), _cell8(points, down, sample, grid)
                _store_corners(texels, weights, plane, u, v, grid)
                if feature + LANES <= n_features:
                    _scatter_eight(
                        gradient, texels, weights, plane, gradients[index], first_row, s, feature, grid
                    )
                else:
                    _scatter_rest(
                        gradient, texels, weights, plane, gradients[index], first_row, s, feature, grid
                    )
        task = take(next_task)


@inner
def _scatter_eight(gradient, texels, weights, plane, tile, row, s, feature, grid):
    a, b = load8(tile, (row, s)), load8(tile, (row + 1, s))
    c, d = load8(tile, (row + 2, s)), load8(tile, (row + 3, s))
    e, g = load8(tile, (row + 4, s)), load8(tile, (row + 5, s))
    h, i = load8(tile, (row + 6, s)), load8(tile, (row + 7, s))
    a, b, c, d, e, g, h, i = transpose8(a, b, c, d, e, g, h, i)
    _spread(gradient, texels, weights, plane, 0, feature, a, grid)
    _spread(gradient, texels, weights, plane, 1, feature, b, grid)
    _spread(gradient, texels, weights, plane, 2, feature, c, grid)
    _spread(gradient, texels, weights, plane, 3, feature, d, grid)
    _spread(gradient, texels, weights, plane, 4, feature, e, grid)
    _spread(gradient, texels, weights, plane, 5, feature, g, grid)
    _spread(gradient, texels, weights, plane, 6, feature, h, grid)
    _spread(gradient, texels, weights, plane, 7, feature, i, grid)


@inner
def _spread(gradient, texels, weights, plane, lane, feature, of_sample, grid):
    """Adds eight features' gradients of one sample."""
    at, across, down = _address(texels, plane, lane, feature, grid)
    _add8(gradient, at, splat8(weights[plane, 0, lane]), of_sample)
    _add8(gradient, at + across, splat8(weights[plane, 1, lane]), of_sample)
    _add8(gradient, at + down, splat8(weights[plane, 2, lane]), of_sample)
    _add8(gradient, at + down + across, splat8(weights[plane, 3, lane]), of_sample)


@inner
def _add8(gradient, at, weight, of_sample):
    store8(gradient, at, fma(weight, of_sample, load8(gradient, at)))


@inner
def _scatter_rest(gradient, texels, weights, plane, tile, row, s, feature, grid):
    for f in range(grid[1] - feature):
        for lane in range(LANES):
            at, across, down = _address(texels, plane, lane, feature + f, grid)
            of_sample = tile[row + f, s + lane]
            gradient[at] += weights[plane, 0, lane] * of_sample
            gradient[at + across] += weights[plane, 1, lane] * of_sample
            gradient[at + down] += weights[plane, 2, lane] * of_sample
            gradient[at + down + across] += weights[plane, 3, lane] * of_sample


@kernel
def _sweep_all(_thread, next_task, learned, gradient, adam):
    """Takes all values through Adam, and zeroes their gradient."""
    start = take(next_task) * _SWEEP
    while start < len(gradient):
        count = min(_SWEEP, len(gradient) - start)
        adam_sweep(learned, start, count, gradient[start : start + count], adam)
        start = take(next_task) * _SWEEP
