"""Light from points, spots and afar."""

from __future__ import annotations

import math

import numpy as np

from irradia.scene.types import Light
from irradia.transport.backend import dr, mi
from irradia.transport.sampling import to_world

FAR = 1e30  # the distance of what has none
_DIRECTIONAL, _POINT, _SPOT = 0.0, 1.0, 2.0


class PunctualLights:
    """Directional, point and spot lights, each picked with equal probability."""

    def __init__(self, lights: tuple[Light, ...]) -> None:
        self.count = len(lights)
        rows = np.array([_light_row(light) for light in lights], np.float32)
        self._rows = mi.Float(rows.ravel())

    def sample(
        self, p: mi.Point3f, u: mi.Point2f, active: mi.Bool
    ) -> tuple[mi.Vector3f, mi.Float, mi.Color3f]:
        """Direction, distance and irradiance facing the light over the pick's probability."""
        scaled = u.x * self.count
        index = dr.minimum(mi.UInt32(scaled), self.count - 1)
        fresh = scaled - mi.Float(index)
        rows = [dr.gather(mi.Vector4f, self._rows, index * 4 + i, active) for i in range(4)]
        position = mi.Point3f(rows[0].x, rows[0].y, rows[0].z)
        axis = mi.Vector3f(rows[1].x, rows[1].y, rows[1].z)
        intensity = mi.Color3f(rows[2].x, rows[2].y, rows[2].z)
        kind, cos_disc, range_m = rows[0].w, rows[1].w, rows[2].w
        cos_inner, cos_outer = rows[3].x, rows[3].y

        directional = kind == _DIRECTIONAL
        towards = mi.Vector3f(position - p)
        distance = dr.norm(towards)
        to_point = towards / dr.maximum(distance, 1e-20)
        to_sun = to_world(-axis, _uniform_cone(cos_disc, mi.Point2f(fresh, u.y)))
        direction = dr.select(directional, to_sun, to_point)

        falloff = dr.rcp(dr.maximum(dr.square(distance), 1e-12))
        ratio = dr.square(dr.square(distance / range_m))
        window = dr.select(range_m < FAR, dr.clip(1.0 - ratio, 0.0, 1.0), 1.0)
        cone = dr.clip(
            (dr.dot(-to_point, axis) - cos_outer) / dr.maximum(cos_inner - cos_outer, 1e-4), 0.0, 1.0
        )
        falloff = falloff * window * dr.select(kind == _SPOT, cone * cone, 1.0)
        irradiance = intensity * dr.select(directional, 1.0, falloff) * float(self.count)
        return direction, dr.select(directional, FAR, distance * (1.0 - 1e-5)), irradiance


def _light_row(light: Light) -> list[float]:
    kind = {"directional": _DIRECTIONAL, "point": _POINT, "spot": _SPOT}[light.kind]
    cos_disc = math.cos(math.radians(light.angle_deg) / 2.0)
    row = [*light.position, kind, *light.direction, cos_disc, *light.intensity, light.range_m or 2.0 * FAR]
    return [*row, math.cos(light.inner_cone_rad), math.cos(light.outer_cone_rad), 0.0, 0.0]


def _uniform_cone(cos_max: mi.Float, u: mi.Point2f) -> mi.Vector3f:
    """A direction about +Z, uniform in the cone."""
    cos_theta = 1.0 - u.x * (1.0 - cos_max)
    sin_theta = dr.safe_sqrt(1.0 - cos_theta * cos_theta)
    sin_phi, cos_phi = dr.sincos(2.0 * math.pi * u.y)
    return mi.Vector3f(cos_phi * sin_theta, sin_phi * sin_theta, cos_theta)
