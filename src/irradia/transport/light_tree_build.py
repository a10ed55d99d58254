"""Builds the tree over local light sources, on the host, one level at a time.

First the kinds part: lights that shine all round, spots, and surfaces. (One bound round a spot and a
bulb shines everywhere as strongly as the spot does in its cone; under a ceiling with both, the bulbs
beside no spot were then picked a hundred times too rarely.) Below that every node splits its sources
into two halves of equal number: the tree is as shallow as can be, and the lanes of a packet, each on its
own way down, arrive together. What is free is the direction of the cut: the coordinate, or the component
of the direction that sources face, that leaves the smaller bounds.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from irradia.transport.light_bounds import F64, LightBounds, bounds_of_groups

LEAF = 0x80000000  # in a link: the rest is the source's number
PUNCTUAL_ONLY = 0x40000000  # in a left link: nothing below this node's parent is a surface
INDEX_BITS = 0x3FFFFFFF
CHILD_WORDS = 12
ALL_ROUND = 4.0  # stands where no direction counts
_THOROUGH_UP_TO = 1 << 15  # sources; trying every cut takes a minute for a million


@dataclass(frozen=True)
class LightTreeTable:
    """A built tree.

    Attributes:
        nodes: (M, 2, 12) float32: each inner node's two children as centre, radius; power, u, v, link;
            axis, reach. The pair (u, v) says what the group shines into, see ``light_tree``.
        trail: (N,) uint32 the turns from the root to each source, first turn in the lowest bit.
        depth: Turns to the deepest source.
    """

    nodes: NDArray[np.float32]
    trail: NDArray[np.uint32]
    depth: int


def build_light_tree(sources: LightBounds, is_surface: NDArray[np.bool_]) -> LightTreeTable:
    """Builds a tree over two or more sources.

    Args:
        sources: Their bounds; all of some power.
        is_surface: (N,) which of them rays can meet.
    """
    count = len(sources)
    kind = _kinds(sources)
    order = np.argsort(kind, kind="stable")
    starts, sizes = np.array([0]), np.array([count])  # of this level's inner nodes, in ``order``
    trail = np.zeros(count, np.uint32)
    rows: list[NDArray[np.float32]] = []
    n_nodes = 0
    while len(starts):
        members, node = _members(order, starts, sizes)
        n_first = _n_of_first_kind(kind[members], node, sizes)
        one_kind = n_first == sizes
        members = np.where(one_kind[node], _best_order(sources, members, node, sizes), members)
        order[_places(starts, sizes)] = members
        n_left = np.where(one_kind, (sizes + 1) // 2, n_first)
        child_starts = np.stack([starts, starts + n_left], axis=1).ravel()
        child_sizes = np.stack([n_left, sizes - n_left], axis=1).ravel()
        goes_right = (_rank(sizes) >= n_left[node]).astype(np.uint32)
        trail[members] |= goes_right << np.uint32(len(rows))

        bounds = bounds_of_groups(sources.take(members), np.cumsum([0, *child_sizes[:-1]]))
        inner = child_sizes > 1
        n_nodes += len(starts)
        below = n_nodes + np.cumsum(inner) - 1
        link = np.where(inner, below, LEAF | order[child_starts]).astype(np.uint32)
        pure = ~np.logical_or.reduceat(is_surface[members], np.cumsum([0, *sizes[:-1]]))
        link[::2] |= np.where(pure, np.uint32(PUNCTUAL_ONLY), np.uint32(0))
        rows.append(_rows(bounds, link).reshape(-1, 2, CHILD_WORDS))
        starts, sizes = child_starts[inner], child_sizes[inner]
    return LightTreeTable(np.concatenate(rows), trail, depth=len(rows))


def _kinds(sources: LightBounds) -> NDArray[np.int64]:
    """0 where sources shine all round, 1 for spots, 2 for surfaces."""
    return np.where(_shines_all_round(sources), 0, np.where(_falls_with_cosine(sources), 2, 1))


def _shines_all_round(bounds: LightBounds) -> NDArray[np.bool_]:
    return bounds.spread >= math.pi / 2


def _falls_with_cosine(bounds: LightBounds) -> NDArray[np.bool_]:
    return bounds.falloff > math.pi / 4


def _n_of_first_kind(
    kind: NDArray[np.int64], node: NDArray[np.int64], sizes: NDArray[np.int64]
) -> NDArray[np.int64]:
    """How many of each node's members are of its first member's kind."""
    first = np.cumsum([0, *sizes[:-1]])
    return np.add.reduceat((kind == kind[first][node]).astype(np.int64), first)


def _members(
    order: NDArray[np.int64], starts: NDArray[np.int64], sizes: NDArray[np.int64]
) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """The sources of a level's nodes, one node after the other, and the node of each."""
    return order[_places(starts, sizes)], np.repeat(np.arange(len(starts)), sizes)


