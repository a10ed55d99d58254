"""Cuts a primitive into charts that lie flat: xatlas, with its answers kept by content."""

from __future__ import annotations

import hashlib
import zipfile
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from irradia.core.cache import cache_dir
from irradia.core.files import write_atomic
from irradia.scene.lightmap_uv.atlas import new_atlas
from irradia.scene.types import F32, F64, U32, Primitive

# xatlas packs what it cut on a page of about this edge. It rounds a chart's extent to whole texels of
# that page, so a coarse one would stretch small charts.
_PAGE_PX = 2048
_MAX_COST = 16.0  # xatlas stops growing a chart here; its own 2 gives a quarter more charts
_NO_CHART = np.uint32(0xFFFFFFFF)
_CACHED_FROM = 500  # triangles; smaller primitives unwrap faster than a file opens
_CACHE_VERSION = "unwrap-1"


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


def unwrap(primitive: Primitive, linear: F64, *, use_cache: bool = True) -> Charts:
    """Charts of a primitive as it stands in the world.

    Args:
        primitive: Triangles in object space.
        linear: (3, 3) world from object without the translation; uneven scales are unfolded as they are.
        use_cache: Whether to look in, and add to, the user's cache.
    """
    positions = np.ascontiguousarray(primitive.positions.astype(np.float64) @ linear.T)
    normals = np.ascontiguousarray(primitive.normals @ _cofactor(linear).T, np.float32)
    keep = use_cache and len(primitive.indices) >= _CACHED_FROM
    path = _cache_path(positions, normals, primitive.indices) if keep else None
    charts = _read(path) if path else None
    if charts is None:
        charts = _cut(positions, normals, primitive.indices)
        if path:
            _write(path, charts)
    return charts


def triangle_areas(positions: NDArray, indices: U32) -> F64:
    """(T,) areas of triangles (T, 3) over points (V, 2 or 3)."""
    a, b, c = (positions[indices[:, k]].astype(np.float64) for k in range(3))
    first, second = b - a, c - a
    if positions.shape[1] == 2:
        return 0.5 * np.abs(first[:, 0] * second[:, 1] - first[:, 1] * second[:, 0])
    return 0.5 * np.linalg.norm(np.cross(first, second), axis=1)


def _cut(positions: F64, normals: F32, indices: U32) -> Charts:
    """Runs xatlas on a mesh scaled so that its smallest numbers stay clear of xatlas's epsilons."""
    import xatlas

    areas = triangle_areas(positions, indices)
    mean = float(areas.mean()) if len(areas) else 0.0
    if mean <= 0.0:
        return _without_area(indices)
    to_unit = 1.0 / np.sqrt(mean)
    centred = positions - 0.5 * (positions.min(axis=0) + positions.max(axis=0))

    options = xatlas.ChartOptions()
    options.max_cost = _MAX_COST
    packing = xatlas.PackOptions()
    packing.texels_per_unit = _PAGE_PX / np.sqrt(1.4 * len(indices))
    packing.rotate_charts = False
    points = np.ascontiguousarray(centred * to_unit, np.float32)
    triangles = np.ascontiguousarray(indices, np.uint32)
    with new_atlas() as atlas:
        atlas.add_mesh(points, triangles, normals)
        atlas.generate(options, packing)
        source, new_indices, uv = atlas.get_mesh(0)
        _, vertex_chart = atlas.get_mesh_vertex_assignment(0)
        if atlas.chart_count == 0:
            return _without_area(indices)
        unit_uv = uv * np.array([atlas.width, atlas.height]) / packing.texels_per_unit
    return _collapse_strays(
        positions, source, new_indices, (unit_uv / to_unit).astype(np.float32), vertex_chart
    )


def _collapse_strays(positions: F64, source: U32, indices: U32, uv: F32, vertex_chart: U32) -> Charts:
    """Gives triangles that xatlas left out, or made flat, the uv of the nearest vertex of a chart."""
    from scipy.spatial import KDTree

    chart = vertex_chart[indices[:, 0]]
    solid = (chart != _NO_CHART) & (triangle_areas(uv, indices) > 0)
    if not solid.any():
        return _without_area(source[indices])
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


def _without_area(indices: U32) -> Charts:
    """A primitive of which nothing unfolds: all corners at one uv."""
    used, renumbered = np.unique(indices, return_inverse=True)
    return Charts(
        vertex_source=used.astype(np.uint32),
        indices=renumbered.reshape(-1, 3).astype(np.uint32),
        uv=np.zeros((len(used), 2), np.float32),
        chart=np.zeros(len(indices), np.uint32),
        solid=np.zeros(len(indices), np.bool_),
    )


def _cofactor(linear: F64) -> F64:
    """Takes normals along; finite where the inverse transpose is not."""
    a, b, c = linear
    return np.stack([np.cross(b, c), np.cross(c, a), np.cross(a, b)])


def _cache_path(positions: F64, normals: F32, indices: U32) -> Path:
    import xatlas

    digest = hashlib.sha256(f"{_CACHE_VERSION} {xatlas.__version__} {_PAGE_PX} {_MAX_COST}".encode())
    for array in (positions, normals, indices):
        digest.update(f"{array.shape} {array.dtype}".encode())
        digest.update(np.ascontiguousarray(array).tobytes())
    return cache_dir() / "unwrap" / f"{digest.hexdigest()[:32]}.npz"


def _read(path: Path) -> Charts | None:
    """What the cache holds, or None where it holds nothing or something broken."""
    try:
        with path.open("rb") as stream, np.load(stream, allow_pickle=False) as stored:
            return Charts(**{name: stored[name] for name in Charts.__dataclass_fields__})
    except (OSError, KeyError, ValueError, EOFError, zipfile.BadZipFile):
        return None


def _write(path: Path, charts: Charts) -> None:
    """Adds to the cache; a folder that can't be written to only costs the next run's time."""
    try:
        with write_atomic(path) as stream:
            np.savez(stream, **{name: getattr(charts, name) for name in Charts.__dataclass_fields__})
    except OSError:
        return
