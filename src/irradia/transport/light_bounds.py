"""Where light sources are, how strong, and where they shine: bounds of one source or of many.

This work is based on: Estevez and Kulla 2018, "Importance Sampling of Many Lights with Adaptive Tree
Splitting". Ours bounds places by spheres, which the importance needs anyway, and adds a reach, beyond
which KHR_lights_punctual's ``range`` lets nothing through.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, fields

import numpy as np
from numpy.typing import NDArray

from irradia.scene.types import IesProfile, Light

F64 = NDArray[np.float64]

UNBOUNDED_M = 1e30  # the reach of a light without range
_SLACK_RAD = 1e-3  # bounds stay bounds in float32


@dataclass(frozen=True)
class LightBounds:
    """One row a source, or a group of them.

    Attributes:
        centre, radius: (N, 3), (N,) sphere around them, metres.
        power: (N,) intensity where they shine most, candela-like, mean of the channels: all of
            them are to be equally free of noise.
        axis, spread: (N, 3), (N,) cone of the directions that they face; π for those that face all.
        falloff: (N,) angle from the nearest of those directions at which the last light leaves:
            π/2 for surfaces, whose light falls with the cosine.
        reach: (N,) metres beyond which they send nothing.
    """

    centre: F64
    radius: F64
    power: F64
    axis: F64
    spread: F64
    falloff: F64
    reach: F64

    def __len__(self) -> int:
        return len(self.power)

    def take(self, rows: NDArray) -> LightBounds:
        """Some rows, in this order."""
        return LightBounds(*(getattr(self, f.name)[rows] for f in fields(self)))

    def joined(self, other: LightBounds) -> LightBounds:
        """Both, one after the other."""
        pairs = ((getattr(self, f.name), getattr(other, f.name)) for f in fields(self))
        return LightBounds(*(np.concatenate(pair) for pair in pairs))


def bounds_of_lights(lights: Sequence[Light]) -> LightBounds:
    """Of points and spots: spheres that shine evenly in a cone, or by a profile."""
    power = [float(np.mean(light.intensity)) * _profile_strength(light.profile) for light in lights]
    return LightBounds(
        centre=np.array([light.position for light in lights], np.float64).reshape(-1, 3),
        radius=np.array([light.radius_m for light in lights], np.float64),
        power=np.array(power, np.float64),
        axis=_unit(np.array([light.direction for light in lights], np.float64).reshape(-1, 3)),
        spread=np.array([_spread(light) for light in lights], np.float64),
        falloff=np.full(len(lights), _SLACK_RAD),
        reach=np.array([light.range_m or UNBOUNDED_M for light in lights], np.float64),
    )


def bounds_of_triangles(
    corners: F64, radiance_times_area: F64, double_sided: NDArray[np.bool_]
) -> LightBounds:
    """Of emissive triangles (N, 3, 3), whose ``radiance_times_area`` is their candela head-on."""
    centre = corners.mean(axis=1)
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    return LightBounds(
        centre=centre,
        radius=np.linalg.norm(corners - centre[:, None], axis=2).max(axis=1),
        power=np.asarray(radiance_times_area, np.float64),
        axis=_unit(normal),
        spread=np.where(double_sided, math.pi, _SLACK_RAD),
        falloff=np.full(len(corners), math.pi / 2),
        reach=np.full(len(corners), UNBOUNDED_M),
    )


def bounds_of_groups(sources: LightBounds, starts: NDArray[np.int64]) -> LightBounds:
    """Of runs of rows, each from one of ``starts`` up to the next."""
    group = np.repeat(np.arange(len(starts)), np.diff([*starts, len(sources)]))
    low = np.minimum.reduceat(sources.centre - sources.radius[:, None], starts)
    high = np.maximum.reduceat(sources.centre + sources.radius[:, None], starts)
    centre = (low + high) / 2
    distance = np.linalg.norm(sources.centre - centre[group], axis=1)
    axis = _unit(np.add.reduceat(sources.axis * sources.power[:, None], starts))
    tilt = np.arccos(np.clip(np.einsum("nk,nk->n", sources.axis, axis[group]), -1.0, 1.0))
    spread = np.maximum.reduceat(tilt + sources.spread, starts)
    return LightBounds(
        centre=centre,
        radius=np.maximum.reduceat(distance + sources.radius, starts),
        power=np.add.reduceat(sources.power, starts),
        axis=axis,
        spread=np.minimum(spread, math.pi),
        falloff=np.maximum.reduceat(sources.falloff, starts),
        reach=np.maximum.reduceat(sources.reach, starts),
    )


def _spread(light: Light) -> float:
    """Half-angle of the cone that holds all of a light's directions."""
    if light.profile is not None:
        lit = np.flatnonzero(light.profile.candela.max(axis=1) > 0.0)
        last = (lit[-1] + 1) / (len(light.profile.candela) - 1) if len(lit) else 0.0
        return min(math.pi * last + _SLACK_RAD, math.pi)
    return light.outer_cone_rad + _SLACK_RAD if light.kind == "spot" else math.pi


def _profile_strength(profile: IesProfile | None) -> float:
    """Mean candela over the directions that are lit at all; 1 without a profile."""
    if profile is None:
        return 1.0
    theta = np.linspace(0.0, math.pi, len(profile.candela))
    mean = profile.candela[:, :-1].mean(axis=1)
    weight = np.sin(theta) * (profile.candela.max(axis=1) > 0.0)
    return float((mean * weight).sum() / max(weight.sum(), 1e-9))


def _unit(vectors: F64) -> F64:
    """Unit vectors; −Z for those that have no length."""
    length = np.linalg.norm(vectors, axis=1, keepdims=True)
    return np.where(length > 0.0, vectors / np.where(length > 0.0, length, 1.0), (0.0, 0.0, -1.0))