def _places(starts: NDArray[np.int64], sizes: NDArray[np.int64]) -> NDArray[np.int64]:
    return np.repeat(starts, sizes) + _rank(sizes)


def _rank(sizes: NDArray[np.int64]) -> NDArray[np.int64]:
    """0, 1, … within each run."""
    return np.arange(sizes.sum()) - np.repeat(np.cumsum([0, *sizes[:-1]]), sizes)


def _best_order(
    sources: LightBounds, members: NDArray[np.int64], node: NDArray[np.int64], sizes: NDArray[np.int64]
) -> NDArray[np.int64]:
    """The members, sorted in each node along the direction whose halves have the smaller bounds."""
    if len(sources) > _THOROUGH_UP_TO:
        return members[np.lexsort((members, _along_widest(sources.centre[members], node, sizes), node))]
    n_left = (sizes + 1) // 2
    halves = np.cumsum([0, *np.stack([n_left, sizes - n_left], axis=1).ravel()[:-1]])
    best_cost = np.full(len(sizes), np.inf)
    best = members.copy()
    for key in _keys(sources):
        sorted_members = members[np.lexsort((members, key[members], node))]
        cost = _cost(bounds_of_groups(sources.take(sorted_members), halves)).reshape(-1, 2).sum(axis=1)
        better = cost < best_cost
        best = np.where(better[node], sorted_members, best)
        best_cost = np.where(better, cost, best_cost)
    return best


def _along_widest(places: F64, node: NDArray[np.int64], sizes: NDArray[np.int64]) -> F64:
    """Each place's coordinate along the axis on which its node reaches furthest."""
    first = np.cumsum([0, *sizes[:-1]])
    extent = np.maximum.reduceat(places, first) - np.minimum.reduceat(places, first)
    return places[np.arange(len(places)), extent.argmax(axis=1)[node]]


def _keys(sources: LightBounds) -> list[F64]:
    """What sources may be sorted by: where they are and, if they differ in it, what they face."""
    faces = [sources.axis[:, i] for i in range(3) if np.ptp(sources.axis[:, i]) > 1e-3]
    return [*sources.centre.T, *faces]


def _cost(bounds: LightBounds) -> F64:
    """The paper's surface area orientation heuristic: power · area · solid angle shone into."""
    spread = bounds.spread
    widest = np.minimum(spread + bounds.falloff, np.pi)
    solid_angle = 2.0 * np.pi * (1.0 - np.cos(spread)) + 0.5 * np.pi * (
        2.0 * widest * np.sin(spread)
        - np.cos(spread - 2.0 * widest)
        - 2.0 * spread * np.sin(spread)
        + np.cos(spread)
    )
    return bounds.power * np.square(bounds.radius) * np.maximum(solid_angle, 0.0)


def _rows(bounds: LightBounds, link: NDArray[np.uint32]) -> NDArray[np.float32]:
    rows = np.zeros((len(bounds), CHILD_WORDS), np.float32)
    rows[:, 0:3], rows[:, 3] = bounds.centre, bounds.radius
    rows[:, 4], rows[:, 7] = bounds.power, link.view(np.float32)
    rows[:, 5], rows[:, 6] = _shone_into(bounds)
    rows[:, 8:11], rows[:, 11] = bounds.axis, bounds.reach
    return rows


def _shone_into(bounds: LightBounds) -> tuple[F64, F64]:
    """(u, v): a cone of spots, the half-spaces before surfaces, or everything."""
    cosine, sine = np.cos(bounds.spread), np.sin(bounds.spread)
    surfaces = _falls_with_cosine(bounds)
    u = np.where(_shines_all_round(bounds), ALL_ROUND, np.where(surfaces, cosine, sine))
    v = np.where(surfaces, sine, -np.maximum(cosine, 1e-6))
    return u, v
