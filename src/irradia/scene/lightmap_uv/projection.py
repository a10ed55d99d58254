"""Charts of large meshes by projection: every surface laid flat along the axis that it faces.

A terrain faces up wherever it isn't steeper than 60°, so it is one chart, without a seam, in a
second, where xatlas takes many minutes. What is steeper, or turned over, goes to charts along other
axes. No length shrinks to less than ``MIN_COSINE``, and no chart lies over itself.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from irradia.scene.lightmap_uv.charts import Charts, collapse_strays, triangle_areas
from irradia.scene.types import F32, F64, U32

MIN_COSINE = 0.5  # of a triangle's normal with its axis: lengths shrink to half at most
_LOOSE_COSINE = 0.3  # the same for what would be a crumb of a chart
_CRUMB = 16  # triangles
_SMOOTHING_ROUNDS = 6
_TRIANGLES_PER_CHART = 400  # with fewer on average the surface is too rough for this
_FACES_ONE_WAY = 0.3  # share of the area that is left when all normals are added up

AXES = np.array([[0, 1, 0], [0, -1, 0], [1, 0, 0], [-1, 0, 0], [0, 0, 1], [0, 0, -1]], np.float64)
# u and v of each axis, so that u × v is the axis and nothing is mirrored.
_U = np.array([[0, 0, 1], [1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 0, 0], [0, 1, 0]], np.float64)
_V = np.array([[1, 0, 0], [0, 0, 1], [0, 0, 1], [0, 1, 0], [0, 1, 0], [1, 0, 0]], np.float64)
Links = tuple[NDArray[np.int64], NDArray[np.int64]]  # pairs of triangles that share an edge


def projected_charts(positions: F64, indices: U32) -> Charts | None:
    """Charts by projection along the coordinate axes, or None where too many would be needed.

    Args:
        positions: (V, 3).
        indices: (T, 3).
    """
    corners = positions[indices]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    doubled_areas = np.linalg.norm(normals, axis=1)
    facing = (normals / np.maximum(doubled_areas, 1e-300)[:, None]) @ AXES.T
    links = _shared_edges(positions, indices)
    axis = _axes(facing, normals.sum(axis=0) / max(float(doubled_areas.sum()), 1e-300))
    axis = _smoothed(axis, facing, links)
    chart = _connected(axis, links)
    axis = _without_crumbs(axis, chart, facing, links)
    flat = _flat(corners, axis)
    chart = _without_overlap(_connected(axis, links), axis, corners, flat, links)
    if chart.max() + 1 > max(len(indices) // _TRIANGLES_PER_CHART, len(AXES)):
        return None
    return _assembled(positions, indices, flat, chart, doubled_areas / 2)


def _shared_edges(positions: F64, indices: U32) -> Links:
    """Pairs of triangles with an edge in one place, split vertices or not."""
    rows = np.ascontiguousarray(positions + 0.0).view([("", np.float64)] * 3).ravel()
    _, point = np.unique(rows, return_inverse=True)
    corner = point.reshape(-1)[indices]
    start, end = corner, np.roll(corner, -1, axis=1)
    key = (np.minimum(start, end) * np.int64(len(positions)) + np.maximum(start, end)).ravel()
    order = np.argsort(key, kind="stable")
    same = np.flatnonzero(key[order[1:]] == key[order[:-1]])
    return order[same] // 3, order[same + 1] // 3


def _axes(facing: F64, mean_facing: F64) -> NDArray[np.int64]:
    """(T,) axis of each triangle: the one that most of the mesh faces where it serves, else the nearest."""
    nearest = facing.argmax(axis=1)
    main = int((AXES @ mean_facing).argmax())
    if AXES[main] @ mean_facing < _FACES_ONE_WAY:
        return nearest
    return np.where(facing[:, main] >= MIN_COSINE, main, nearest)


def _smoothed(axis: NDArray[np.int64], facing: F64, links: Links) -> NDArray[np.int64]:
    """Lets triangles follow the majority of their neighbours where that stretches them little."""
    for _ in range(_SMOOTHING_ROUNDS):
        votes = _votes(axis, links)
        votes[facing < MIN_COSINE] = 0
        wanted = votes.argmax(axis=1)
        follows = (votes.max(axis=1) >= 2) & (wanted != axis)
        if not follows.any():
            break
        axis = np.where(follows, wanted, axis)
    return axis


def _without_crumbs(
    axis: NDArray[np.int64], chart: NDArray[np.int64], facing: F64, links: Links
) -> NDArray[np.int64]:
    """Lets charts of a few triangles join a neighbour, at the cost of some stretch."""
    crumb = (np.bincount(chart) < _CRUMB)[chart]
    votes = _votes(axis, links)
    votes[np.arange(len(axis)), axis] = 0
    votes[facing < _LOOSE_COSINE] = 0
    return np.where(crumb & (votes.max(axis=1) > 0), votes.argmax(axis=1), axis)


def _votes(axis: NDArray[np.int64], links: Links) -> NDArray[np.int64]:
    """(T, axes) how many neighbours each triangle has on each axis."""
    n = len(AXES)
    both = [links[0] * n + axis[links[1]], links[1] * n + axis[links[0]]]
    return np.bincount(np.concatenate(both), minlength=len(axis) * n).reshape(-1, n)


def _connected(label: NDArray[np.int64], links: Links) -> NDArray[np.int64]:
    """(T,) number of the connected patch of one label that each triangle belongs to."""
    from scipy.sparse import coo_matrix
    from scipy.sparse.csgraph import connected_components

    alike = label[links[0]] == label[links[1]]
    ends = links[0][alike], links[1][alike]
    graph = coo_matrix((np.ones(len(ends[0]), np.int8), ends), shape=(len(label), len(label)))
    return connected_components(graph, directed=False)[1].astype(np.int64)


def _flat(corners: F64, axis: NDArray[np.int64]) -> F64:
    """(T, 3, 2) corners seen along their triangles' axes."""
    return np.stack([np.einsum("tkc,tc->tk", corners, side[axis]) for side in (_U, _V)], axis=-1)


