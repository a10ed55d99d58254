"""Which probes lie around a place, and which are each other's neighbours."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from irradia.formats.probes import NO_PROBE, ProbeGrid, ProbeOctree, ProbeSet

I64 = NDArray[np.int64]
F64 = NDArray[np.float64]

N_AROUND = 8  # probes that a place is interpolated from
NOBODY = -1
_CORNERS = np.array([(i & 1, i >> 1 & 1, i >> 2 & 1) for i in range(8)], np.int64)


def probes_around(probes: ProbeSet, points: F64) -> tuple[I64, F64]:
    """The probes that interpolation at points (Q, 3) draws on, and how much before sight counts.

    In grids and octrees these are the corners of the cell that holds the point, weighted trilinearly;
    points beyond the outermost probes take the nearest place that has a cell. Loose probes, and places
    where an octree has no cell, take the nearest eight, weighted by distance.

    Returns:
        (Q, 8) probes, NOBODY where there is none, and (Q, 8) weights.
    """
    match probes.structure:
        case ProbeGrid():
            return _in_grid(probes.structure, points)
        case ProbeOctree():
            return _in_octree(probes, probes.structure, points)
    return _nearest(probes, points)


def neighbour_pairs(probes: ProbeSet) -> I64:
    """(P, 2) pairs of probes that share a cell, or lie near each other; each pair once, lower first."""
    match probes.structure:
        case ProbeGrid(shape=shape):
            cells = _grid_cells(shape)
        case ProbeOctree(corners=corners):
            cells = np.where(corners == NO_PROBE, NOBODY, corners.astype(np.int64))
        case _:
            cells, _ = _nearest(probes, probes.positions.astype(np.float64))
    first, second = np.triu_indices(cells.shape[1], 1)
    pairs = np.stack([cells[:, first].ravel(), cells[:, second].ravel()], axis=1)
    pairs = np.sort(pairs[(pairs >= 0).all(axis=1)], axis=1)
    return np.unique(pairs[pairs[:, 0] != pairs[:, 1]], axis=0)


def _grid_cells(shape: tuple[int, int, int]) -> I64:
    """(C, 8) corners of all cells; along an axis with one probe a cell has that one twice."""
    nx, ny, _ = shape
    steps = [np.arange(max(n - 1, 1)) for n in shape]
    low = np.stack(np.meshgrid(*steps, indexing="ij"), axis=-1).reshape(-1, 1, 3)
    at = np.minimum(low + _CORNERS, np.array(shape) - 1)
    return at[..., 0] + nx * (at[..., 1] + ny * at[..., 2])


def _in_grid(grid: ProbeGrid, points: F64) -> tuple[I64, F64]:
    shape = np.array(grid.shape)
    at = np.clip((points - grid.origin) / grid.spacing, 0.0, shape - 1.0)
    low = np.minimum(np.floor(at).astype(np.int64), np.maximum(shape - 2, 0))
    corner = np.minimum(low[:, None] + _CORNERS, shape - 1)
    index = corner[..., 0] + shape[0] * (corner[..., 1] + shape[1] * corner[..., 2])
    return index, _trilinear(at - low)


def _in_octree(probes: ProbeSet, tree: ProbeOctree, points: F64) -> tuple[I64, F64]:
    index, weight = np.full((len(points), N_AROUND), NOBODY), np.zeros((len(points), N_AROUND))
    unfound = np.ones(len(points), np.bool_)
    for level in np.unique(tree.cells[:, 3]):
        rows = np.flatnonzero(tree.cells[:, 3] == level)
        keys = _key(tree.cells[rows, :3])
        order = np.argsort(keys)
        at = (points[unfound] - tree.origin) / (tree.size_m * 0.5 ** float(level))
        cell = np.floor(at).astype(np.int64)
        wanted = np.where((cell >= 0).all(axis=1), _key(cell), -1)
        place = np.minimum(np.searchsorted(keys[order], wanted), len(rows) - 1)
        leaf = rows[order[place]]
        here = keys[order[place]] == wanted
        found = np.flatnonzero(unfound)[here]
        corners = tree.corners[leaf[here]].astype(np.int64)
        index[found] = np.where(corners == NO_PROBE, NOBODY, corners)
        weight[found] = _trilinear((at - cell)[here])
        unfound[found] = False
    if unfound.any():
        index[unfound], weight[unfound] = _nearest(probes, points[unfound])
    return index, np.where(index >= 0, weight, 0.0)


def _key(cells: NDArray) -> I64:
    c = cells.astype(np.int64)
    return (c[..., 0] << 40) | (c[..., 1] << 20) | c[..., 2]


def _trilinear(share: F64) -> F64:
    """(Q, 8) weights of a cell's corners for places (Q, 3) in it."""
    return np.where(_CORNERS, share[:, None], 1.0 - share[:, None]).prod(axis=-1)


def _nearest(probes: ProbeSet, points: F64) -> tuple[I64, F64]:
    """Eight nearest by Franke and Little's weights, which reach 0 where the ninth would come in."""
    from scipy.spatial import KDTree

    n = min(N_AROUND + 1, len(probes))
    distance, index = KDTree(probes.positions).query(points, k=n)
    distance, index = distance.reshape(len(points), n), index.reshape(len(points), n).astype(np.int64)
    radius = distance[:, -1:] * (1.0 if n > N_AROUND else 1.1) + 1e-9
    weight = (np.maximum(radius - distance, 0.0) / (radius * np.maximum(distance, 1e-6 * radius))) ** 2
    missing = N_AROUND - min(n, N_AROUND)
    index = np.pad(index[:, :N_AROUND], ((0, 0), (0, missing)), constant_values=NOBODY)
    weight = np.pad(weight[:, :N_AROUND], ((0, 0), (0, missing)))
    return index, weight / np.maximum(weight.sum(axis=1, keepdims=True), 1e-30)
