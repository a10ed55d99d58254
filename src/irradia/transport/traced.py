"""The triangles that rays meet: a tree of bare triangles in Embree or OptiX, and what a hit stands for.

Triangles that coincide exactly are traced once. Which of them is hit is then our decision, not the
tracer's, whose choice varies from run to run: the front-facing one with the lowest number.

Levels of detail of one object stand in one place, and all are in the one tree. A ray passes through
those that its origin doesn't see; scenes without levels never look.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from irradia.scene.merge import CAMERA_LOD, LEVEL_BITS, MergedMesh
from irradia.transport.backend import dr, mi

NONE = 0xFFFFFFFF

Normal = Callable[["mi.UInt32", "mi.Bool"], "mi.Vector3f"]
StepPast = Callable[["mi.Point3f", "mi.Vector3f", "mi.Float"], "mi.Point3f"]


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


class TracedTriangles:
    """All triangles that block light.

    Args:
        mesh: Triangles that don't cast are left out.
        normal: Geometric normal of a triangle of the mesh.
        step_past: A point just behind a surface at a distance.
        robust: Watertight intersection.

    Attributes:
        has_lods: Whether any surface is only seen by some others.
    """

    def __init__(self, mesh: MergedMesh, normal: Normal, step_past: StepPast, *, robust: bool) -> None:
        groups = merge_coincident(mesh)
        self._normal, self._step_past = normal, step_past
        self._renumbered = len(groups.traced) < len(mesh.indices)
        self.has_lods = mesh.lod is not None
        tables = (self._renumbered or self.has_lods) and len(groups.traced) > 0
        self._front = mi.UInt32(groups.traced if tables else 0)
        self._back = mi.UInt32(groups.back if tables else 0)
        self._following = mi.UInt32(groups.following if self.has_lods else 0)
        self._lod = mi.UInt32(0 if mesh.lod is None else mesh.lod)
        self._scene = _trace_scene(mesh, groups.traced, robust)

    def nearest(
        self, origin: mi.Point3f, direction: mi.Vector3f, active: mi.Bool, lod: mi.UInt32 | None = None
    ) -> Hit:
        """The nearest triangle that is seen from a surface of the level ``lod`` (None: of no object's)."""
        if self.has_lods:
            return self._nearest_seen(origin, direction, active, mi.UInt32(0 if lod is None else lod))
        hit = self._nearest_traced(origin, direction, active)
        return self._pick_twin(hit, direction) if self._renumbered else hit

    def occluded(
        self,
        origin: mi.Point3f,
        direction: mi.Vector3f,
        distance: mi.Float,
        active: mi.Bool,
        lod: mi.UInt32 | None = None,
    ) -> mi.Bool:
        """Whether anything that is seen lies nearer than ``distance``."""
        if self.has_lods:
            hit = self.nearest(origin, direction, active, lod)
            return hit.valid & (hit.t < distance)
        ray = mi.Ray3f(origin, direction, distance, 0.0, [])
        return self._scene.ray_test(ray, False, active)

    def lod(self, triangle: mi.UInt32, active: mi.Bool) -> mi.UInt32 | None:
        """The triangle's level of detail as rays from it carry it; None where nothing has any."""
        if not self.has_lods:
            return None
        its_lod = dr.gather(mi.UInt32, self._lod, triangle, active)
        return dr.select(its_lod == CAMERA_LOD, 0, its_lod)

    def seen(self, triangle: mi.UInt32, lod: mi.UInt32, active: mi.Bool) -> mi.Bool:
        """Whether surfaces of the level ``lod`` see a triangle: of their own object, only their level;
        of all others, the finest.
        """
        its_lod = dr.gather(mi.UInt32, self._lod, triangle, active)
        same_object = (its_lod ^ lod) < (1 << LEVEL_BITS)
        finest = (its_lod & ((1 << LEVEL_BITS) - 1)) == 0
        return active & dr.select(same_object, its_lod == lod, finest)

    def _nearest_traced(self, origin: mi.Point3f, direction: mi.Vector3f, active: mi.Bool) -> Hit:
        """The nearest of the traced triangles, by their own numbers."""
        pi = self._scene.ray_intersect_preliminary(mi.Ray3f(origin, direction), False, active)
        return Hit(pi.is_valid() & active, pi.t, pi.prim_index, mi.Point2f(pi.prim_uv))

    def _pick_twin(self, hit: Hit, direction: mi.Vector3f) -> Hit:
        """Chooses among coincident triangles; a back twin's barycentrics are mirrored."""
        front = dr.gather(mi.UInt32, self._front, hit.triangle, hit.valid)
        back = dr.gather(mi.UInt32, self._back, hit.triangle, hit.valid)
        from_front = dr.dot(self._normal(front, hit.valid), direction) < 0.0
        mirrored = hit.valid & ~from_front & (back != NONE)
        triangle = dr.select(mirrored, back, front)
        bary = dr.select(mirrored, mi.Point2f(hit.bary.y, hit.bary.x), hit.bary)
        return Hit(hit.valid, hit.t, triangle, bary)

    @dr.syntax
    def _nearest_seen(
        self, origin: mi.Point3f, direction: mi.Vector3f, active: mi.Bool, lod: mi.UInt32
    ) -> Hit:
        """Goes on through hidden levels until something is seen."""
        result = Hit(mi.Bool(False), mi.Float(dr.inf), mi.UInt32(0), mi.Point2f(0.0))
        o, travelled, searching = mi.Point3f(origin), mi.Float(0.0), mi.Bool(active)
        while searching:
            met = self._nearest_traced(o, direction, searching)
            hit = self._pick_seen(met, direction, lod)
            found = searching & hit.valid
            reached = Hit(mi.Bool(True), travelled + met.t, hit.triangle, hit.bary)
            result = dr.select(found, reached, result)
            searching &= met.valid & ~hit.valid
            beyond = self._step_past(o, direction, met.t)
            travelled += dr.select(searching, dr.norm(beyond - o), 0.0)
            o = dr.select(searching, beyond, o)
        return result

    def _pick_seen(self, hit: Hit, direction: mi.Vector3f, lod: mi.UInt32) -> Hit:
        """As :meth:`_pick_twin`, among the coincident triangles that are seen; not valid if none is."""
        first = dr.gather(mi.UInt32, self._front, hit.triangle, hit.valid)
        from_front = dr.dot(self._normal(first, hit.valid), direction) < 0.0
        front = self._first_seen(first, lod, hit.valid)
        back = self._first_seen(dr.gather(mi.UInt32, self._back, hit.triangle, hit.valid), lod, hit.valid)
        mirrored = (back != NONE) & (~from_front | (front == NONE))
        triangle = dr.select(mirrored, back, front)
        bary = dr.select(mirrored, mi.Point2f(hit.bary.y, hit.bary.x), hit.bary)
        return Hit(hit.valid & (triangle != NONE), hit.t, triangle, bary)

    @dr.syntax
    def _first_seen(self, triangle: mi.UInt32, lod: mi.UInt32, active: mi.Bool) -> mi.UInt32:
        """The first triangle that is seen, of those that coincide with one in the same winding."""
        candidate = dr.select(active, triangle, NONE)
        searching = candidate != NONE
        while searching:
            searching &= ~self.seen(candidate, lod, searching)
            following = dr.gather(mi.UInt32, self._following, candidate, searching)
            candidate = dr.select(searching, following, candidate)
            searching &= candidate != NONE
        return candidate


@dataclass(frozen=True)
class CoincidentGroups:
    """Triangles with the same three corners.

    Attributes:
        traced: (G,) the lowest triangle of each group, ascending.
        back: (G,) the group's lowest triangle with the opposite winding, or NONE.
        following: (T,) the next triangle of the same group and winding, or NONE; only filled in where
            the mesh has levels of detail.
    """

    traced: NDArray[np.uint32]
    back: NDArray[np.uint32]
    following: NDArray[np.uint32]


def merge_coincident(mesh: MergedMesh) -> CoincidentGroups:
    """Groups the triangles that cast.

    Triangles start at their smallest corner (see ``merge``), so windings compare vertex by vertex.
    """
    everything = np.arange(len(mesh.indices), dtype=np.uint32)
    numbers = everything if mesh.casts is None else everything[mesh.casts]
    corners = mesh.positions[mesh.indices[numbers]] + np.float32(0.0)  # −0 and 0 are one place
    words = np.ascontiguousarray(corners).view(np.uint32).reshape(-1, 3, 3)
    winding = _lexicographic_less(words[:, 1], words[:, 2])
    key = np.where(winding[:, None, None], words, words[:, [0, 2, 1]]).reshape(-1, 9)
    rows = np.ascontiguousarray(key).view([("", np.uint32)] * 9).ravel()
    _, first, group = np.unique(rows, return_index=True, return_inverse=True)
    by_winding = np.full((2, len(first)), NONE, np.uint32)
    following = np.full(len(mesh.indices), NONE, np.uint32)
    for side in (0, 1):
        chosen = winding == bool(side)
        np.minimum.at(by_winding[side], group[chosen], numbers[chosen])
        if mesh.lod is not None:
            _chain(following, numbers[chosen], group[chosen])
    order = np.argsort(first)
    traced = first[order]
    back = by_winding[1 - winding[traced].astype(int), order]
    return CoincidentGroups(numbers[traced], back, following)


def _chain(following: NDArray[np.uint32], numbers: NDArray[np.uint32], group: NDArray[np.intp]) -> None:
    """Writes behind each triangle the next one of its group, ascending."""
    order = np.argsort(group, kind="stable")
    numbers, group = numbers[order], group[order]
    same = group[1:] == group[:-1]
    following[numbers[:-1][same]] = numbers[1:][same]


def _lexicographic_less(a: NDArray[np.uint32], b: NDArray[np.uint32]) -> NDArray[np.bool_]:
    less, equal = a < b, a == b
    return less[:, 0] | equal[:, 0] & (less[:, 1] | equal[:, 1] & less[:, 2])


def _trace_scene(mesh: MergedMesh, triangles: NDArray[np.uint32], robust: bool) -> mi.Scene:
    """Hands bare triangles to the tracer."""
    if len(triangles) == 0:
        return mi.load_dict({"type": "scene"})
    traced = mi.Mesh(
        "scene", len(mesh.positions), len(triangles), has_vertex_normals=False, has_vertex_texcoords=False
    )
    params = mi.traverse(traced)
    params["vertex_positions"] = mi.Float(mesh.positions.ravel())
    params["faces"] = mi.UInt32(mesh.indices[triangles].ravel())
    params.update()
    # One thread builds the tree: with two its shape, and so the pick among touching faces, varies.
    threads = dr.thread_count()
    dr.set_thread_count(1)
    try:
        return mi.load_dict({"type": "scene", "mesh": traced, "embree_use_robust_intersections": robust})
    finally:
        dr.set_thread_count(threads)
