"""The merged mesh on the device: what rays meet, and the surface at a point of it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from irradia.scene.merge import MergedMesh
from irradia.transport.backend import dr, mi
from irradia.transport.traced import Hit, TracedTriangles

__all__ = ["Geometry", "Hit", "SurfacePoint"]

_RELATIVE_EPSILON = 1e-5


@dataclass
class Sides:
    """What light of either side counts, against the reflectance that its sum is multiplied by.

    Attributes:
        front, behind: R and T over the surface's reflectance; 1 and 0 on an opaque one.
        origin_behind: Where rays start on the back.
        p_behind: How often the back is picked.
    """

    front: mi.Color3f
    behind: mi.Color3f
    origin_behind: mi.Point3f
    p_behind: mi.Float


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
        lod: Level of detail that it belongs to, for rays from it; None where nothing has any.
        sides: How much light from behind counts; None where no surface of the scene lets any through.
    """

    position: mi.Point3f
    origin: mi.Point3f
    ng: mi.Vector3f
    ns: mi.Vector3f
    lod: mi.UInt32 | None = None
    sides: Sides | None = None


class Geometry:
    """A merged mesh ready to be traced.

    Attributes:
        has_lods: Whether any object has levels of detail, which don't see each other.
        centre, radius: Of a sphere around all of it.
    """

    def __init__(self, mesh: MergedMesh, *, robust: bool = True) -> None:
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
        self._traced = TracedTriangles(mesh, self.normal, self.step_past, robust=robust)
        self.has_lods = self._traced.has_lods

    def intersect(
        self, origin: mi.Point3f, direction: mi.Vector3f, active: mi.Bool, lod: mi.UInt32 | None = None
    ) -> Hit:
        """The nearest triangle; ``lod`` is that of the surface where the ray starts, if any."""
        return self._traced.nearest(origin, direction, active, lod)

    def occluded(
        self,
        origin: mi.Point3f,
        direction: mi.Vector3f,
        distance: mi.Float,
        active: mi.Bool,
        lod: mi.UInt32 | None = None,
    ) -> mi.Bool:
        """Whether anything at all lies nearer than ``distance``."""
        return self._traced.occluded(origin, direction, distance, active, lod)

    def seen(self, triangle: mi.UInt32, lod: mi.UInt32, active: mi.Bool) -> mi.Bool:
        """See :meth:`TracedTriangles.seen`; only in scenes with levels of detail."""
        return self._traced.seen(triangle, lod, active)

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
        lod = self._traced.lod(triangle, active)
        return SurfacePoint(position, position + lift + ng * margin, ng, ns, lod)

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

    def uv_areas(self, triangle: mi.UInt32, active: mi.Bool) -> tuple[mi.Float, mi.Float]:
        """The triangle's area in either texture coordinate set."""
        index = self.vertices(triangle, active)
        first = [self._vertex(i, active)[2] for i in (index.x, index.y, index.z)]
        if not self._has_second_uv:
            return _area(*first), mi.Float(0.0)
        second = [dr.gather(mi.Point2f, self._second_uv, i, active) for i in (index.x, index.y, index.z)]
        return _area(*first), _area(*second)

    def step_past(self, origin: mi.Point3f, direction: mi.Vector3f, t: mi.Float) -> mi.Point3f:
        """A point just behind the surface at ``t``, for rays that are let through."""
        there = origin + direction * t
        return there + direction * self._margin(dr.max(dr.abs(there)) + t)

    def _margin(self, magnitude: mi.Float) -> mi.Float:
        """How far from a surface rays start: above the rounding of coordinates this large."""
        return (magnitude + 0.1 * self.radius) * _RELATIVE_EPSILON


def _area(a: mi.Point2f, b: mi.Point2f, c: mi.Point2f) -> mi.Float:
    first, second = b - a, c - a
    return 0.5 * dr.abs(first.x * second.y - first.y * second.x)
