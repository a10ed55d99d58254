"""Texels that lie inside something altogether, but touch one that doesn't.

Filtering reads them along the line where a floor meets a wall. There they should hold what the floor
receives at that very line, so they are moved out: they take the nearest places of the visible texels
beside them. No ray has to find the way, so none can find a wrong one: places stay on the chart, go no
farther than to the next texel, and never cross what hides the texel.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from irradia.transport.backend import dr, mi
from irradia.transport.subsamples import Subsamples
from irradia.transport.texel_grid import AROUND, TexelGrid
from irradia.transport.world import World

_NONE = 0xFFFFFFFF


def move_out(
    world: World, subsamples: Subsamples, hidden_share: NDArray[np.float32], grid: TexelGrid
) -> NDArray[np.uint32]:
    """Gives hidden texels places of the visible texels beside them.

    Args:
        world: The scene.
        subsamples: Changed in place.
        hidden_share: (N,) from :func:`irradia.transport.hidden.drop_hidden`.
        grid: Where texels lie.

    Returns:
        (K, 2) texels that were moved, ascending, and those that they stand for now.
    """
    texel = np.flatnonzero(hidden_share == 1.0)
    beside = _visible_beside(texel, hidden_share, grid)
    reached = (beside != _NONE).any(axis=1)
    texel, beside = texel[reached], beside[reached]
    if len(texel) == 0:
        return np.zeros((0, 2), np.uint32)
    lanes = mi.UInt32(texel.astype(np.uint32))
    source = _nearest_texel(world, subsamples, lanes, beside)
    nearest = []
    nearest = []
    for number in range(subsamples.count):
        place = subsamples.point(world, lanes, dr.opaque(mi.UInt32, number)).position
        nearest.append(_nearest_place(world, subsamples, source, place))
    subsamples.move(lanes, source, nearest)
    return np.stack([texel.astype(np.uint32), np.array(source)], axis=1)


def _visible_beside(
    texel: NDArray[np.int64], hidden_share: NDArray[np.float32], grid: TexelGrid
) -> NDArray[np.uint32]:
    """(K, 8) neighbours of texels that aren't hidden, or _NONE."""
    columns = []
    for step in AROUND:
        beside = grid.neighbour(texel, step)
        visible = (beside >= 0) & (hidden_share[beside] < 1.0)
        columns.append(np.where(visible, beside, _NONE).astype(np.uint32))
    return np.stack(columns, axis=1)


@dr.syntax
def _nearest_texel(
    world: World, subsamples: Subsamples, texel: mi.UInt32, beside: NDArray[np.uint32]
) -> mi.UInt32:
    """Which neighbour has the place nearest to the middle of each texel's own."""
    middle, number = mi.Point3f(0.0), mi.UInt32(0)
    count, width = dr.opaque(mi.UInt32, subsamples.count), dr.opaque(mi.UInt32, beside.shape[1])
    while number < count:
        middle += subsamples.point(world, texel, number).position / subsamples.count
        number += 1
    table, row = mi.UInt32(beside.ravel()), dr.arange(mi.UInt32, len(beside))
    best, least, k = mi.UInt32(_NONE), mi.Float(dr.inf), mi.UInt32(0)
    while k < width * count:
        other = dr.gather(mi.UInt32, table, row * width + k // count)
        there = other != _NONE
        place = subsamples.point(world, dr.select(there, other, 0), k % count).position
        distance = dr.squared_norm(place - middle)
        nearer = there & (distance < least)
        best, least = dr.select(nearer, other, best), dr.select(nearer, distance, least)
        k += 1
    dr.eval(best)
    return best


@dr.syntax
def _nearest_place(world: World, subsamples: Subsamples, texel: mi.UInt32, place: mi.Point3f) -> mi.UInt32:
    """Which sub-sample of each texel is nearest to a place."""
    best, least, number = mi.UInt32(0), mi.Float(dr.inf), mi.UInt32(0)
    count = dr.opaque(mi.UInt32, subsamples.count)
    while number < count:
        distance = dr.squared_norm(subsamples.point(world, texel, number).position - place)
        nearer = distance < least
        best, least = dr.select(nearer, number, best), dr.select(nearer, distance, least)
        number += 1
    dr.eval(best)
    return best
