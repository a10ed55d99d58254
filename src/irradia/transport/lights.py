"""Light sources and next-event estimation.

Three classes of source: punctual lights (which rays can't meet), emissive triangles, and the
environment. A sample first picks a class, then a source in it; both picks use alias tables, so
cost doesn't grow with the number of sources. Non-punctual samples carry their solid-angle density,
which multiple importance sampling needs, and the same density can be asked for from a ray's hit.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from irradia.transport.backend import dr, mi
from irradia.transport.emissive import EmissiveTriangles
from irradia.transport.environment_light import EnvironmentLight
from irradia.transport.geometry import Geometry, SurfacePoint
from irradia.transport.punctual import FAR, PunctualLights

Emission = Callable[["mi.UInt32", "mi.Point2f", "mi.Bool", "mi.Bool"], "mi.Color3f"]


@dataclass
class LightSample:
    """One next-event sample.

    Attributes:
        direction: Unit, towards the light.
        distance: To the light, a little short of it.
        weight: Radiance · (class and source probability)⁻¹ · (solid-angle density)⁻¹; for punctual
            lights the irradiance facing the light over the pick's probability.
        pdf: Solid-angle density, picks included; 0 for punctual lights, which need no MIS.
    """

    direction: mi.Vector3f
    distance: mi.Float
    weight: mi.Color3f
    pdf: mi.Float


class Lights:
    """All sources of a scene and the pick among their classes.

    Attributes:
        any: Whether next-event estimation has anything to sample.
        p_environment, p_area, p_punctual: Probabilities of the classes.
    """

    def __init__(
        self,
        punctual: PunctualLights | None,
        area: EmissiveTriangles | None,
        environment: EnvironmentLight | None,
    ) -> None:
        self.punctual, self.area, self.environment = punctual, area, environment
        shares = {
            "punctual": 1.0 if punctual else 0.0,
            "area": 1.0 if area else 0.0,
            "environment": 1.0 if environment and environment.sampled else 0.0,
        }
        total = sum(shares.values())
        self.any = total > 0.0
        self.p_punctual, self.p_area, self.p_environment = (v / max(total, 1.0) for v in shares.values())

    def environment_radiance(self, direction: mi.Vector3f, active: mi.Bool) -> tuple[mi.Color3f, mi.Float]:
        """What a ray that leaves the scene sees, and next-event estimation's density there."""
        if self.environment is None:
            return mi.Color3f(0.0), mi.Float(0.0)
        radiance, pdf = self.environment.lookup(direction, active)
        return radiance, pdf * self.p_environment

    def area_pdf(
        self, triangle: mi.UInt32, distance: mi.Float, cos_light: mi.Float, active: mi.Bool
    ) -> mi.Float:
        """Next-event estimation's solid-angle density of a point on an emissive triangle."""
        if self.area is None:
            return mi.Float(0.0)
        density = self.area.density(triangle, active)
        return density * self.p_area * dr.square(distance) / dr.maximum(dr.abs(cos_light), 1e-8)

    def sample(
        self,
        geometry: Geometry,
        emission,
        point: SurfacePoint,
        pick: mi.Float,
        u: mi.Point2f,
        active: mi.Bool,
    ) -> LightSample:
        """Draws one sample as seen from a surface point.

        Args:
            geometry: For points on emissive triangles.
            emission: Function (triangle, bary, from_back, active) → radiance.
            point: The receiver.
            pick: Random number that picks the class.
            u: Two random numbers for the source and the place on it.
            active: Lanes that want a sample.
        """
        result = LightSample(mi.Vector3f(0, 0, 1), mi.Float(FAR), mi.Color3f(0.0), mi.Float(0.0))
        if self.punctual is not None:
            chosen = active & (pick < self.p_punctual)
            direction, distance, irradiance = self.punctual.sample(point.origin, u, chosen)
            sample = LightSample(direction, distance, irradiance / self.p_punctual, mi.Float(0.0))
            result = dr.select(chosen, sample, result)
        if self.area is not None:
            chosen = active & (pick >= self.p_punctual) & (pick < self.p_punctual + self.p_area)
            result = dr.select(chosen, self._sample_area(geometry, emission, point, u, chosen), result)
        if self.p_environment > 0.0:
            chosen = active & (pick >= self.p_punctual + self.p_area)
            direction, radiance, pdf = self.environment.sample(u, chosen)
            pdf = pdf * self.p_environment
            sample = LightSample(direction, mi.Float(FAR), radiance / dr.maximum(pdf, 1e-20), pdf)
            result = dr.select(chosen, sample, result)
        return result

    def _sample_area(
        self, geometry: Geometry, emission: Emission, point: SurfacePoint, u: mi.Point2f, active: mi.Bool
    ) -> LightSample:
        triangle, bary, density = self.area.sample(u, active)
        there = geometry.point(triangle, bary, active)
        towards = mi.Vector3f(there.position - point.origin)
        distance = dr.norm(towards)
        direction = towards / dr.maximum(distance, 1e-20)
        cos_light = -dr.dot(there.ng, direction)
        radiance = emission(triangle, bary, cos_light < 0.0, active)
        pdf = density * self.p_area * dr.square(distance) / dr.maximum(dr.abs(cos_light), 1e-8)
        weight = dr.select(active & (pdf > 0.0), radiance / dr.maximum(pdf, 1e-20), 0.0)
        return LightSample(direction, distance * (1.0 - 1e-4), weight, pdf)
