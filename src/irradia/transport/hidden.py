"""Sub-samples inside solids: found by the back faces that they see, and replaced.

A texel at the foot of a wall reaches under it. Its hidden part would darken it, and where solids
overlap, light would wander from texel to texel through their inside. So a hidden sub-sample, one
whose rays mostly meet back faces first, is replaced by a visible one of its texel; a texel that
has none is invalid.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from irradia.transport.backend import dr, mi
from irradia.transport.sampling import Sampler, cosine_hemisphere, to_world
from irradia.transport.subsamples import Subsamples
from irradia.transport.world import World

# Rays in all after each round, and how many backs among them leave no doubt either way.
_ROUNDS = ((4, 0, 4), (16, 3, 13), (64, 32, 33))
_SEED = 0x51DE  # the directions are fixed: they decide on places, not on light


def drop_hidden(world: World, subsamples: Subsamples) -> NDArray[np.float32]:
    """Replaces hidden sub-samples by others of their texel.

    One ray from every sub-sample finds the suspects. Where all of a texel's rays met backs, it is
    hidden; where some did, their sub-samples are looked at closely, and where that confirms one,
    the texel's others as well.

    Returns:
        (N,) share of each texel's sub-samples that are hidden; 1 makes the texel invalid.
    """
    suspect = _first_round(world, subsamples)
    hidden = np.zeros_like(suspect)
    hidden[suspect.all(axis=1)] = True
    partly = suspect & ~hidden
    hidden[partly] = _are_hidden(world, subsamples, partly)
    neighbours = ~suspect & (hidden.any(axis=1) & ~hidden.all(axis=1))[:, None]
    hidden[neighbours] = _are_hidden(world, subsamples, neighbours)
    _repeat_visible(subsamples, hidden)
    return hidden.mean(axis=1, dtype=np.float32)


def _first_round(world: World, subsamples: Subsamples) -> NDArray[np.bool_]:
    """(N, S) whether a single ray from each sub-sample meets a back face."""
    texel = dr.arange(mi.UInt32, subsamples.n_texels)
    suspect = np.empty((subsamples.n_texels, subsamples.count), np.bool_)
    for number in range(subsamples.count):
        place = dr.opaque(mi.UInt32, number)
        backs = _count_backs(world, subsamples, texel, place, dr.opaque(mi.UInt32, number), 1)
        suspect[:, number] = np.array(backs) > 0.0
    return suspect


def _are_hidden(world: World, subsamples: Subsamples, places: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Whether the sub-samples chosen by a mask (N, S) mostly see backs; more rays where in doubt."""
    texel, number = (index.astype(np.uint32) for index in np.nonzero(places))
    hidden = np.zeros(len(texel), np.bool_)
    unsure, backs, done = np.arange(len(texel)), np.zeros(len(texel), np.float32), 0
    for n_rays, few, many in _ROUNDS:
        if len(unsure) == 0:
            break
        lanes = mi.UInt32(texel[unsure]), mi.UInt32(number[unsure])
        first = lanes[1] * _ROUNDS[-1][0] + dr.opaque(mi.UInt32, done)
        backs = backs + np.array(_count_backs(world, subsamples, *lanes, first, n_rays - done))
        done = n_rays
        hidden[unsure] = backs >= many
        doubtful = (backs > few) & (backs < many)
        unsure, backs = unsure[doubtful], backs[doubtful]
    return hidden


@dr.syntax
def _count_backs(
    world: World, subsamples: Subsamples, texel: mi.UInt32, number: mi.UInt32, first: mi.UInt32, n_rays: int
) -> mi.Float:
    """How many rays from a sub-sample meet a back face first.

    All texels draw the same directions about their normals, which keeps rays coherent.
    """
    point = subsamples.point(world, texel, number)
    backs = dr.zeros(mi.Float, dr.width(texel))
    k, last = mi.UInt32(first), first + dr.opaque(mi.UInt32, n_rays)
    while k < last:
        u = Sampler(mi.UInt32(k), mi.UInt32(_SEED)).next_2d()
        direction = to_world(point.ns, cosine_hemisphere(u))
        above = dr.dot(direction, point.ng) > 0.0
        backs += dr.select(world.meets_back(point.origin, direction, above), 1.0, 0.0)
        k += 1
    dr.eval(backs)
    return backs


def _repeat_visible(subsamples: Subsamples, hidden: NDArray[np.bool_]) -> None:
    """Overwrites hidden sub-samples (N, S) by visible ones of their texels, in turn."""
    texel = np.flatnonzero(hidden.any(axis=1) & ~hidden.all(axis=1)).astype(np.uint32)
    hidden = hidden[texel]
    visible_first = np.argsort(hidden, axis=1, kind="stable").astype(np.uint32)
    n_visible = (~hidden).sum(axis=1)
    for number in range(subsamples.count):
        wanting = np.flatnonzero(hidden[:, number])
        if len(wanting):
            source = visible_first[wanting, number % n_visible[wanting]]
            target = dr.opaque(mi.UInt32, number)
            subsamples.copy(mi.UInt32(texel[wanting]), mi.UInt32(source), target)
