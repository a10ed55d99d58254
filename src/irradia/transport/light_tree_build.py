"""Builds the tree over local light sources, on the host, one level at a time.

Every node splits its sources into two halves of equal number: the tree is as shallow as can be, and
the lanes of a packet, each on its own way down, arrive together. What is free is the direction of the
cut: the coordinate, or the component of the direction that sources face, that leaves the smaller bounds.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from irradia.transport.light_bounds import F64, LightBounds, bounds_of_groups

LEAF = 0x80000000  # in a link: the rest is the source's number
PUNCTUAL_ONLY = 0x40000000  # in a left link: nothing below this node's parent is a surface
INDEX_BITS = 0x3FFFFFFF
CHILD_WORDS = 12


@dataclass(frozen=True)
class LightTreeTable:
    """A built tree.

    Attributes:
        nodes: (M, 2, 12) float32: each inner node's two children as centre, radius; power, cosine of
            the spread, cosine of spread's falloff, link; axis, reach.
        trail: (N,) uint32 the turns from the root to each source, first turn in the lowest bit.
    """

    nodes: NDArray[np.float32]
    trail: NDArray[np.uint32]

    @property
    def depth(self) -> int:
        """Turns to the deepest source."""
        return max(len(self.trail) - 1, 1).bit_length()


def build_light_tree(sources: LightBounds, is_surface: NDArray[np.bool_]) -> LightTreeTable:
    """Builds a tree over two or more sources.

    Args:
        sources: Their bounds; all of some power.
        is_surface: (N,) which of them rays can meet.
    """
    count = len(sources)
    order = np.arange(count)
    starts, sizes = np.array([0]), np.array([count])  # of this level's inner nodes, in ``order``
    trail = np.zeros(count, np.uint32)
    rows: list[NDArray[np.float32]] = []
    n_nodes = 0
    for level in range(count.bit_length() + 1):
        if not len(starts):
            break
        members, node = _members(order, starts, sizes)
        members = _best_order(sources, members, node, sizes)
        order[_places(starts, sizes)] = members
        n_left = (sizes + 1) // 2
        child_starts = np.stack([starts, starts + n_left], axis=1).ravel()
        child_sizes = np.stack([n_left, sizes - n_left], axis=1).ravel()
        goes_right = (_rank(sizes) >= n_left[node]).astype(np.uint32)
        trail[members] |= goes_right << np.uint32(level)

        bounds = bounds_of_groups(sources.take(members), np.cumsum([0, *child_sizes[:-1]]))
        inner = child_sizes > 1
        n_nodes += len(starts)
        below = n_nodes + np.cumsum(inner) - 1
        link = np.where(inner, below, LEAF | order[child_starts]).astype(np.uint32)
        pure = ~np.logical_or.reduceat(is_surface[members], np.cumsum([0, *sizes[:-1]]))
        link[::2] |= np.where(pure, np.uint32(PUNCTUAL_ONLY), np.uint32(0))
        rows.append(_rows(bounds, link).reshape(-1, 2, CHILD_WORDS))
        starts, sizes = child_starts[inner], child_sizes[inner]
    return LightTreeTable(np.concatenate(rows), trail)


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
    rows[:, 4], rows[:, 5] = bounds.power, np.cos(bounds.spread)
    rows[:, 6], rows[:, 7] = np.cos(bounds.falloff), link.view(np.float32)
    rows[:, 8:11], rows[:, 11] = bounds.axis, bounds.reach
    return rows
