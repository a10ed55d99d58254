"""The scene as one triangle mesh in world space, instances flattened: what transport traces."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from irradia.scene.layout import LightmapLayout
from irradia.scene.types import F32, U32, Scene

LEVEL_BITS = 8
"""How much of :attr:`MergedMesh.lod` the level takes; the object's number stands above."""

CAMERA_LOD = 0xFFFFFF << LEVEL_BITS | 1
"""What a camera's rays carry: they see the finest levels, and what :func:`seen_by_camera` adds."""


@dataclass(frozen=True)
class MergedMesh:
    """Vertices and triangles of every instance, in instance order.

    Attributes:
        positions, normals: (V, 3) world space; normals unit, interpolated across the face.
        texcoords: (V, 2, 2): the vertex, the set (0 or 1), u and v.
        colors: (V, 4) linear, ones where the file has none.
        lightmap_uv: (V, 2) page uv in [0, 1], origin top left; 0 where there is none.
        indices: (T, 3); wound so that the geometric normal is the front's, also under mirroring,
            and starting at the corner of smallest position, so that coincident triangles compare.
        material, instance: (T,) what each triangle belongs to.
        page: (T,) lightmap page, or −1.
        chart: (T,) chart number, unique over the whole layout, or 0xFFFFFFFF.
        casts: (T,) whether rays meet the triangle; None where they meet all.
        lod: (T,) the object, from 1, shifted by LEVEL_BITS, and its level of detail; 0 where the
            triangle belongs to no such object. None where there is none at all.
    """

    positions: F32
    normals: F32
    texcoords: F32
    colors: F32
    lightmap_uv: F32
    indices: U32
    material: U32
    instance: U32
    page: NDArray[np.int32]
    chart: U32
    casts: NDArray[np.bool_] | None = None
    lod: U32 | None = None


def merge(scene: Scene, layout: LightmapLayout | None = None) -> MergedMesh:
    """Flattens instances; vertex splits of the unwrap are applied where there is a layout."""
    parts = [_place(scene, layout, index) for index in range(len(scene.instances))]
    first_vertex = np.cumsum([0, *(len(p.positions) for p in parts)])
    first_chart = np.cumsum([0, *(_chart_count(p) for p in parts)])
    positions = _join([p.positions for p in parts], (0, 3), np.float32)
    indices = [p.indices + np.uint32(f) for p, f in zip(parts, first_vertex, strict=False)]
    charts = [
        np.where(p.page >= 0, p.chart + np.uint32(f), np.uint32(0xFFFFFFFF))
        for p, f in zip(parts, first_chart, strict=False)
    ]
    instance = _join([p.instance for p in parts], (0,), np.uint32)
    return MergedMesh(
        positions=positions,
        normals=_join([p.normals for p in parts], (0, 3), np.float32),
        texcoords=_join([p.texcoords for p in parts], (0, 2, 2), np.float32),
        colors=_join([p.colors for p in parts], (0, 4), np.float32),
        lightmap_uv=_join([p.lightmap_uv for p in parts], (0, 2), np.float32),
        indices=_start_at_smallest_corner(positions, _join(indices, (0, 3), np.uint32)),
        material=_join([p.material for p in parts], (0,), np.uint32),
        instance=instance,
        page=_join([p.page for p in parts], (0,), np.int32),
        chart=_join(charts, (0,), np.uint32),
        casts=_casts(scene, instance),
        lod=_lod(scene, instance),
    )


def seen_by_camera(mesh: MergedMesh) -> MergedMesh:
    """The mesh as pictures need it: objects that don't cast are met too, but by a camera's rays alone."""
    if mesh.casts is None:
        return mesh
    lod = np.uint32(0) if mesh.lod is None else mesh.lod
    return replace(mesh, casts=None, lod=np.where(mesh.casts, lod, np.uint32(CAMERA_LOD)))


