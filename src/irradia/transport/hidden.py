"""Sub-samples inside solids: found by the back faces that they see, and replaced.

A texel at the foot of a wall reaches under it. Its hidden part would darken it, and where solids
overlap, light would wander from texel to texel through their inside. So a hidden sub-sample is
replaced by a visible one of its texel; a texel that has none is invalid.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from irradia.transport.backend import dr, mi
from irradia.transport.sampling import Sampler, cosine_hemisphere, to_world
from irradia.transport.subsamples import Subsamples
from irradia.transport.world import World

_RAYS = 8  # from each sub-sample of a suspect
_MORE_RAYS = 56  # where those disagree
_SEED = 0x51DE  # the directions are fixed: they decide on places, not on light


def drop_hidden(world: World, subsamples: Subsamples) -> NDArray[np.float32]:
    """Replaces hidden sub-samples, those whose rays mostly meet back faces first.

    Texels of which no ray in one round over the sub-samples met a back face are not looked at
    again.

    Returns:
        (N,) share of each texel's sub-samples that are hidden; 1 makes the texel invalid.
    """
    hidden_share = np.zeros(subsamples.n_texels, np.float32)
    every = dr.arange(mi.UInt32, subsamples.n_texels)
    suspects = dr.compress(_count_backs(world, subsamples, every, mi.UInt32(0), subsamples.count, 1) > 0.0)
    if dr.width(suspects) == 0:
        return hidden_share
    hidden = np.stack([_is_hidden(world, subsamples, suspects, n) for n in range(subsamples.count)])
    hidden_share[np.array(suspects)] = hidden.mean(axis=0)
    _repeat_visible(subsamples, np.array(suspects), hidden)
    return hidden_share


def _is_hidden(world: World, subsamples: Subsamples, texel: mi.UInt32, number: int) -> NDArray[np.bool_]:
    """Whether one sub-sample of each texel mostly sees back faces: few rays, more where they disagree."""
    per_subsample = _RAYS + _MORE_RAYS
    first = dr.opaque(mi.UInt32, number * per_subsample)
    backs = np.array(_count_backs(world, subsamples, texel, first, _RAYS, per_subsample))
    hidden = backs > 0.5 * _RAYS
    unsure = np.flatnonzero((backs > 1) & (backs < _RAYS))
    if len(unsure):
        some = mi.UInt32(np.array(texel)[unsure])
        backs[unsure] += np.array(
            _count_backs(world, subsamples, some, first + _RAYS, _MORE_RAYS, per_subsample)
        )
        hidden[unsure] = backs[unsure] > 0.5 * per_subsample
    return hidden


@dr.syntax
def _count_backs(
    world: World,
    subsamples: Subsamples,
    texel: mi.UInt32,
    first: mi.UInt32,
    n_rays: int,
    per_subsample: int,
) -> mi.Float:
    """How many of rays ``first`` to ``first + n_rays`` meet a back face first.

    Ray k starts from sub-sample k / per_subsample. All texels draw the same directions about their
    normals, which keeps rays coherent.
    """
    backs = dr.zeros(mi.Float, dr.width(texel))
    k, last = mi.UInt32(first), first + dr.opaque(mi.UInt32, n_rays)
    while k < last:
        point = subsamples.point(world, texel, k // per_subsample)
        u = Sampler(mi.UInt32(k), mi.UInt32(_SEED)).next_2d()
        direction = to_world(point.ns, cosine_hemisphere(u))
        above = dr.dot(direction, point.ng) > 0.0
        backs += dr.select(world.meets_back(point.origin, direction, above), 1.0, 0.0)
        k += 1
    dr.eval(backs)
    return backs


def _repeat_visible(subsamples: Subsamples, texel: NDArray[np.uint32], hidden: NDArray[np.bool_]) -> None:
    """Overwrites the hidden sub-samples (S, M) of texels (M,) by their visible ones, in turn."""
    visible_first = np.argsort(hidden, axis=0, kind="stable").astype(np.uint32)
    n_visible = (~hidden).sum(axis=0)
    for number in range(subsamples.count):
        wanting = hidden[number] & (n_visible > 0)
        if wanting.any():
            turn = number % n_visible[wanting]
            source = visible_first[turn, np.flatnonzero(wanting)]
            target = dr.opaque(mi.UInt32, number)
            subsamples.copy(mi.UInt32(texel[wanting]), mi.UInt32(source), target)
