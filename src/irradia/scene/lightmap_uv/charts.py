"""A primitive's charts: its triangles laid flat."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from irradia.scene.types import F32, F64, U32

NO_CHART = np.uint32(0xFFFFFFFF)


@dataclass(frozen=True)
class Charts:
    """A primitive's triangles laid flat, each chart in its own place, none turned over another.

    Attributes:
        vertex_source: (V',) vertex of the primitive that each new vertex copies.
        indices: (T, 3) triangles in the primitive's order.
        uv: (V', 2) in the length unit of the positions they were made from, areas kept.
        chart: (T,) from 0, without gaps.
        solid: (T,) False for triangles too small to unfold: their corners share one uv inside
            ``chart``.
    """

    vertex_source: U32
    indices: U32
    uv: F32
    chart: U32
    solid: NDArray[np.bool_]

    @property
    def n_charts(self) -> int:
        """Number of charts; 0 for a primitive without area."""
        return int(self.chart.max()) + 1 if self.solid.any() else 0

    def island_of_vertex(self) -> NDArray[np.int64]:
        """(V',) chart of each vertex; none belongs to two."""
        island = np.zeros(len(self.uv), np.int64)
        island[self.indices] = self.chart[:, None]
        return island


def triangle_areas(positions: NDArray, indices: U32) -> F64:
    """(T,) areas of triangles (T, 3) over points (V, 2 or 3)."""
    a, b, c = (positions[indices[:, k]].astype(np.float64) for k in range(3))
    first, second = b - a, c - a
    if positions.shape[1] == 2:
        return 0.5 * np.abs(first[:, 0] * second[:, 1] - first[:, 1] * second[:, 0])
    return 0.5 * np.linalg.norm(np.cross(first, second), axis=1)


def collapse_strays(positions: F64, source: U32, indices: U32, uv: F32, vertex_chart: U32) -> Charts:
    """Gives triangles that are in no chart, or flat in it, the uv of the nearest vertex of a chart.

    Args:
        positions: (V, 3) of the mesh.
        source: (V',) vertex of the mesh that each new vertex copies.
        indices: (T, 3) into the new vertices.
        uv: (V', 2).
        vertex_chart: (V',) chart of each new vertex, or NO_CHART.
    """
    from scipy.spatial import KDTree

    chart = vertex_chart[indices[:, 0]]
    solid = (chart != NO_CHART) & (triangle_areas(uv, indices) > 0)
    if not solid.any():
        return without_area(source[indices])
    stray = np.flatnonzero(~solid)
    if len(stray):
        anchors = np.unique(indices[solid])
        centres = positions[source[indices[stray]]].mean(axis=1)
        _, nearest = KDTree(positions[source[anchors]]).query(centres)
        nearest = anchors[nearest]
        chart = chart.copy()
        chart[stray] = vertex_chart[nearest]
        indices = indices.copy()
        new = len(source) + np.arange(3 * len(stray), dtype=np.uint32)
        source = np.concatenate([source, source[indices[stray]].reshape(-1)])
        uv = np.concatenate([uv, np.repeat(uv[nearest], 3, axis=0)])
        indices[stray] = new.reshape(-1, 3)
    _, dense = np.unique(chart, return_inverse=True)
    return _drop_unused(source, indices, uv, dense.astype(np.uint32), solid)


def _drop_unused(source: U32, indices: U32, uv: F32, chart: U32, solid: NDArray[np.bool_]) -> Charts:
    used, renumbered = np.unique(indices, return_inverse=True)
    return Charts(
        vertex_source=source[used].astype(np.uint32),
        indices=renumbered.reshape(-1, 3).astype(np.uint32),
        uv=np.ascontiguousarray(uv[used], np.float32),
        chart=chart,
        solid=solid,
    )


def without_area(indices: U32) -> Charts:
    """A primitive of which nothing unfolds: all corners at one uv."""
    used, renumbered = np.unique(indices, return_inverse=True)
    return Charts(
        vertex_source=used.astype(np.uint32),
        indices=renumbered.reshape(-1, 3).astype(np.uint32),
        uv=np.zeros((len(used), 2), np.float32),
        chart=np.zeros(len(indices), np.uint32),
        solid=np.zeros(len(indices), np.bool_),
    )
