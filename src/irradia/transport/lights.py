"""Light sources and next-event estimation.

Three classes of source: punctual lights (which rays can't meet), emissive triangles, and the
environment. A sample first picks a class, then a source in it; both picks use alias tables, so
cost doesn't grow with the number of sources. Non-punctual samples carry their solid-angle density,
which multiple importance sampling needs, and the same density can be asked for from a ray's hit.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from irradia.scene.merge import MergedMesh
from irradia.scene.types import Environment, Light
from irradia.transport.backend import dr, mi
from irradia.transport.geometry import Geometry, SurfacePoint
from irradia.transport.sampling import to_world

_LUMINANCE = np.array([0.2126, 0.7152, 0.0722])
_DIRECTIONAL, _POINT, _SPOT = 0.0, 1.0, 2.0
_FAR = 1e30
_LIGHT_FLOATS = 16


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


class AliasTable:
    """Picks an index in proportion to its weight in constant time (Vose 1991)."""

    def __init__(self, weights: NDArray[np.float64]) -> None:
        share = weights / weights.sum()
        threshold, alias = _vose(share * len(share))
        table = np.empty((len(share), 2), np.float32)
        table[:, 0] = threshold
        table[:, 1] = alias.astype(np.uint32).view(np.float32)
        self._table = mi.Float(table.ravel())
        self.size = len(share)

    def sample(self, u: mi.Float, active: mi.Bool) -> tuple[mi.UInt32, mi.Float]:
        """An index, and what is left of ``u`` as a fresh number."""
        scaled = u * self.size
        index = dr.minimum(mi.UInt32(scaled), self.size - 1)
        rest = dr.clip(scaled - mi.Float(index), 0.0, 1.0 - 2.0**-24)
        row = dr.gather(mi.Point2f, self._table, index, active)
        keep = rest < row.x
        fresh = dr.select(
            keep, rest / dr.maximum(row.x, 1e-20), (rest - row.x) / dr.maximum(1.0 - row.x, 1e-20)
        )
        other = dr.reinterpret_array(mi.UInt32, row.y)
        return dr.select(keep, index, other), dr.clip(fresh, 0.0, 1.0 - 2.0**-24)


def _vose(scaled: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Thresholds and aliases of weights whose mean is 1."""
    n = len(scaled)
    threshold, alias = np.ones(n), np.arange(n)
    remaining = scaled.copy()
    small, large = list(np.flatnonzero(scaled < 1.0)), list(np.flatnonzero(scaled >= 1.0))
    while small and large:
        low, high = small.pop(), large[-1]
        threshold[low], alias[low] = remaining[low], high
        remaining[high] -= 1.0 - remaining[low]
        if remaining[high] < 1.0:
            small.append(large.pop())
    return threshold, alias


class EnvironmentLight:
    """An equirectangular map, piecewise constant, sampled by luminance and solid angle."""

    def __init__(self, environment: Environment) -> None:
        radiance = environment.radiance.astype(np.float64)
        self._height, self._width = radiance.shape[:2]
        edges = np.cos(np.linspace(0.0, math.pi, self._height + 1))
        self._solid_angle = (edges[:-1] - edges[1:]) * (2.0 * math.pi / self._width)
        weights = (radiance @ _LUMINANCE) * self._solid_angle[:, None]
        self.mean_radiance = float(weights.sum() / (4.0 * math.pi))
        self.sampled = self.mean_radiance > 0.0 and _is_uneven(radiance @ _LUMINANCE, self._solid_angle)
        texels = np.zeros((self._height, self._width, 4), np.float32)
        texels[..., :3] = radiance
        if self.sampled:
            texels[..., 3] = weights / weights.sum() / self._solid_angle[:, None]
            self._alias = AliasTable(weights.ravel())
        self._texels = mi.Float(texels.ravel())
        self._edges = mi.Float(edges.astype(np.float32))

    def lookup(self, direction: mi.Vector3f, active: mi.Bool) -> tuple[mi.Color3f, mi.Float]:
        """Radiance from a direction, and the density of sampling it."""
        u = dr.atan2(direction.x, -direction.z) * (0.5 / math.pi) + 0.5
        v = dr.safe_acos(direction.y) * (1.0 / math.pi)
        x = dr.clip(mi.Int32(u * self._width), 0, self._width - 1)
        y = dr.clip(mi.Int32(v * self._height), 0, self._height - 1)
        texel = dr.gather(mi.Vector4f, self._texels, mi.UInt32(y * self._width + x), active)
        return mi.Color3f(texel.x, texel.y, texel.z), texel.w

    def backdrop(self, direction: mi.Vector3f, active: mi.Bool) -> mi.Color3f:
        """Radiance filtered between pixels, for rays straight from a camera."""
        x = (dr.atan2(direction.x, -direction.z) * (0.5 / math.pi) + 0.5) * self._width - 0.5
        y = dr.safe_acos(direction.y) * (self._height / math.pi) - 0.5
        x0, y0 = dr.floor(x), dr.floor(y)
        total = mi.Color3f(0.0)
        for j, wy in ((0.0, 1.0 - (y - y0)), (1.0, y - y0)):
            for i, wx in ((0.0, 1.0 - (x - x0)), (1.0, x - x0)):
                row = dr.clip(y0 + j, 0.0, self._height - 1.0)
                column = x0 + i
                column = dr.select(
                    column < 0.0, self._width - 1.0, dr.select(column < self._width, column, 0.0)
                )
                index = mi.UInt32(row) * self._width + mi.UInt32(column)
                texel = dr.gather(mi.Vector4f, self._texels, index, active)
                total += mi.Color3f(texel.x, texel.y, texel.z) * (wx * wy)
        return total

    def sample(self, u: mi.Point2f, active: mi.Bool) -> tuple[mi.Vector3f, mi.Color3f, mi.Float]:
        """A direction, its radiance and its density."""
        index, fresh = self._alias.sample(u.x, active)
        y = index // self._width
        x = index - y * self._width
        top = dr.gather(mi.Float, self._edges, y, active)
        bottom = dr.gather(mi.Float, self._edges, y + 1, active)
        cos_theta = dr.lerp(top, bottom, u.y)
        sin_theta = dr.safe_sqrt(1.0 - cos_theta * cos_theta)
        phi = ((mi.Float(x) + fresh) / self._width - 0.5) * (2.0 * math.pi)
        sin_phi, cos_phi = dr.sincos(phi)
        texel = dr.gather(mi.Vector4f, self._texels, index, active)
        direction = mi.Vector3f(sin_phi * sin_theta, cos_theta, -cos_phi * sin_theta)
        return direction, mi.Color3f(texel.x, texel.y, texel.z), texel.w


