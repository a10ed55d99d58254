"""How a next-event sample chooses among the local sources: points, spots and emissive triangles."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from irradia.scene.types import Light
from irradia.transport.backend import dr, mi
from irradia.transport.emissive import EmissiveTriangles
from irradia.transport.geometry import SurfacePoint
from irradia.transport.light_bounds import LightBounds, bounds_of_lights, bounds_of_triangles
from irradia.transport.light_tree import LightTree

_NOT_EMISSIVE = 0xFFFFFFFF


@dataclass
class Choice:
    """A local source.

    Attributes:
        is_area: Whether it is a triangle.
        index: The triangle, or the light's place in ``Scene.lights``.
        density: Of a triangle's points: per area. Of a light: the pick's probability.
        u: Fresh random numbers for the place on it.
    """

    is_area: mi.Bool
    index: mi.UInt32
    density: mi.Float
    u: mi.Point2f


class LightChoice(Protocol):
    """Chooses local sources."""

    def choose(self, point: SurfacePoint, u: mi.Point2f, spare: mi.Float, active: mi.Bool) -> Choice:
        """One source for a receiver; ``u`` is stratified over a receiver's samples, ``spare`` isn't."""
        ...

    def area_density(self, triangle: mi.UInt32, origin: mi.Point3f, active: mi.Bool) -> mi.Float:
        """Density per area of a point on a triangle, as seen by a receiver at ``origin``."""
        ...


class FixedChoice:
    """The same for all receivers: lights all alike, triangles by power, half for either kind.

    What a scene of few sources wants: nothing is computed.
    """

    def __init__(self, local_lights: NDArray[np.uint32], area: EmissiveTriangles | None) -> None:
        self._count = len(local_lights)
        self._area = area
        # Without a table where there is nothing to look up, so that one light costs no fetch.
        self._lights = mi.UInt32(local_lights) if self._count > 1 else None
        self._only_light = int(local_lights[0]) if self._count else 0
        self._p_area = (0.5 if self._count else 1.0) if area else 0.0

    def choose(self, point: SurfacePoint, u: mi.Point2f, spare: mi.Float, active: mi.Bool) -> Choice:
        """See :class:`LightChoice`."""
        choice = Choice(mi.Bool(False), mi.UInt32(0), mi.Float(0.0), mi.Point2f(u))
        if self._count:
            choice = self._light(u, active)
        if self._area is None:
            return choice
        is_area = active & (spare < self._p_area)
        triangle, fresh = self._area.pick(u.x, is_area)
        density = self._area.density(triangle, is_area) * self._p_area
        surface = Choice(is_area, triangle, density, mi.Point2f(fresh, u.y))
        return dr.select(is_area, surface, choice) if self._count else surface

    def _light(self, u: mi.Point2f, active: mi.Bool) -> Choice:
        if self._lights is None:
            only = mi.UInt32(self._only_light)
            return Choice(mi.Bool(False), only, mi.Float(1.0 - self._p_area), mi.Point2f(u))
        scaled = u.x * self._count
        number = dr.minimum(mi.UInt32(scaled), self._count - 1)
        index = dr.gather(mi.UInt32, self._lights, number, active)
        density = mi.Float((1.0 - self._p_area) / self._count)
        return Choice(mi.Bool(False), index, density, mi.Point2f(scaled - mi.Float(number), u.y))

    def area_density(self, triangle: mi.UInt32, origin: mi.Point3f, active: mi.Bool) -> mi.Float:
        """See :class:`LightChoice`."""
        return self._area.density(triangle, active) * self._p_area


class TreeChoice:
    """By what each source may send to the receiver."""

    def __init__(
        self,
        lights: Sequence[Light],
        local_lights: NDArray[np.uint32],
        area: EmissiveTriangles | None,
        triangles: LightBounds,
        n_triangles: int,
    ) -> None:
        self._area = area
        count = len(local_lights)
        sources = bounds_of_lights([lights[i] for i in local_lights]).joined(triangles)
        self._tree = LightTree(sources, np.arange(len(sources)) >= count)
        numbers = area.triangles if area else np.zeros(0, np.int64)
        self._count = count
        self._index = mi.UInt32(np.concatenate([local_lights, numbers]).astype(np.uint32))
        source = np.full(n_triangles if area else 1, _NOT_EMISSIVE, np.uint32)
        if area:
            source[numbers] = count + np.arange(len(numbers))
        self._source = mi.UInt32(source)

    def choose(self, point: SurfacePoint, u: mi.Point2f, spare: mi.Float, active: mi.Bool) -> Choice:
        """See :class:`LightChoice`."""
        pick = self._tree.pick(point.origin, point.ns, u.x, active)
        found = active & (pick.probability > 0.0)
        index = dr.gather(mi.UInt32, self._index, pick.source, found)
        is_area = found & (pick.source >= self._count)
        density = pick.probability
        if self._area is not None:
            density = dr.select(is_area, density * self._area.inverse_area(index, is_area), density)
        # The way down has used up the high bits of u.x; the spare number stands in for the low ones.
        fine = pick.u + spare * (2.0**-24 / dr.maximum(pick.probability, 2.0**-24))
        return Choice(is_area, index, density, mi.Point2f(dr.minimum(fine, 1.0 - 2.0**-24), u.y))

    def area_density(self, triangle: mi.UInt32, origin: mi.Point3f, active: mi.Bool) -> mi.Float:
        """See :class:`LightChoice`."""
        inverse_area = self._area.inverse_area(triangle, active)
        shines = active & (inverse_area > 0.0)
        source = dr.gather(mi.UInt32, self._source, triangle, shines)
        return self._tree.probability(source, origin, mi.Vector3f(0.0), shines) * inverse_area


def emitter_bounds(
    corners: NDArray[np.float64], area: EmissiveTriangles | None, double_sided: NDArray[np.bool_]
) -> LightBounds:
    """Bounds of the triangles that emit.

    Args:
        corners: (T, 3, 3) of all triangles.
        area: The emitters, or None.
        double_sided: (T,) whose backs shine, too.
    """
    if area is None:
        return bounds_of_triangles(np.zeros((0, 3, 3)), np.zeros(0), np.zeros(0, np.bool_))
    chosen = area.triangles
    return bounds_of_triangles(corners[chosen].astype(np.float64), area.power, double_sided[chosen])
