"""The space that probes fill: a room's inside, or an open scene and a little around it."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from irradia.bake.probes.sh import fibonacci_sphere
from irradia.scene.interior import find_interior_view
from irradia.scene.merge import MergedMesh

if TYPE_CHECKING:
    from irradia.transport.world import World

Mask = NDArray[np.bool_]
F64 = NDArray[np.float64]

_STEPS = 16  # places an axis where the inside is looked for
_DIRECTIONS = 64
_ENCLOSED = 0.5  # share of directions in which somebody inside sees fronts: an open roof is no lid
_FEW_BACKS = 0.1
_AROUND = 0.1  # of an open scene's longest side: room for what moves, but none under the ground
_HEADROOM_M = 2.0  # enough above wide and flat scenes


def probe_box(world: World, mesh: MergedMesh) -> tuple[F64, F64]:
    """Lowest and highest corner, metres.

    Where the scene is a room, what lies around its walls (a street, the ground it stands on) is left
    out: the box then holds the places that can be reached from the middle of the room and see mostly
    fronts of surfaces. An open scene gets a margin at its sides and above.
    """
    corners = mesh.positions[np.unique(mesh.indices)].astype(np.float64)
    low, high = corners.min(axis=0), corners.max(axis=0)
    view = find_interior_view(mesh)
    if view is None:
        margin = _AROUND * float((high - low).max())
        above = min(margin, max(float(high[1] - low[1]), _HEADROOM_M))
        return low - (margin, 0.0, margin), high + (margin, above, margin)
    size = (high - low) / _STEPS
    steps = (np.arange(_STEPS) + 0.5)[:, None] * size + low
    places = np.stack(np.meshgrid(*steps.T, indexing="ij"), axis=-1)
    free = _is_enclosed(world, places)
    reached = places[_reachable(world, places, free, view.eye)]
    if len(reached) == 0:
        return low, high
    return np.maximum(reached.min(axis=0) - size, low), np.minimum(reached.max(axis=0) + size, high)


def _is_enclosed(world: World, places: F64) -> Mask:
    """Whether each place of a lattice (…, 3) sees mostly fronts."""
    from irradia.transport.probe_light import look_around

    enclosed = np.empty(places[..., 0].size, np.bool_)
    directions = fibonacci_sphere(_DIRECTIONS).astype(np.float32)
    for part, sight in look_around(world, places.reshape(-1, 3).astype(np.float32), directions):
        backs = sight.back.mean(axis=1)
        fronts = (np.isfinite(sight.distance) & ~sight.back).mean(axis=1)
        enclosed[part] = (backs < _FEW_BACKS) & (fronts > _ENCLOSED)
    return enclosed.reshape(places.shape[:-1])


def _reachable(world: World, places: F64, free: Mask, eye: F64) -> Mask:
    """The free places of a lattice that a way from neighbour to neighbour leads to from an eye."""
    reached = free & _unblocked(world, np.broadcast_to(eye, places.shape), places)
    links = []
    for axis in range(3):
        near = np.take(places, range(_STEPS - 1), axis)
        links.append(_unblocked(world, near, np.take(places, range(1, _STEPS), axis)))
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
