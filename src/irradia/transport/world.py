"""A scene ready for light: geometry, materials, lights and lightmap rectangles, on the device."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from irradia.core import InputError
from irradia.scene.merge import MergedMesh
from irradia.scene.types import Scene
from irradia.transport.backend import dr, mi
from irradia.transport.geometry import Geometry, Sides, SurfacePoint
from irradia.transport.light_setup import make_lights
from irradia.transport.materials import (
    DOUBLE_SIDED,
    EMISSIVE,
    FILTERS,
    TRANSLUCENT,
    UNLIT,
    Appearance,
    MaterialTable,
)
from irradia.transport.textures import TextureTable

HAS_TEXEL = 16  # beside the material flags: the triangle lies in the lightmap


@dataclass
class TriangleRecord:
    """What a ray's hit needs to know first: one fetch of three vectors.

    Attributes:
        ng: Geometric normal of the front, not normalised.
        flags: Material flags and HAS_TEXEL.
        pixel: Lightmap position in pixels, and the first pixel of its page.
    """

    ng: mi.Vector3f
    flags: mi.UInt32
    pixel: mi.Point2f
    page_start: mi.UInt32


class World:
    """Everything that integrators ask about a scene.

    Args:
        scene: Materials, images and lights.
        mesh: The scene's merged mesh.
        page_size: (width, height) of lightmap pages in pixels; None without a lightmap.
        robust: Watertight intersection.

    Attributes:
        scene: As given.
        filters: Whether any surface lets light through unbent.
        translucent: Whether any surface lets light through diffusely.
        double_sided: Whether any surface shines back from behind.
        clamped_materials: Names of those in use that would reflect more than they may.
        fully_mapped: Whether every triangle that reflects has texels.
    """

    def __init__(
        self, scene: Scene, mesh: MergedMesh, page_size: tuple[int, int] | None = None, *, robust: bool = True
    ) -> None:
        if len(mesh.indices) == 0:
            raise InputError("the scene has no triangles", where=scene.name)
        self.scene = scene
        textures = TextureTable(scene.images)
        self.materials = MaterialTable(scene.materials, textures)
        textures.freeze()
        used = np.unique(mesh.material)
        self.clamped_materials = [scene.materials[i].name for i in used if self.materials.clamped[i]]
        self.geometry = Geometry(mesh, robust=robust)
        flags = self.materials.flags[mesh.material] | np.where(mesh.page >= 0, HAS_TEXEL, 0).astype(np.uint32)
        met = flags if mesh.casts is None else flags[mesh.casts]
        self._emits = bool((met & EMISSIVE).any())
        self.filters = bool((met & FILTERS).any())
        self.translucent = bool((flags & TRANSLUCENT).any())
        self.double_sided = bool((met & DOUBLE_SIDED).any())
        self.fully_mapped = bool(((met & (HAS_TEXEL | UNLIT)) != 0).all())
        self.page_width, self.page_height = page_size or (1, 1)
        self._records = mi.Float(_records(mesh, flags, self.page_width, self.page_height).ravel())
        self.lights = make_lights(scene, mesh)

    @property
    def straight(self) -> bool:
        """Whether every ray's first hit ends it, given a lightmap to read."""
        return self.fully_mapped and not (self.filters or self.double_sided or self.translucent)

    @property
    def plain(self) -> bool:
        """Whether, on top of that, no surface shines by itself."""
        return self.straight and not self._emits

    def record(self, triangle: mi.UInt32, bary: mi.Point2f, active: mi.Bool) -> TriangleRecord:
        """The triangle's record, its lightmap position interpolated."""
        a = dr.gather(mi.Vector4f, self._records, 3 * triangle, active)
        b = dr.gather(mi.Vector4f, self._records, 3 * triangle + 1, active)
        c = dr.gather(mi.Vector4f, self._records, 3 * triangle + 2, active)
        pixel = mi.Point2f(a.x + b.x * bary.x + b.z * bary.y, a.y + b.y * bary.x + b.w * bary.y)
        flags = dr.reinterpret_array(mi.UInt32, c.w)
        return TriangleRecord(mi.Vector3f(c.x, c.y, c.z), flags, pixel, dr.reinterpret_array(mi.UInt32, a.z))

    def on_page(self, triangle: mi.UInt32, active: mi.Bool) -> tuple[mi.Point2f, mi.Vector2f, mi.Vector2f]:
        """Where a triangle lies on its page, in pixels: its first corner, and the edges from there."""
        a = dr.gather(mi.Vector4f, self._records, 3 * triangle, active)
        b = dr.gather(mi.Vector4f, self._records, 3 * triangle + 1, active)
        return mi.Point2f(a.x, a.y), mi.Vector2f(b.x, b.y), mi.Vector2f(b.z, b.w)

    def page_area_px(self, triangle: mi.UInt32, active: mi.Bool) -> mi.Float:
        """The triangle's area on its lightmap page; 0 where it has no place there."""
        edges = dr.gather(mi.Vector4f, self._records, 3 * triangle + 1, active)
        return 0.5 * dr.abs(edges.x * edges.w - edges.y * edges.z)

    def appearance(self, triangle: mi.UInt32, bary: mi.Point2f, active: mi.Bool) -> Appearance:
        """Reflectance and pass-through at a point, textures applied."""
        uv0, uv1, colour = self.geometry.texcoords(triangle, bary, active)
        material = self.geometry.vertices(triangle, active).w
        return self.materials.appearance(material, uv0, uv1, colour, active)

    def emission(
        self, triangle: mi.UInt32, bary: mi.Point2f, from_back: mi.Bool, active: mi.Bool
    ) -> mi.Color3f:
        """Emitted radiance, thinned by alpha; the back emits where the material is double-sided."""
        if not self._emits:
            return mi.Color3f(0.0)
        material = self.geometry.vertices(triangle, active).w
        flags = self.materials.flags_of(material, active)
        shines = active & ((flags & EMISSIVE) != 0) & (~from_back | ((flags & DOUBLE_SIDED) != 0))
        uv0, uv1, colour = self.geometry.texcoords(triangle, bary, shines)
        radiance = self.materials.emission(material, uv0, uv1, shines)
        if self.filters:
            radiance *= self.materials.appearance(material, uv0, uv1, colour, shines).coverage
        return dr.select(shines, radiance, 0.0)

    def emission_seen_from(self, point: SurfacePoint) -> Callable[..., mi.Color3f]:
        """:meth:`emission` without the surfaces that a point doesn't see: other levels of detail."""
        if point.lod is None:
            return self.emission

        def emission(
            triangle: mi.UInt32, bary: mi.Point2f, from_back: mi.Bool, active: mi.Bool
        ) -> mi.Color3f:
            seen = self.geometry.seen(triangle, point.lod, active)
            return self.emission(triangle, bary, from_back, seen)

        return emission

    @dr.syntax
    def transmittance(
        self,
        origin: mi.Point3f,
        direction: mi.Vector3f,
        distance: mi.Float,
        active: mi.Bool,
        lod: mi.UInt32 | None = None,
    ) -> mi.Color3f:
        """Share of light that arrives over a distance, through any number of layers.

        ``lod`` is that of the :class:`SurfacePoint` where the ray starts.
        """
        if dr.hint(not self.filters, mode="scalar"):
            blocked = self.geometry.occluded(origin, direction, distance, active, lod)
            return dr.select(active & ~blocked, mi.Color3f(1.0), mi.Color3f(0.0))
        result = dr.select(active, mi.Color3f(1.0), mi.Color3f(0.0))
        o, left, active = mi.Point3f(origin), mi.Float(distance), mi.Bool(active)
        while active:
            hit = self.geometry.intersect(o, direction, active, lod)
            active &= hit.valid & (hit.t < left)
            flags = self.record(hit.triangle, hit.bary, active).flags
            thin = active & ((flags & FILTERS) != 0)
            through = self.appearance(hit.triangle, hit.bary, thin).through
            result = dr.select(active, dr.select(thin, result * through, mi.Color3f(0.0)), result)
            active &= thin & (dr.max(result) > 0.0)
            beyond = self.geometry.step_past(o, direction, hit.t)
            left = dr.select(active, left - dr.norm(beyond - o), left)
            o = dr.select(active, beyond, o)
        return result

    def meets_back(
        self, origin: mi.Point3f, direction: mi.Vector3f, active: mi.Bool, lod: mi.UInt32 | None = None
    ) -> mi.Bool:
        """Whether the nearest surface is an opaque, single-sided one seen from behind."""
        hit = self.geometry.intersect(origin, direction, active, lod)
        record = self.record(hit.triangle, hit.bary, hit.valid)
        solid = (record.flags & (DOUBLE_SIDED | FILTERS | TRANSLUCENT)) == 0
        return hit.valid & solid & (dr.dot(record.ng, direction) > 0.0)

    def point(
        self, triangle: mi.UInt32, bary: mi.Point2f, active: mi.Bool, back: mi.Bool | None = None
    ) -> SurfacePoint:
        """See :meth:`Geometry.point`; where light comes through diffusely, its sides are known."""
        point = self.geometry.point(triangle, bary, active, back=back)
        if self.translucent:
            point.sides = self._sides(triangle, bary, active, mi.Bool(False) if back is None else back)
        return point

    def _sides(self, triangle: mi.UInt32, bary: mi.Point2f, active: mi.Bool, back: mi.Bool) -> Sides:
        """What light of either side counts, seen from the front or, on ``back`` lanes, from the back."""
        flags = self.materials.flags_of(self.geometry.vertices(triangle, active).w, active)
        thin = active & ((flags & TRANSLUCENT) != 0)
        looks = self.appearance(triangle, bary, thin)
        scale = dr.rcp(dr.maximum(looks.reflectance, 1e-6))
        reflects = ~back | ((flags & DOUBLE_SIDED) != 0)
        front = dr.select(thin, dr.select(reflects, looks.reflected * scale, 0.0), 1.0)
        behind = dr.select(thin, looks.transmitted * scale, 0.0)
        p_behind = dr.mean(behind) / dr.maximum(dr.mean(front + behind), 1e-6)
        origin = self.geometry.point(triangle, bary, thin, back=~back).origin
        return Sides(front, behind, origin, p_behind)


def _records(mesh: MergedMesh, flags: NDArray[np.uint32], width: int, height: int) -> NDArray[np.float32]:
    """Rows of 12: corner pixel, page start, –, edge pixels (4), normal (3), flags."""
    rows = np.zeros((len(mesh.indices), 12), np.float32)
    pixels = mesh.lightmap_uv[mesh.indices] * np.array([width, height], np.float32)
    start = np.maximum(mesh.page, 0).astype(np.uint32) * np.uint32(width * height)
    corners = mesh.positions[mesh.indices]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    rows[:, 0:2], rows[:, 2] = pixels[:, 0], start.view(np.float32)
    rows[:, 4:6], rows[:, 6:8] = pixels[:, 1] - pixels[:, 0], pixels[:, 2] - pixels[:, 0]
    rows[:, 8:11], rows[:, 11] = normal, flags.view(np.float32)
    return rows
