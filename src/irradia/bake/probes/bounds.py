"""The space that probes fill: a room's inside, or an open scene and a little around it."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from irradia.core.sh import fibonacci_sphere
from irradia.scene.interior import find_interior_view
from irradia.scene.merge import MergedMesh

if TYPE_CHECKING:
    from irradia.transport.world import World

Mask = NDArray[np.bool_]
F64 = NDArray[np.float64]

_STEPS = 16  # places an axis where the inside is looked for
_DIRECTIONS = 64
_ENCLOSED = 0.5  # share of directions in which somebody inside sees fronts: an open roof is no lid
_CLOSED = 0.9  # the same of a room whose doors are shut, which no way leads to
_FEW_BACKS = 0.1
_AROUND = 0.1  # of an open scene's longest side: room for what moves, but none under the ground
_HEADROOM_M = 2.0  # enough above wide and flat scenes


def probe_box(world: World, mesh: MergedMesh) -> tuple[F64, F64]:
    """Lowest and highest corner, metres.

    Where the scene is a room, what lies around its walls (a street, the ground it stands on) is left
    out: the box then holds the places that can be reached from the middle of the room, or are closed
    off all round, and see mostly fronts of surfaces. An open scene gets a margin at its sides and above.
    """
    corners = mesh.positions[np.unique(mesh.indices)].astype(np.float64)
    low, high = corners.min(axis=0), corners.max(axis=0)
    view = find_interior_view(mesh)
    if view is None:
        margin = _AROUND * float((high - low).max())
        above = min(margin, max(float(high[1] - low[1]), _HEADROOM_M))
        return low - (margin, 0.0, margin), high + np.array([margin, above, margin])
    size = (high - low) / _STEPS
    steps = (np.arange(_STEPS) + 0.5)[:, None] * size + low
    places = np.stack(np.meshgrid(*steps.T, indexing="ij"), axis=-1)
    enclosed = _enclosed_share(world, places)
    in_sight = _unblocked(world, np.broadcast_to(view.eye, places.shape), places)
    free = enclosed > _ENCLOSED
    reached = places[_reachable(world, places, free, free & (in_sight | (enclosed > _CLOSED)))]
    if len(reached) == 0:
        return low, high
    return np.maximum(reached.min(axis=0) - size, low), np.minimum(reached.max(axis=0) + size, high)


def _enclosed_share(world: World, places: F64) -> F64:
    """Share of directions in which each place of a lattice (…, 3) sees fronts; 0 inside of things."""
    from irradia.transport.probe_light import look_around

    share = np.empty(places[..., 0].size)
    directions = fibonacci_sphere(_DIRECTIONS).astype(np.float32)
    for part, sight in look_around(world, places.reshape(-1, 3).astype(np.float32), directions):
        fronts = (np.isfinite(sight.distance) & ~sight.back).mean(axis=1)
        share[part] = np.where(sight.back.mean(axis=1) < _FEW_BACKS, fronts, 0.0)
    return share.reshape(places.shape[:-1])


def _reachable(world: World, places: F64, free: Mask, start: Mask) -> Mask:
    """The free places of a lattice that a way from neighbour to neighbour leads to from ``start``."""
    reached = start
    links: list[Mask] = []
    for axis in range(3):
        near, far = (np.take(places, range(first, first + _STEPS - 1), axis) for first in (0, 1))
        links.append(_unblocked(world, near, far))
    while True:
        grown = reached.copy()
        for axis, open_ in enumerate(links):
            before, after = (np.moveaxis(part, axis, 0) for part in (reached, grown))
            gate = np.moveaxis(open_, axis, 0)
            after[1:] |= before[:-1] & gate
            after[:-1] |= before[1:] & gate
        grown &= free
        if np.array_equal(grown, reached):
            return reached
        reached = grown


def _unblocked(world: World, start: F64, end: F64) -> Mask:
    """Whether nothing lies between places (…, 3)."""
    from irradia.transport.probe_light import look_along

    way = (end - start).reshape(-1, 3)
    length = np.maximum(np.linalg.norm(way, axis=1), 1e-9)
    origins = start.reshape(-1, 3).astype(np.float32)
    sight = look_along(world, origins, (way / length[:, None]).astype(np.float32))
    return (sight.distance >= length).reshape(start.shape[:-1])