def _without_overlap(
    chart: NDArray[np.int64], axis: NDArray[np.int64], corners: F64, flat: F64, links: Links
) -> NDArray[np.int64]:
    """Halves charts that lie over themselves across their depth until none does."""
    from irradia.scene.lightmap_uv.overlap import overlapping_charts

    depth = np.einsum("tkc,tc->t", corners, AXES[axis])
    chart = chart.copy()
    waiting = np.flatnonzero(overlapping_charts(flat, chart)[chart])
    while len(waiting):
        place = np.full(len(chart), -1)
        place[waiting] = np.arange(len(waiting))
        ends = place[links[0]], place[links[1]]
        both = (ends[0] >= 0) & (ends[1] >= 0)
        halves = 2 * chart[waiting] + _upper_halves(chart[waiting], depth[waiting])
        parts = _connected(halves, (ends[0][both], ends[1][both]))
        chart[waiting] = chart.max() + 1 + parts
        waiting = waiting[overlapping_charts(flat[waiting], parts)[parts]]
    return np.unique(chart, return_inverse=True)[1]


def _upper_halves(group: NDArray[np.int64], height: F64) -> NDArray[np.bool_]:
    """(N,) whether a member belongs to the upper half of its group, one of which may be empty."""
    order = np.lexsort((height, group))
    first = np.searchsorted(group[order], group[order])
    size = np.bincount(group)[group[order]]
    upper = np.zeros(len(group), np.bool_)
    upper[order] = np.arange(len(group)) - first >= size - size // 2
    return upper


def _assembled(positions: F64, indices: U32, flat: F64, chart: NDArray[np.int64], areas: F64) -> Charts:
    """One vertex for each vertex and chart, every chart as large as the surface it shows."""
    n = int(chart.max()) + 1
    corner_key = (chart[:, None] * np.int64(len(positions)) + indices).ravel()
    key, first, corner = np.unique(corner_key, return_index=True, return_inverse=True)
    vertex_chart, source = np.divmod(key, len(positions))
    new_indices = corner.reshape(-1, 3).astype(np.uint32)
    uv = flat.reshape(-1, 2)[first]
    shown = np.bincount(chart, triangle_areas(uv, new_indices), n)
    scale = np.sqrt(np.bincount(chart, areas, n) / np.where(shown > 0.0, shown, np.inf))
    low = np.full((n, 2), np.inf)
    np.minimum.at(low, vertex_chart, uv)
    placed: F32 = ((uv - low[vertex_chart]) * scale[vertex_chart, None]).astype(np.float32)
    return collapse_strays(
        positions, source.astype(np.uint32), new_indices, placed, vertex_chart.astype(np.uint32)
    )
