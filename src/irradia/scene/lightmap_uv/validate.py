"""Whether the file's second uv set serves as a lightmap's."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from irradia.scene.lightmap_uv.charts import Charts, triangle_areas
from irradia.scene.types import F32, U32, Primitive

_SLACK = 1e-4  # exporters overshoot the unit square by rounding
_MAX_FLAT_SHARE = 1e-3  # of the surface may have no area on the page
MAX_OVERLAP_SHARE = 1e-3  # of the covered points may lie under two triangles
_MIN_GRID, _MAX_GRID = 512, 4096


def file_charts(primitive: Primitive) -> tuple[Charts | None, str | None]:
    """The file's TEXCOORD_1 as charts, or None and what is wrong with it; None twice if there is none."""
    if len(primitive.texcoords) < 2:
        return None, None
    uv = primitive.texcoords[1]
    reason = _defect(primitive, uv)
    if reason:
        return None, reason
    areas = triangle_areas(uv, primitive.indices)
    return Charts(
        vertex_source=np.arange(len(uv), dtype=np.uint32),
        indices=np.ascontiguousarray(primitive.indices, np.uint32),
        uv=np.ascontiguousarray(uv, np.float32),
        chart=_connected(uv, primitive.indices),
        solid=areas > 0,
    ), None


def _defect(primitive: Primitive, uv: F32) -> str | None:
    """What makes the set useless for a lightmap, in words that follow its name."""
    used = uv[np.unique(primitive.indices)]
    if not np.isfinite(used).all():
        return "holds numbers that are not finite"
    if used.min() < -_SLACK or used.max() > 1 + _SLACK:
        return "leaves the unit square"
    flat = triangle_areas(uv, primitive.indices) <= 1e-14
    world = triangle_areas(primitive.positions, primitive.indices)
    if flat.all() or world[flat].sum() > _MAX_FLAT_SHARE * world.sum():
        return "folds triangles to nothing"
    if overlap_share(uv, primitive.indices) > MAX_OVERLAP_SHARE:
        return "overlaps itself"
    return None


def overlap_share(uv: F32, indices: U32) -> float:
    """Share of the covered points of a grid that more than one triangle covers.

    The grid is fine enough to put some points into the average triangle.
    """
    from irradia.scene.lightmap_uv.overlap import count_layers

    low, high = uv[indices].min(axis=(0, 1)), uv[indices].max(axis=(0, 1))
    grid = int(np.clip(4 * np.sqrt(len(indices)), _MIN_GRID, _MAX_GRID))
    spread = max(float((high - low).max()), 1e-9)
    covered, doubled = count_layers(((uv - low) / spread).astype(np.float64), indices.astype(np.int64), grid)
    return doubled / covered if covered else 1.0


def _connected(uv: F32, indices: U32) -> NDArray[np.uint32]:
    """(T,) number of the chart of each triangle: triangles that share a uv point are one chart."""
    from scipy.sparse import coo_matrix
    from scipy.sparse.csgraph import connected_components

    _, point = np.unique(uv, axis=0, return_inverse=True)
    corners = point.reshape(-1)[indices]
    n = int(corners.max()) + 1
    links = np.concatenate([corners[:, [0, 1]], corners[:, [0, 2]]])
    graph = coo_matrix((np.ones(len(links), np.int8), (links[:, 0], links[:, 1])), shape=(n, n))
    _, component = connected_components(graph, directed=False)
    _, chart = np.unique(component[corners[:, 0]], return_inverse=True)
    return chart.astype(np.uint32)
