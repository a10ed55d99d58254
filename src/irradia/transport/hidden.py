"""Sub-samples inside solids: found by what their rays meet, and replaced.

A texel at the foot of a wall reaches under it. Its hidden part would darken it, and where solids
overlap, light would wander from texel to texel through their inside. So a hidden sub-sample is replaced
by a visible one of its texel; a texel that has none is hidden altogether. A sub-sample is hidden

- where most of its rays first meet the back of a solid, or
- where its rays leave solids once more than they enter them: in the crease between two slabs, deep
  inside a third, half of all rays meet fronts first, and these tell nothing.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from irradia.transport.backend import dr, mi
from irradia.transport.geometry import SurfacePoint
from irradia.transport.materials import DOUBLE_SIDED, FILTERS, TRANSLUCENT, UNLIT
from irradia.transport.sampling import Sampler, cosine_hemisphere, to_world
from irradia.transport.subsamples import Subsamples
from irradia.transport.texel_grid import TexelGrid
from irradia.transport.world import World

# Rays in all after each round, and how many backs among them leave no doubt either way.
_ROUNDS = ((4, 0, 4), (16, 3, 13), (64, 32, 33))
_MOST_RAYS = 64
# Rays in all after each round, and how many must find themselves inside; few texels need the second.
_INSIDE_ROUNDS = ((2, 2), (16, 14))
_PROBES = np.array([[1, 2, 4, 7], [0, 3, 5, 6]], np.uint32)  # of even and odd texels
_FEW_TEXELS = 1 << 20  # up to here every sub-sample is looked at
_MOST_CROSSINGS = 64  # of solids' surfaces along one ray
_NO_SOLID = DOUBLE_SIDED | FILTERS | TRANSLUCENT | UNLIT  # sheets, and domes with a picture of the sky
_SEED = 0x51DE  # the directions are fixed: they decide on places, not on light


def drop_hidden(world: World, subsamples: Subsamples, grid: TexelGrid | None = None) -> NDArray[np.float32]:
    """Replaces hidden sub-samples by others of their texel.

    Args:
        world: The scene.
        subsamples: Changed in place.
        grid: Where texels lie. With it, four probes in each of many texels and a look at the neighbours
            of what they find do for a first ray from every sub-sample. What is hidden and much smaller
            than a texel may then go unseen.

    Returns:
        (N,) share of each texel's sub-samples that are hidden; 1 where none is left.
    """
    share = np.zeros(subsamples.n_texels, np.float32)
    texel = np.arange(subsamples.n_texels)
    if grid and subsamples.n_texels > _FEW_TEXELS:
        texel = grid.with_neighbours(np.flatnonzero(_probe(world, subsamples)))
    if len(texel) == 0:
        return share
    suspect = _unpack(_first_backs(world, subsamples, mi.UInt32(texel.astype(np.uint32))), subsamples.count)
    hidden = suspect & suspect.all(axis=1)[:, None]
    _look_closely(world, subsamples, texel, suspect, hidden)
    _look_around(world, subsamples, texel, hidden, grid)
    mixed = hidden.any(axis=1) & ~hidden.all(axis=1)
    repeat_in_turn(subsamples, texel[mixed], hidden[mixed])
    share[texel] = hidden.mean(axis=1, dtype=np.float32)
    return share


def _look_closely(
    world: World,
    subsamples: Subsamples,
    texel: NDArray[np.int64],
    suspect: NDArray[np.bool_],
    hidden: NDArray[np.bool_],
) -> None:
    """More rays where some of a texel's met backs: adds to ``hidden`` (K, S)."""
    partly = suspect & ~hidden
    hidden[partly] = _mostly_meet_backs(world, subsamples, *_lanes(texel, partly))
    others = ~suspect & hidden.any(axis=1)[:, None]
    hidden[others] = _mostly_meet_backs(world, subsamples, *_lanes(texel, others))


def _look_around(
    world: World,
    subsamples: Subsamples,
    texel: NDArray[np.int64],
    hidden: NDArray[np.bool_],
    grid: TexelGrid | None,
) -> None:
    """Finds what lies inside a solid beside what does: adds to ``hidden`` (K, S), texels (K,) ascending."""
    near = hidden.any(axis=1)
    if grid:
        near = np.isin(texel, grid.with_neighbours(texel[near]))
    visible = ~hidden & near[:, None]
    hidden[visible] = _lie_inside(world, subsamples, *_lanes(texel, visible))