def _casts(scene: Scene, instance: U32) -> NDArray[np.bool_] | None:
    casts = np.array([i.casts for i in scene.instances], np.bool_)
    return None if casts.all() else casts[instance]


def _lod(scene: Scene, instance: U32) -> U32 | None:
    """See :attr:`MergedMesh.lod`; objects of a single level are as all others."""
    if not any(i.lod_level for i in scene.instances):
        return None
    packed = [
        0 if i.lod_group is None else (i.lod_group + 1) << LEVEL_BITS | i.lod_level for i in scene.instances
    ]
    return np.array(packed, np.uint32)[instance]


def _chart_count(part: MergedMesh) -> int:
    return int(part.chart.max()) + 1 if len(part.chart) and part.page[0] >= 0 else 0


def _join(parts: list, empty_shape: tuple[int, ...], dtype: type) -> NDArray:
    return np.concatenate(parts).astype(dtype, copy=False) if parts else np.zeros(empty_shape, dtype)


def _place(scene: Scene, layout: LightmapLayout | None, index: int) -> MergedMesh:
    """One instance in world space."""
    instance = scene.instances[index]
    primitive = scene.primitives[instance.primitive]
    unwrap = layout.unwraps[instance.primitive] if layout and layout.page[index] >= 0 else None
    source = unwrap.vertex_source if unwrap else np.arange(len(primitive.positions))
    indices = unwrap.indices if unwrap else primitive.indices

    linear = instance.world_from_object[:3, :3]
    positions = primitive.positions[source] @ linear.T + instance.world_from_object[:3, 3]
    normals = primitive.normals[source] @ _normal_transform(linear).T
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-20)
    if np.linalg.det(linear) < 0:
        indices = indices[:, ::-1]

    n_vertices, n_triangles = len(source), len(indices)
    texcoords = np.zeros((n_vertices, 2, 2), np.float32)
    for set_index, uv in enumerate(primitive.texcoords[:2]):
        texcoords[:, set_index] = uv[source]
    lightmap_uv = np.zeros((n_vertices, 2), np.float32)
    if unwrap and layout:
        lightmap_uv = unwrap.uv * layout.scale[index] + layout.offset[index]
    return MergedMesh(
        positions=positions.astype(np.float32),
        normals=normals.astype(np.float32),
        texcoords=texcoords,
        colors=np.ones((n_vertices, 4), np.float32) if primitive.colors is None else primitive.colors[source],
        lightmap_uv=lightmap_uv.astype(np.float32),
        indices=np.ascontiguousarray(indices, np.uint32),
        material=np.full(n_triangles, primitive.material, np.uint32),
        instance=np.full(n_triangles, index, np.uint32),
        page=np.full(n_triangles, layout.page[index] if unwrap and layout else -1, np.int32),
        chart=unwrap.chart if unwrap else np.zeros(n_triangles, np.uint32),
    )


def _normal_transform(linear: NDArray[np.float64]) -> NDArray[np.float64]:
    """Cofactor matrix: the inverse transpose times the determinant, finite for flat scales too."""
    a, b, c = linear
    cofactor = np.stack([np.cross(b, c), np.cross(c, a), np.cross(a, b)])
    return cofactor * (1.0 if np.linalg.det(linear) >= 0 else -1.0)


def _start_at_smallest_corner(positions: F32, indices: U32) -> U32:
    """Rotates each triangle, keeping its winding."""
    corners = positions[indices].astype(np.float64)
    smallest = np.zeros(len(indices), np.intp)
    for candidate in (1, 2):
        a = corners[:, candidate]
        b = corners[np.arange(len(indices)), smallest]
        less = a < b
        first = less[:, 0]
        second = (a[:, 0] == b[:, 0]) & less[:, 1]
        third = (a[:, 0] == b[:, 0]) & (a[:, 1] == b[:, 1]) & less[:, 2]
        smallest = np.where(first | second | third, candidate, smallest)
    order = (smallest[:, None] + np.arange(3)) % 3
    return np.take_along_axis(indices, order, axis=1)
