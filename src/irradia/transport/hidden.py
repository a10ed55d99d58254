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
from irradia.transport.hidden_rays import count_backs, count_inside, first_backs, probe
from irradia.transport.subsamples import Subsamples
from irradia.transport.texel_grid import TexelGrid
from irradia.transport.world import World

# Rays in all after each round, and how many backs among them leave no doubt either way.
_ROUNDS = ((4, 0, 4), (16, 3, 13), (64, 32, 33))
# Rays in all after each round, and how many must find themselves inside; few texels need the second.
_INSIDE_ROUNDS = ((2, 2), (16, 14))
_FEW_TEXELS = 1 << 20  # up to here every sub-sample is looked at


def drop_hidden(world: World, subsamples: Subsamples, grid: TexelGrid) -> NDArray[np.float32]:
    """Replaces hidden sub-samples by others of their texel.

    Args:
        world: The scene.
        subsamples: Changed in place.
        grid: Where texels lie. Where they are many, four probes in each and a look at the neighbours of
            what they find do for a first ray from every sub-sample. What is hidden and much smaller than
            a texel may then go unseen.

    Returns:
        (N,) share of each texel's sub-samples that are hidden; 1 where none is left.
    """
    share = np.zeros(subsamples.n_texels, np.float32)
    texel = np.arange(subsamples.n_texels)
    if subsamples.n_texels > _FEW_TEXELS:
        texel = grid.with_neighbours(np.flatnonzero(probe(world, subsamples)))
    if len(texel) == 0:
        return share
    suspect = _unpack(first_backs(world, subsamples, mi.UInt32(texel.astype(np.uint32))), subsamples.count)
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
    grid: TexelGrid,
) -> None:
    """Finds what lies inside a solid beside what does: adds to ``hidden`` (K, S), texels (K,) ascending."""
    near = np.isin(texel, grid.with_neighbours(texel[hidden.any(axis=1)]))
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
        backs = backs + np.array(count_backs(world, subsamples, *lanes, done, n_rays))
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
        more = count_inside(world, subsamples, *lanes, done, n_rays)
        votes, backs = votes + np.array(more[0]), backs + np.array(more[1])
        done = n_rays
        likely = votes >= needed
        inside[unsure] = likely & (backs > 0)
        unsure, votes, backs = unsure[likely], votes[likely], backs[likely]
    return inside


def _unpack(bits: NDArray[np.uint32], count: int) -> NDArray[np.bool_]:
    """(K, S) from bits (K,)."""
    result = np.empty((len(bits), count), np.bool_)
    for number in range(count):
        result[:, number] = bits & np.uint32(1 << number)
    return result


def repeat_in_turn(subsamples: Subsamples, texel: NDArray[np.int64], dropped: NDArray[np.bool_]) -> None:
    """Overwrites dropped sub-samples (K, S) by the others of their texels (K,), which are not all dropped."""
    kept_first = np.argsort(dropped, axis=1, kind="stable").astype(np.uint32)
    n_kept = (~dropped).sum(axis=1)
    for number in range(subsamples.count):
        wanting = np.flatnonzero(dropped[:, number])
        if len(wanting):
            source = kept_first[wanting, number % n_kept[wanting]]
            target = dr.opaque(mi.UInt32, number)
            subsamples.copy(mi.UInt32(texel[wanting].astype(np.uint32)), mi.UInt32(source), target)
