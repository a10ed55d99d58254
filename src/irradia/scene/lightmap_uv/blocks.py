"""Large meshes that no projection suits: cut in blocks of space, so that xatlas takes linear time."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from irradia.scene.lightmap_uv.charts import NO_CHART, Charts, collapse_strays
from irradia.scene.lightmap_uv.xatlas_charts import xatlas_charts
from irradia.scene.types import F32, F64, U32

_BLOCK = 16_384  # triangles at most


def block_charts(positions: F64, normals: F32, indices: U32) -> Charts:
    """Charts of each block, with seams between blocks.

    Args:
        positions: (V, 3).
        normals: (V, 3).
        indices: (T, 3).
    """
    parts = []
    for triangles in halved(positions[indices].mean(axis=1), _BLOCK):
        used, compact = np.unique(indices[triangles], return_inverse=True)
        part = xatlas_charts(positions[used], normals[used], compact.reshape(-1, 3).astype(np.uint32))
        parts.append((triangles, used, part))
    return _joined(parts, positions, len(indices))


def halved(points: F64, most: int) -> list[NDArray[np.int64]]:
    """Points in groups of at most ``most``: halved along their longest side until they are small enough."""
    done, waiting = [], [np.arange(len(points))]
    while waiting:
        group = waiting.pop()
        if len(group) <= most:
            done.append(np.sort(group))
            continue
        axis = int(np.ptp(points[group], axis=0).argmax())
        order = group[np.argsort(points[group, axis], kind="stable")]
        waiting += [order[len(order) // 2 :], order[: len(order) // 2]]
    return done


def _joined(
    parts: list[tuple[NDArray[np.int64], NDArray, Charts]], positions: F64, n_triangles: int
) -> Charts:
    """One set of charts; triangles go back to their places."""
    indices = np.zeros((n_triangles, 3), np.uint32)
    vertex_chart = []
    n_vertices = n_charts = 0
    for triangles, _, part in parts:
        indices[triangles] = part.indices + np.uint32(n_vertices)
        vertex_chart.append(
            part.island_of_vertex() + n_charts if part.n_charts else np.full(len(part.uv), NO_CHART)
        )
        n_vertices, n_charts = n_vertices + len(part.uv), n_charts + part.n_charts
    source = np.concatenate([used[part.vertex_source] for _, used, part in parts]).astype(np.uint32)
    uv = np.concatenate([part.uv for _, _, part in parts])
    return collapse_strays(positions, source, indices, uv, np.concatenate(vertex_chart).astype(np.uint32))