def _is_uneven(luminance: NDArray[np.float64], solid_angle: NDArray[np.float64]) -> bool:
    """Whether a map has anything that cosine-distributed rays alone would find too rarely."""
    weights = np.broadcast_to(solid_angle[:, None], luminance.shape)
    mean = np.average(luminance, weights=weights)
    return bool(np.average((luminance / mean) ** 2, weights=weights) > 3.0)


class EmissiveTriangles:
    """Area lights: triangles picked by power, points on them uniformly."""

    def __init__(self, mesh: MergedMesh, radiance: NDArray[np.float64]) -> None:
        corners = mesh.positions[mesh.indices].astype(np.float64)
        area = 0.5 * np.linalg.norm(
            np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1
        )
        power = area * (radiance @ _LUMINANCE)
        chosen = np.flatnonzero(power > 0.0)
        self._alias = AliasTable(power[chosen])
        self._triangle = mi.UInt32(chosen.astype(np.uint32))
        density = np.zeros(len(area), np.float32)
        density[chosen] = power[chosen] / power.sum() / area[chosen]
        self._density = mi.Float(density)

    def density(self, triangle: mi.UInt32, active: mi.Bool) -> mi.Float:
        """Density per area of picking a point of this triangle."""
        return dr.gather(mi.Float, self._density, triangle, active)

    def sample(self, u: mi.Point2f, active: mi.Bool) -> tuple[mi.UInt32, mi.Point2f, mi.Float]:
        """A triangle, a point on it and its density per area."""
        index, fresh = self._alias.sample(u.x, active)
        triangle = dr.gather(mi.UInt32, self._triangle, index, active)
        root = dr.sqrt(fresh)
        bary = mi.Point2f(root * (1.0 - u.y), root * u.y)
        return triangle, bary, self.density(triangle, active)


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
        window = dr.select(range_m < _FAR, dr.clip(1.0 - ratio, 0.0, 1.0), 1.0)
        cone = dr.clip(
            (dr.dot(-to_point, axis) - cos_outer) / dr.maximum(cos_inner - cos_outer, 1e-4), 0.0, 1.0
        )
        falloff = falloff * window * dr.select(kind == _SPOT, cone * cone, 1.0)
        irradiance = intensity * dr.select(directional, 1.0, falloff) * float(self.count)
        return direction, dr.select(directional, _FAR, distance * (1.0 - 1e-5)), irradiance


def _light_row(light: Light) -> list[float]:
    kind = {"directional": _DIRECTIONAL, "point": _POINT, "spot": _SPOT}[light.kind]
    cos_disc = math.cos(math.radians(light.angle_deg) / 2.0)
    row = [*light.position, kind, *light.direction, cos_disc, *light.intensity, light.range_m or 2.0 * _FAR]
    return [*row, math.cos(light.inner_cone_rad), math.cos(light.outer_cone_rad), 0.0, 0.0]


def _uniform_cone(cos_max: mi.Float, u: mi.Point2f) -> mi.Vector3f:
    """A direction about +Z, uniform in the cone."""
    cos_theta = 1.0 - u.x * (1.0 - cos_max)
    sin_theta = dr.safe_sqrt(1.0 - cos_theta * cos_theta)
    sin_phi, cos_phi = dr.sincos(2.0 * math.pi * u.y)
    return mi.Vector3f(cos_phi * sin_theta, sin_phi * sin_theta, cos_theta)


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
        result = LightSample(mi.Vector3f(0, 0, 1), mi.Float(_FAR), mi.Color3f(0.0), mi.Float(0.0))
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
            sample = LightSample(direction, mi.Float(_FAR), radiance / dr.maximum(pdf, 1e-20), pdf)
            result = dr.select(chosen, sample, result)
        return result

    def _sample_area(
        self, geometry: Geometry, emission, point: SurfacePoint, u: mi.Point2f, active: mi.Bool
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
