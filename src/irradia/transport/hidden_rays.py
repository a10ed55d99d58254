"""Rays that find out whether a place lies inside a solid."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from irradia.transport.backend import dr, mi
from irradia.transport.geometry import SurfacePoint
from irradia.transport.materials import DOUBLE_SIDED, FILTERS, TRANSLUCENT, UNLIT
from irradia.transport.sampling import Sampler, cosine_hemisphere, to_world
from irradia.transport.subsamples import Subsamples
from irradia.transport.world import World

_PROBES = np.array([[1, 2, 4, 7], [0, 3, 5, 6]], np.uint32)  # of even and odd texels
_MOST_RAYS = 64  # of a sub-sample
_MOST_CROSSINGS = 64  # of solids' surfaces along one ray
_NO_SOLID = DOUBLE_SIDED | FILTERS | TRANSLUCENT | UNLIT  # sheets, and domes with a picture of the sky
_SEED = 0x51DE  # the directions are fixed: they decide on places, not on light


@dr.syntax
def probe(world: World, subsamples: Subsamples) -> NDArray[np.bool_]:
    """(N,) whether a ray from either of two sub-samples meets a back."""
    texel = dr.arange(mi.UInt32, subsamples.n_texels)
    table = mi.UInt32(_PROBES.ravel() % subsamples.count)
    met = mi.Bool(False)
    k, last = mi.UInt32(0), dr.opaque(mi.UInt32, _PROBES.shape[1])
    while k < last:
        number = dr.gather(mi.UInt32, table, (texel & 1) * _PROBES.shape[1] + k)
        met |= _meets_back(world, subsamples.point(world, texel, number), number)
        k += 1
    return np.array(met & (texel < subsamples.n_texels))


@dr.syntax
def first_backs(world: World, subsamples: Subsamples, texel: mi.UInt32) -> NDArray[np.uint32]:
    """(K,) a bit for every sub-sample: whether one ray from it meets a back."""
    bits, number = dr.zeros(mi.UInt32, dr.width(texel)), mi.UInt32(0)
    last = dr.opaque(mi.UInt32, subsamples.count)
    while number < last:
        met = _meets_back(world, subsamples.point(world, texel, number), number)
        bits |= dr.select(met, mi.UInt32(1) << number, 0)
        number += 1
    return np.array(bits)


@dr.syntax
def count_backs(
    world: World, subsamples: Subsamples, texel: mi.UInt32, number: mi.UInt32, begin: int, end: int
) -> mi.Float:
    """How many of a sub-sample's rays ``begin`` to ``end`` meet a back first."""
    backs = dr.zeros(mi.Float, dr.width(texel))
    k, last = dr.opaque(mi.UInt32, begin), dr.opaque(mi.UInt32, end)
    point = subsamples.point(world, texel, number)
    while k < last:
        backs += dr.select(_meets_back(world, point, number * _MOST_RAYS + k), 1.0, 0.0)
        k += 1
    dr.eval(backs)
    return backs


@dr.syntax
def count_inside(
    world: World, subsamples: Subsamples, texel: mi.UInt32, number: mi.UInt32, begin: int, end: int
) -> tuple[mi.Float, mi.Float]:
    """How many of a sub-sample's rays leave a solid that they never entered, and meet a back first.

    A ray is followed only until it does: what comes later may be open, like the ground, and tells nothing.
    """
    inside, backs = dr.zeros(mi.Float, dr.width(texel)), dr.zeros(mi.Float, dr.width(texel))
    k, last = dr.opaque(mi.UInt32, begin), dr.opaque(mi.UInt32, end)
    point = subsamples.point(world, texel, number)
    while k < last:
        direction, above = _direction(point, number * _MOST_RAYS + k)
        origin, active = mi.Point3f(point.origin), mi.Bool(above)
        left, crossings = mi.Int32(0), mi.UInt32(0)
        while active:
            hit = world.geometry.intersect(origin, direction, active, point.lod)
            active &= hit.valid
            record = world.record(hit.triangle, hit.bary, active)
            solid = active & ((record.flags & _NO_SOLID) == 0)
            back = solid & (dr.dot(record.ng, direction) > 0.0)
            backs += dr.select(back & (crossings == 0), 1.0, 0.0)
            left += dr.select(back, mi.Int32(1), dr.select(solid, mi.Int32(-1), 0))
            origin = mi.Point3f(world.geometry.step_past(origin, direction, hit.t))
            crossings += 1
            active &= (left <= 0) & (crossings < _MOST_CROSSINGS)
        inside += dr.select(left > 0, 1.0, 0.0)
        k += 1
    dr.eval(inside, backs)
    return inside, backs


def _meets_back(world: World, point: SurfacePoint, ray: mi.UInt32) -> mi.Bool:
    """Whether one ray from a place first meets a back."""
    direction, above = _direction(point, ray)
    return world.meets_back(point.origin, direction, above, point.lod)


def _direction(point: SurfacePoint, ray: mi.UInt32) -> tuple[mi.Vector3f, mi.Bool]:
    """Direction of a ray, and whether it leaves the surface.

    All texels draw the same directions about their normals, which keeps rays coherent.
    """
    u = Sampler(mi.UInt32(ray), mi.UInt32(_SEED)).next_2d()
    direction = to_world(point.ns, cosine_hemisphere(u))
    return direction, dr.dot(direction, point.ng) > 0.0
