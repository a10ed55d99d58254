"""What stands between the two sides of a texel, or between one texel and the next.

The floor under a thin wall is one chart, and no texel of it may lie wholly inside the wall. Still the
light on one side says nothing of the other.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from irradia.transport.backend import dr, mi
from irradia.transport.hidden import repeat_in_turn
from irradia.transport.subsamples import Subsamples
from irradia.transport.texel_grid import PRECEDING, TexelGrid
from irradia.transport.world import World


def take_one_side(
    world: World, subsamples: Subsamples, hidden_share: NDArray[np.float32], grid: TexelGrid
) -> NDArray[np.uint32]:
    """Leaves texels that something divides the sub-samples of their larger part.

    Args:
        world: The scene.
        subsamples: Hidden ones already replaced; changed in place.
        hidden_share: (N,) from :func:`irradia.transport.hidden.drop_hidden`.
        grid: Where texels lie.

    Returns:
        (K,) the divided texels, ascending.
    """
    texel = _partly_hidden_and_beside(hidden_share, grid)
    if len(texel) == 0:
        return np.zeros(0, np.uint32)
    sees = _sight_within(world, subsamples, texel)
    divided = ~sees.all(axis=(1, 2))
    texel, sees = texel[divided], sees[divided]
    for _ in range(3):  # each step doubles the length of ways, and eight places need seven steps at most
        sees = np.einsum("kij,kjl->kil", sees, sees)
    largest = sees.sum(axis=2).argmax(axis=1)
    kept = sees[np.arange(len(texel)), largest]
    divided = ~kept.all(axis=1)
    repeat_in_turn(subsamples, texel[divided], ~kept[divided])
    return texel[divided].astype(np.uint32)


def _sight_within(world: World, subsamples: Subsamples, texel: NDArray[np.int64]) -> NDArray[np.bool_]:
    """(K, S, S) which sub-samples of each texel see each other."""
    count = subsamples.count
    sees = np.ones((len(texel), count, count), np.bool_)
    lanes = mi.UInt32(texel.astype(np.uint32))
    for one in range(count - 1):
        for other in range(one + 1, count):
            numbers = (dr.opaque(mi.UInt32, number) for number in (one, other))
            free = np.array(_way_is_free(world, subsamples, (lanes, lanes), *numbers))
            sees[:, one, other] = sees[:, other, one] = free
    return sees


def cut_off(
    world: World, subsamples: Subsamples, hidden_share: NDArray[np.float32], grid: TexelGrid
) -> NDArray[np.uint8]:
    """Finds neighbours with something between them, among texels hidden in part.

    Args:
        world: The scene.
        subsamples: Hidden ones already replaced.
        hidden_share: (N,) from :func:`irradia.transport.hidden.drop_hidden`.
        grid: Where texels lie.

    Returns:
        (N,) a bit for each of the texel's four preceding neighbours, in the order of PRECEDING: set
        where no sub-sample sees its counterpart.
    """
    bits = np.zeros(subsamples.n_texels, np.uint8)
    partly = _partly_hidden_and_beside(hidden_share, grid)
    for k, step in enumerate(PRECEDING):
        beside = grid.neighbour(partly, step)
        there = (beside >= 0) & (hidden_share[beside] < 1.0)
        there &= (hidden_share[partly] > 0.0) | (hidden_share[beside] > 0.0)
        if there.any():
            pair = (mi.UInt32(side[there].astype(np.uint32)) for side in (partly, beside))
            apart = ~np.array(_see_each_other(world, subsamples, *pair))
            bits[partly[there][apart]] |= np.uint8(1 << k)
    return bits


def _partly_hidden_and_beside(hidden_share: NDArray[np.float32], grid: TexelGrid) -> NDArray[np.int64]:
    """Texels hidden in part and visible ones that touch them."""
    texel = grid.with_neighbours(np.flatnonzero((hidden_share > 0.0) & (hidden_share < 1.0)))
    return texel[hidden_share[texel] < 1.0]


@dr.syntax
def _see_each_other(world: World, subsamples: Subsamples, one: mi.UInt32, other: mi.UInt32) -> mi.Bool:
    """Whether the way is free between any two sub-samples of the same number of two texels."""
    sees, number = dr.zeros(mi.Bool, dr.width(one)), mi.UInt32(0)
    count = dr.opaque(mi.UInt32, subsamples.count)
    while (number < count) & ~sees:
        sees |= _way_is_free(world, subsamples, (one, other), number, number)
        number += 1
    dr.eval(sees)
    return sees


def _way_is_free(
    world: World,
    subsamples: Subsamples,
    texels: tuple[mi.UInt32, mi.UInt32],
    one: mi.UInt32,
    other: mi.UInt32,
) -> mi.Bool:
    """Whether nothing lies between sub-sample ``one`` of the first texel and ``other`` of the second."""
    start, end = subsamples.point(world, texels[0], one), subsamples.point(world, texels[1], other)
    way = end.origin - start.origin
    distance = dr.norm(way)
    near = distance <= 0.0
    direction = way / dr.select(near, 1.0, distance)
    return near | ~world.geometry.occluded(start.origin, direction, distance, ~near, start.lod)
