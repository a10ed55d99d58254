"""The traced mesh: Embree or OptiX holds bare triangles, everything else is in our own tables.

Triangles that coincide exactly are traced once. Which of them is hit is then our decision, not the
tracer's, whose choice varies from run to run: the front-facing one with the lowest number.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from irradia.scene.merge import MergedMesh
from irradia.transport.backend import dr, mi

NONE = 0xFFFFFFFF
_RELATIVE_EPSILON = 1e-5


@dataclass
class Hit:
    """What a ray met.

    Attributes:
        valid: Whether it met anything.
        t: Distance along the unit direction.
        triangle: Of the merged mesh, already the right one among coincident ones.
        bary: Weights of its second and third vertex.
    """

    valid: mi.Bool
    t: mi.Float
    triangle: mi.UInt32
    bary: mi.Point2f


@dataclass
class SurfacePoint:
    """A point on a triangle.

    Attributes:
        position: On the triangle.
        origin: Where rays start: lifted towards the smooth surface that the vertex normals
            describe (Hanika 2021, "Hacking the Shadow Terminator"), so that low-poly meshes
            don't shade themselves, and off the plane by a rounding margin.
        ng: Geometric normal of the front, unit.
        ns: Interpolated vertex normal, unit, on the front's side.
    """

    position: mi.Point3f
    origin: mi.Point3f
    ng: mi.Vector3f
    ns: mi.Vector3f


class Geometry:
    """A merged mesh ready to be traced."""

    def __init__(self, mesh: MergedMesh, *, robust: bool = True) -> None:
        unique, front, back = _merge_coincident(mesh)
        self._twins = len(unique) < len(mesh.indices)
        self._front = mi.UInt32(front) if self._twins else mi.UInt32()
        self._back = mi.UInt32(back) if self._twins else mi.UInt32()
        self._scene = _trace_scene(mesh, unique, robust)

        table = np.concatenate([mesh.indices, mesh.material[:, None]], axis=1)
        self._triangles = mi.UInt32(np.ascontiguousarray(table, np.uint32).ravel())
        vertices = np.zeros((len(mesh.positions), 8), np.float32)
        vertices[:, :3], vertices[:, 3:6], vertices[:, 6:8] = (
            mesh.positions,
            mesh.normals,
            mesh.texcoords[:, 0],
        )
        self._vertices = mi.Float(vertices.ravel())
        self._has_second_uv = bool(mesh.texcoords[:, 1].any())
        self._has_colours = not np.all(mesh.colors == 1.0)
        self._second_uv = mi.Float(
            mesh.texcoords[:, 1].ravel() if self._has_second_uv else np.zeros(2, np.float32)
        )
        self._colours = mi.Float(mesh.colors.ravel() if self._has_colours else np.ones(4, np.float32))
        low, high = mesh.positions.min(0), mesh.positions.max(0)
        self.centre = ((low + high) / 2).astype(float)
        self.radius = max(float(np.linalg.norm(high - low)) / 2, 1e-6)

    def intersect(self, origin: mi.Point3f, direction: mi.Vector3f, active: mi.Bool) -> Hit:
        """The nearest triangle."""
        ray = mi.Ray3f(origin, direction)
        pi = self._scene.ray_intersect_preliminary(ray, False, active)
        hit = Hit(pi.is_valid() & active, pi.t, pi.prim_index, mi.Point2f(pi.prim_uv))
        return self._pick_twin(hit, direction) if self._twins else hit

    def occluded(
        self, origin: mi.Point3f, direction: mi.Vector3f, distance: mi.Float, active: mi.Bool
    ) -> mi.Bool:
        """Whether anything at all lies nearer than ``distance``."""
        ray = mi.Ray3f(origin, direction, distance, 0.0, [])
        return self._scene.ray_test(ray, False, active)

    def _pick_twin(self, hit: Hit, direction: mi.Vector3f) -> Hit:
        """Chooses among coincident triangles; a back twin's barycentrics are mirrored."""
        front = dr.gather(mi.UInt32, self._front, hit.triangle, hit.valid)
        back = dr.gather(mi.UInt32, self._back, hit.triangle, hit.valid)
        from_front = dr.dot(self.normal(front, hit.valid), direction) < 0.0
        mirrored = hit.valid & ~from_front & (back != NONE)
        triangle = dr.select(mirrored, back, front)
        bary = dr.select(mirrored, mi.Point2f(hit.bary.y, hit.bary.x), hit.bary)
        return Hit(hit.valid, hit.t, triangle, bary)

    def vertices(self, triangle: mi.UInt32, active: mi.Bool) -> mi.Vector4u:
        """Three vertex numbers and the material."""
        return dr.gather(mi.Vector4u, self._triangles, triangle, active)

    def normal(self, triangle: mi.UInt32, active: mi.Bool) -> mi.Vector3f:
        """Geometric normal of the front, unit."""
        index = self.vertices(triangle, active)
        a, b, c = (self._vertex(i, active)[0] for i in (index.x, index.y, index.z))
        return dr.normalize(dr.cross(mi.Vector3f(b - a), mi.Vector3f(c - a)))

    def _vertex(self, index: mi.UInt32, active: mi.Bool) -> tuple[mi.Point3f, mi.Vector3f, mi.Point2f]:
        """Position, normal and first texture coordinate."""
        p = dr.gather(mi.Vector4f, self._vertices, 2 * index, active)
        q = dr.gather(mi.Vector4f, self._vertices, 2 * index + 1, active)
        return mi.Point3f(p.x, p.y, p.z), mi.Vector3f(p.w, q.x, q.y), mi.Point2f(q.z, q.w)

    def point(
        self, triangle: mi.UInt32, bary: mi.Point2f, active: mi.Bool, *, back: mi.Bool | None = None
    ) -> SurfacePoint:
        """The surface there; on ``back`` lanes both normals are turned over."""
        index = self.vertices(triangle, active)
        corners = [self._vertex(i, active) for i in (index.x, index.y, index.z)]
        (a, na, _), (b, nb, _), (c, nc, _) = corners
        wb, wc = bary.x, bary.y
        wa = 1.0 - wb - wc
        position = a + (b - a) * wb + (c - a) * wc
        ng = dr.normalize(dr.cross(mi.Vector3f(b - a), mi.Vector3f(c - a)))
        if back is not None:
            sign = dr.select(back, mi.Float(-1.0), 1.0)
            ng, na, nb, nc = ng * sign, na * sign, nb * sign, nc * sign
        ns = dr.normalize(na * wa + nb * wb + nc * wc)
        ns = dr.select(dr.dot(ns, ng) > 0.0, ns, ng)

        lift = mi.Vector3f(0.0)
        for corner, normal, weight in ((a, na, wa), (b, nb, wb), (c, nc, wc)):
            lift -= normal * (weight * dr.minimum(dr.dot(mi.Vector3f(position - corner), normal), 0.0))
        reach = dr.maximum(dr.max(dr.abs(a)), dr.maximum(dr.max(dr.abs(b)), dr.max(dr.abs(c))))
        margin = self._margin(reach)
        return SurfacePoint(position, position + lift + ng * margin, ng, ns)

    def texcoords(
        self, triangle: mi.UInt32, bary: mi.Point2f, active: mi.Bool
    ) -> tuple[mi.Point2f, mi.Point2f, mi.Vector4f]:
        """Both texture coordinate sets and the vertex colour."""
        index = self.vertices(triangle, active)
        corners, weights = (index.x, index.y, index.z), (1.0 - bary.x - bary.y, bary.x, bary.y)
        uv0, uv1, colour = mi.Point2f(0.0), mi.Point2f(0.0), mi.Vector4f(0.0)
        for i, w in zip(corners, weights, strict=True):
            uv0 += self._vertex(i, active)[2] * w
            if self._has_second_uv:
                uv1 += dr.gather(mi.Point2f, self._second_uv, i, active) * w
            if self._has_colours:
                colour += dr.gather(mi.Vector4f, self._colours, i, active) * w
        return uv0, uv1, colour if self._has_colours else mi.Vector4f(1.0)

    def step_past(self, origin: mi.Point3f, direction: mi.Vector3f, t: mi.Float) -> mi.Point3f:
        """A point just behind the surface at ``t``, for rays that are let through."""
        there = origin + direction * t
        return there + direction * self._margin(dr.max(dr.abs(there)) + t)

    def _margin(self, magnitude: mi.Float) -> mi.Float:
        """How far from a surface rays start: above the rounding of coordinates this large."""
        return (magnitude + 0.1 * self.radius) * _RELATIVE_EPSILON


