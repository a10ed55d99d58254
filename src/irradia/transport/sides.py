"""Surfaces that let light through diffusely: light from behind counts at the front, too.

Such a surface sends R·E/π of the light at its front and T·E′/π of the light behind it to the front.
An estimator picks one of the two sides, weighs it by the pick's probability, and then goes on as at
any opaque surface, turned round if need be. So light sampling and its weights know only one side.
"""

from __future__ import annotations

from dataclasses import dataclass

from irradia.transport.backend import dr, mi
from irradia.transport.geometry import Sides, SurfacePoint
from irradia.transport.sampling import Sampler


@dataclass
class OneSide:
    """A side picked.

    Attributes:
        point: The surface seen from there.
        weight: What its E/π is multiplied by, over the pick's probability.
    """

    point: SurfacePoint
    weight: mi.Color3f


def pick_side(point: SurfacePoint, sides: Sides, sampler: Sampler) -> OneSide:
    """Picks a side at random."""
    behind = sampler.next_2d().x < sides.p_behind
    sign = dr.select(behind, mi.Float(-1.0), 1.0)
    origin = dr.select(behind, sides.origin_behind, point.origin)
    chosen = SurfacePoint(point.position, origin, point.ng * sign, point.ns * sign, point.lod)
    share = dr.select(behind, sides.p_behind, 1.0 - sides.p_behind)
    weight = dr.select(behind, sides.behind, sides.front) / dr.maximum(share, 1e-6)
    return OneSide(chosen, weight)


def mirrored_to_front(direction: mi.Vector3f, normal: mi.Vector3f) -> mi.Vector3f:
    """A direction brought above the surface: light from behind leaves the front evenly, from nowhere."""
    below = dr.minimum(dr.dot(direction, normal), 0.0)
    return direction - 2.0 * below * normal
