"""Light sources and next-event estimation.

A sample first picks among three kinds: distant lights (directional ones), local sources (points, spots
and emissive triangles) and the environment; then a source of that kind (see ``light_choice``); then a
place on it. Samples of what rays can meet carry their solid-angle density, which multiple importance
sampling needs, and the same density can be asked for from a ray's hit.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from irradia.transport.alias import AliasTable
from irradia.transport.backend import dr, mi
from irradia.transport.emissive import EmissiveTriangles
from irradia.transport.environment_light import EnvironmentLight
from irradia.transport.geometry import Geometry, SurfacePoint
from irradia.transport.light_choice import Choice, LightChoice
from irradia.transport.punctual import FAR, NO_LIGHT, PunctualLights

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
        punctual: Place in ``Scene.lights`` of the punctual light, or NO_LIGHT for other sources.
    """

    direction: mi.Vector3f
    distance: mi.Float
    weight: mi.Color3f
    pdf: mi.Float
    punctual: mi.UInt32


@dataclass(frozen=True)
class DistantLights:
    """Directional lights, picked by their strength.

    Attributes:
        indices: Their places in ``Scene.lights``.
        strengths: Mean of their channels; all above 0.
    """

    indices: tuple[int, ...]
    strengths: tuple[float, ...]


class Lights:
    """All sources of a scene and the pick among them.

    Args:
        punctual: The scene's punctual lights, or None.
        distant: Which of them are directional and on, or None.
        local: How to choose among points, spots and emissive triangles, or None without any.
        area: The emissive triangles, or None.
        environment: Light from all round, or None.
        local_weight: How often local sources are asked, against 1 for each other kind.

    Attributes:
        any: Whether next-event estimation has anything to sample.
        p_distant, p_local, p_environment: Probabilities of the kinds.
    """

    def __init__(
        self,
        punctual: PunctualLights | None = None,
        distant: DistantLights | None = None,
        local: LightChoice | None = None,
        area: EmissiveTriangles | None = None,
        environment: EnvironmentLight | None = None,
        local_weight: float = 1.0,
    ) -> None:
        self.punctual, self.area, self.environment = punctual, area, environment
        self._distant, self._local = _DistantChoice(distant) if distant else None, local
        shares = (
            1.0 if distant else 0.0,
            local_weight if local else 0.0,
            1.0 if environment and environment.sampled else 0.0,
        )
        total = sum(shares)
        self.any = total > 0.0
        self.p_distant, self.p_local, self.p_environment = (share / (total or 1.0) for share in shares)

    def environment_radiance(self, direction: mi.Vector3f, active: mi.Bool) -> tuple[mi.Color3f, mi.Float]:
        """What a ray that leaves the scene sees, and next-event estimation's density there."""
        if self.environment is None:
            return mi.Color3f(0.0), mi.Float(0.0)
        radiance, pdf = self.environment.lookup(direction, active)
        return radiance, pdf * self.p_environment

    def area_pdf(
        self,
        triangle: mi.UInt32,
        origin: mi.Point3f,
        distance: mi.Float,
        cos_light: mi.Float,
        active: mi.Bool,
    ) -> mi.Float:
        """Next-event estimation's solid-angle density of a point on an emissive triangle.

        Args:
            triangle: The one that a ray met.
            origin: Where the ray began: the receiver.
            distance: From there.
            cos_light: Of the ray against the triangle's normal.
            active: Lanes that ask.
        """
        if self.area is None or self._local is None:
            return mi.Float(0.0)
        density = self._local.area_density(triangle, origin, active)
        return density * self.p_local * dr.square(distance) / dr.maximum(dr.abs(cos_light), 1e-8)

    def is_live(self, index: mi.UInt32, active: mi.Bool) -> mi.Bool:
        """Whether :attr:`LightSample.punctual` names a mixed or realtime light."""
        return mi.Bool(False) if self.punctual is None else self.punctual.is_live(index, active)

    def sample(
        self,
        geometry: Geometry,
        emission: Emission,
        point: SurfacePoint,
        pick: mi.Float,
        u: mi.Point2f,
        active: mi.Bool,
    ) -> LightSample:
        """Draws one sample of the light that arrives above a surface.

        Args:
            geometry: For points on emissive triangles.
            emission: Function (triangle, bary, from_back, active) → radiance.
            point: The receiver. Sources below the horizon of its ``ns`` may never be sampled; where
                light from every side counts, ``ns`` is 0.
            pick: Random number that picks the kind of source.
            u: Two random numbers for the source and the place on it.
            active: Lanes that want a sample.
        """
        result = LightSample(
            mi.Vector3f(0, 0, 1), mi.Float(FAR), mi.Color3f(0.0), mi.Float(0.0), mi.UInt32(NO_LIGHT)
        )
        p_near = self.p_distant + self.p_local
        choice, near, on_punctual = None, mi.Bool(False), mi.Bool(False)
        if self._local is not None:
            near = active & (pick >= self.p_distant) & (pick < p_near)
            spare = (pick - self.p_distant) / self.p_local
            choice = self._local.choose(point, u, spare, near)
            on_punctual = near & ~choice.is_area & (choice.density > 0.0)
        if self.punctual is not None and (self._distant or self._local):
            sample = self._sample_punctual(point, choice, pick < self.p_distant, on_punctual, u, active)
            result = dr.select(active & (sample.punctual != NO_LIGHT), sample, result)
        if self.area is not None and choice is not None:
            chosen = near & choice.is_area
            result = dr.select(chosen, self._sample_area(geometry, emission, point, choice, chosen), result)
        if self.environment is not None and self.p_environment > 0.0:
            chosen = active & (pick >= p_near)
            direction, radiance, pdf = self.environment.sample(u, chosen)
            pdf = pdf * self.p_environment
            weight = radiance / dr.maximum(pdf, 1e-20)
            sample = LightSample(direction, mi.Float(FAR), weight, pdf, mi.UInt32(NO_LIGHT))
            result = dr.select(chosen, sample, result)
        return result

    def _sample_punctual(
        self,
        point: SurfacePoint,
        choice: Choice | None,
        picks_distant: mi.Bool,
        on_local: mi.Bool,
        u: mi.Point2f,
        active: mi.Bool,
    ) -> LightSample:
        """A directional, point or spot light; NO_LIGHT in lanes that picked none."""
        index, probability, place, chosen = mi.UInt32(0), mi.Float(1.0), mi.Point2f(u), on_local
        if choice is not None:
            index, place = choice.index, choice.u
            probability = choice.density * self.p_local
        if self._distant is not None:
            picked = active & picks_distant
            chosen = on_local | picked
            sun, sun_probability, sun_u = self._distant.choose(u, picked)
            index = dr.select(picked, sun, index)
            probability = dr.select(picked, sun_probability * self.p_distant, probability)
            place = dr.select(picked, sun_u, place)
        direction, distance, irradiance = self.punctual.sample_one(point.origin, index, place, chosen)
        weight = irradiance / dr.maximum(probability, 1e-20)
        which = dr.select(chosen, index, mi.UInt32(NO_LIGHT))
        return LightSample(direction, distance, weight, mi.Float(0.0), which)

    def _sample_area(
        self,
        geometry: Geometry,
        emission: Emission,
        point: SurfacePoint,
        choice: Choice,
        active: mi.Bool,
    ) -> LightSample:
        triangle, bary = choice.index, EmissiveTriangles.place(choice.u)
        there = geometry.point(triangle, bary, active)
        towards = mi.Vector3f(there.position - point.origin)
        distance = dr.norm(towards)
        direction = towards / dr.maximum(distance, 1e-20)
        cos_light = -dr.dot(there.ng, direction)
        radiance = emission(triangle, bary, cos_light < 0.0, active)
        pdf = choice.density * self.p_local * dr.square(distance) / dr.maximum(dr.abs(cos_light), 1e-8)
        weight = dr.select(active & (pdf > 0.0), radiance / dr.maximum(pdf, 1e-20), 0.0)
        return LightSample(direction, distance * (1.0 - 1e-4), weight, pdf, mi.UInt32(NO_LIGHT))


class _DistantChoice:
    """Picks a directional light by strength; one alone costs nothing."""

    def __init__(self, distant: DistantLights) -> None:
        self._only = distant.indices[0]
        self._alias = None
        if len(distant.indices) > 1:
            strengths = np.array(distant.strengths, np.float64)
            self._alias = AliasTable(strengths)
            self._indices = mi.UInt32(np.array(distant.indices, np.uint32))
            self._share = mi.Float((strengths / strengths.sum()).astype(np.float32))

    def choose(self, u: mi.Point2f, active: mi.Bool) -> tuple[mi.UInt32, mi.Float, mi.Point2f]:
        """A light, its probability, and fresh random numbers."""
        if self._alias is None:
            return mi.UInt32(self._only), mi.Float(1.0), u
        number, fresh = self._alias.sample(u.x, active)
        share = dr.gather(mi.Float, self._share, number, active)
        return dr.gather(mi.UInt32, self._indices, number, active), share, mi.Point2f(fresh, u.y)