def _merge_coincident(mesh: MergedMesh) -> tuple[NDArray[np.uint32], NDArray[np.uint32], NDArray[np.uint32]]:
    """Finds triangles with the same three corners.

    Returns:
        The triangles to trace (the lowest of each group, ascending), and for each the lowest
        triangle with that winding and the lowest with the opposite one, or NONE. Triangles start
        at their smallest corner (see ``merge``), so windings compare vertex by vertex.
    """
    corners = mesh.positions[mesh.indices] + np.float32(0.0)  # −0 and 0 are one place
    words = np.ascontiguousarray(corners).view(np.uint32).reshape(-1, 3, 3)
    flipped = words[:, [0, 2, 1]]
    winding = _lexicographic_less(words[:, 1], words[:, 2])
    key = np.where(winding[:, None, None], words, flipped).reshape(-1, 9)
    rows = np.ascontiguousarray(key).view([("", np.uint32)] * 9).ravel()
    _, first, group = np.unique(rows, return_index=True, return_inverse=True)
    n_groups = len(first)
    numbers = np.arange(len(rows), dtype=np.uint32)
    by_winding = np.full((2, n_groups), NONE, np.uint32)
    for side in (0, 1):
        chosen = winding == bool(side)
        np.minimum.at(by_winding[side], group[chosen], numbers[chosen])
    order = np.argsort(first)
    unique = first[order].astype(np.uint32)
    own = winding[unique].astype(int)
    columns = np.arange(n_groups)
    sorted_sides = by_winding[:, order]
    return unique, sorted_sides[own, columns], sorted_sides[1 - own, columns]


def _lexicographic_less(a: NDArray[np.uint32], b: NDArray[np.uint32]) -> NDArray[np.bool_]:
    less, equal = a < b, a == b
    return less[:, 0] | equal[:, 0] & (less[:, 1] | equal[:, 1] & less[:, 2])


def _trace_scene(mesh: MergedMesh, unique: NDArray[np.uint32], robust: bool) -> mi.Scene:
    """Hands bare triangles to the tracer."""
    traced = mi.Mesh(
        "scene", len(mesh.positions), len(unique), has_vertex_normals=False, has_vertex_texcoords=False
    )
    params = mi.traverse(traced)
    params["vertex_positions"] = mi.Float(mesh.positions.ravel())
    params["faces"] = mi.UInt32(mesh.indices[unique].ravel())
    params.update()
    # One thread builds the tree: with two its shape, and so the pick among touching faces, varies.
    threads = dr.thread_count()
    dr.set_thread_count(1)
    try:
        return mi.load_dict({"type": "scene", "mesh": traced, "embree_use_robust_intersections": robust})
    finally:
        dr.set_thread_count(threads)