def _lanes(texel: NDArray[np.int64], chosen: NDArray[np.bool_]) -> tuple[NDArray[np.uint32], ...]:
    """Texel and number of the chosen sub-samples (K, S)."""
    row, number = np.nonzero(chosen)
    return texel[row].astype(np.uint32), number.astype(np.uint32)


def _mostly_meet_backs(
    world: World, subsamples: Subsamples, texel: NDArray[np.uint32], number: NDArray[np.uint32]
) -> NDArray[np.bool_]:
    """(L,) whether most rays of a sub-sample first meet a back; more rays where in doubt."""
    hidden = np.zeros(len(texel), np.bool_)
    unsure, backs, done = np.arange(len(texel)), np.zeros(len(texel), np.float32), 0
    for n_rays, few, many in _ROUNDS:
        if len(unsure) == 0:
            break
        lanes = mi.UInt32(texel[unsure]), mi.UInt32(number[unsure])
        backs = backs + np.array(_count_backs(world, subsamples, *lanes, done, n_rays))
        done = n_rays
        hidden[unsure] = backs >= many
        doubtful = (backs > few) & (backs < many)
        unsure, backs = unsure[doubtful], backs[doubtful]
    return hidden


def _lie_inside(
    world: World, subsamples: Subsamples, texel: NDArray[np.uint32], number: NDArray[np.uint32]
) -> NDArray[np.bool_]:
    """(L,) whether nearly all rays of a sub-sample leave a solid that they never entered.

    And whether one at least meets a back first: a sky dome whose fronts look outward is a solid too, and
    all the world lies inside it.
    """
    inside = np.zeros(len(texel), np.bool_)
    unsure, done = np.arange(len(texel)), 0
    votes, backs = np.zeros((2, len(texel)), np.float32)
    for n_rays, needed in _INSIDE_ROUNDS:
        if len(unsure) == 0:
            break
        lanes = mi.UInt32(texel[unsure]), mi.UInt32(number[unsure])
        more = _count_inside(world, subsamples, *lanes, done, n_rays)
        votes, backs = votes + np.array(more[0]), backs + np.array(more[1])
        done = n_rays
        likely = votes >= needed
        inside[unsure] = likely & (backs > 0)
        unsure, votes, backs = unsure[likely], votes[likely], backs[likely]
    return inside


@dr.syntax
def _probe(world: World, subsamples: Subsamples) -> NDArray[np.bool_]:
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
def _first_backs(world: World, subsamples: Subsamples, texel: mi.UInt32) -> NDArray[np.uint32]:
    """(K,) a bit for every sub-sample: whether one ray from it meets a back."""
    bits, number = dr.zeros(mi.UInt32, dr.width(texel)), mi.UInt32(0)
    last = dr.opaque(mi.UInt32, subsamples.count)
    while number < last:
        met = _meets_back(world, subsamples.point(world, texel, number), number)
        bits |= dr.select(met, mi.UInt32(1) << number, 0)
        number += 1
    return np.array(bits)


def _unpack(bits: NDArray[np.uint32], count: int) -> NDArray[np.bool_]:
    """(K, S) from bits (K,)."""
    result = np.empty((len(bits), count), np.bool_)
    for number in range(count):
        result[:, number] = bits & np.uint32(1 << number)
    return result


@dr.syntax
def _count_backs(
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
def _count_inside(
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


def repeat_in_turn(subsamples: Subsamples, texel: NDArray[np.int64], dropped: NDArray[np.bool_]) -> None:
    """Overwrites dropped sub-samples (K, S) by the others of their texels (K,), which are not all dropped."""
    kept_first = np.argsort(dropped, axis=1, kind="stable").astype(np.uint32)
    n_kept = (~dropped).sum(axis=1)
    texel = texel.astype(np.uint32)
    for number in range(subsamples.count):
        wanting = np.flatnonzero(dropped[:, number])
        if len(wanting):
            source = kept_first[wanting, number % n_kept[wanting]]
            target = dr.opaque(mi.UInt32, number)
            subsamples.copy(mi.UInt32(texel[wanting]), mi.UInt32(source), target)
