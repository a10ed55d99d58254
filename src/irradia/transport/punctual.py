"""Light from points, spots and afar: what one of them sends to a place.

A point or spot with a radius is a sphere, and a directional light with an angle a disc in the sky. Each
shines evenly over the solid angle in which it is seen, and that is what is sampled; its radiance is such
that a surface that faces it gets what the light's candela or lux say, whatever its size:

    sphere   E = I / d²  (a sphere of even radiance L sends π L r²/d², at any distance)
    disc     E = lux

The direction-dependent part of I, cone or profile, is taken at the centre. Rays can't meet these
lights, so they exist in next-event estimation alone.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from irradia.scene.types import Light
from irradia.transport.backend import dr, mi
from irradia.transport.light_profiles import LightProfiles
from irradia.transport.sampling import to_world

FAR = 1e30  # the distance of what has none
NO_LIGHT = 0xFFFFFFFF
_LOCAL = -1.0  # stands where directional lights have the size of their disc


class PunctualLights:
    """Directional, point and spot lights, each known by its place in ``Scene.lights``.

    Attributes:
        count: How many, those that are off included.
    """

    def __init__(self, lights: Sequence[Light]) -> None:
        self.count = len(lights)
        self._rows = mi.Float(np.array([_row(light) for light in lights], np.float32).ravel())
        self._soft = any(light.radius_m > 0.0 or light.angle_deg > 0.0 for light in lights)
        self._profiles = LightProfiles(lights) if any(light.profile for light in lights) else None
        live = [light.mode in ("mixed", "realtime") for light in lights]
        self._live = mi.UInt32(np.array(live, np.uint32)) if any(live) else None

    def is_live(self, index: mi.UInt32, active: mi.Bool) -> mi.Bool:
        """Whether a light's first bounce is lit live, so that maps of indirect light leave it out."""
        if self._live is None:
            return mi.Bool(False)
        known = active & (index != NO_LIGHT)
        return known & (dr.gather(mi.UInt32, self._live, index, known) != 0)

    def sample_one(
        self, origin: mi.Point3f, index: mi.UInt32, u: mi.Point2f, active: mi.Bool
    ) -> tuple[mi.Vector3f, mi.Float, mi.Color3f]:
        """A direction to one light, the distance to it and the irradiance facing it.

        Args:
            origin: The receiver.
            index: Place in ``Scene.lights``.
            u: Where on the light's disc or sphere.
            active: Lanes that ask.

        Returns:
            Unit direction; distance to the light, a little short of it; irradiance on a surface
            that faces the direction. Its mean over ``u``, times the cosine there, is E.
        """
        index = mi.UInt32(index)
        rows = [dr.gather(mi.Vector4f, self._rows, index * 4 + i, active) for i in range(4)]
        position, radius = mi.Point3f(rows[0].x, rows[0].y, rows[0].z), rows[0].w
        axis, disc = mi.Vector3f(rows[1].x, rows[1].y, rows[1].z), rows[1].w
        intensity, range_m = mi.Color3f(rows[2].x, rows[2].y, rows[2].z), rows[2].w
        cone_scale, cone_offset = rows[3].x, rows[3].y
        directional = disc >= 0.0

        # ---- to the centre ----
        towards = mi.Vector3f(position - origin)
        distance = dr.norm(towards)
        to_centre = towards / dr.maximum(distance, 1e-20)
        cone = dr.clip(dr.dot(-to_centre, axis) * cone_scale + cone_offset, 0.0, 1.0)
        share = cone * cone
        if self._profiles is not None:
            share = self._profiles.weigh(share, index, axis, -to_centre, active)
        reach = dr.maximum(dr.squared_norm(towards), dr.maximum(dr.square(radius), 1e-12))
        ratio = dr.square(dr.square(distance / range_m))
        window = dr.select(range_m < FAR, dr.clip(1.0 - ratio, 0.0, 1.0), 1.0)
        irradiance = intensity * dr.select(directional, 1.0, share * window / reach)
        direction = dr.select(directional, -axis, to_centre)
        if not self._soft:
            return direction, dr.select(directional, FAR, distance * (1.0 - 1e-5)), irradiance

        # ---- a place on what is seen of it: 1 − cos of its angular radius, without cancellation ----
        sin2 = dr.square(radius) / reach
        opening = dr.select(directional, disc, sin2 / (1.0 + dr.safe_sqrt(1.0 - sin2)))
        local = _uniform_cone(opening, u)
        direction = to_world(direction, local)
        sin2_there = dr.square(local.x) + dr.square(local.y)
        half_chord = dr.safe_sqrt(dr.square(radius) - dr.squared_norm(towards) * sin2_there)
        to_surface = dr.maximum(distance * local.z - half_chord, 0.0)
        # Light of a solid angle 2π·opening falls on the surface that faces its middle with the mean
        # cosine 1 − opening/2.
        irradiance *= dr.rcp(1.0 - 0.5 * opening)
        return direction, dr.select(directional, FAR, to_surface * (1.0 - 1e-5)), irradiance


def _row(light: Light) -> list[float]:
    """Position, radius; axis, disc; intensity, range; the cone as a linear map of the cosine."""
    directional = light.kind == "directional"
    disc = 2.0 * math.sin(math.radians(light.angle_deg) / 4.0) ** 2 if directional else _LOCAL
    scale, offset = 0.0, 1.0
    if light.kind == "spot" and light.profile is None:
        inner, outer = math.cos(light.inner_cone_rad), math.cos(light.outer_cone_rad)
        scale = 1.0 / max(inner - outer, 1e-4)
        offset = -outer * scale
    radius = 0.0 if directional else light.radius_m
    rows = [*light.position, radius, *light.direction, disc, *light.intensity, light.range_m or 2.0 * FAR]
    return [*rows, scale, offset, 0.0, 0.0]


def _uniform_cone(opening: mi.Float, u: mi.Point2f) -> mi.Vector3f:
    """A direction about +Z, uniform in the cone whose ``opening`` is 1 − cos of its half-angle."""
    down = u.x * opening
    sin_theta = dr.safe_sqrt(down * (2.0 - down))
    sin_phi, cos_phi = dr.sincos(2.0 * math.pi * u.y)
    return mi.Vector3f(cos_phi * sin_theta, sin_phi * sin_theta, 1.0 - down)
