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

_STEPS = 16  # places an axis where the inside is looked for
_DIRECTIONS = 64
_ENCLOSED = 0.5  # share of directions in which somebody inside sees fronts: an open roof is no lid
_FEW_BACKS = 0.1
_AROUND = 0.1  # of an open scene's longest side: room for what moves, but none under the ground


def probe_box(world: World, mesh: MergedMesh) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Lowest and highest corner, metres.

    Where the scene is a room, what lies around its walls (a street, the ground it stands on) is left
    out: the box then holds all places that see mostly fronts of surfaces. An open scene gets a margin
    at its sides and above.
    """
    corners = mesh.positions[np.unique(mesh.indices)].astype(np.float64)
    low, high = corners.min(axis=0), corners.max(axis=0)
    if find_interior_view(mesh) is None:
        margin = _AROUND * float((high - low).max())
        return low - (margin, 0.0, margin), high + margin
    size = (high - low) / _STEPS
    places = _cell_centres(low, size)
    inside = places[_is_inside(world, places.astype(np.float32))]
    if len(inside) == 0:
        return low, high
    return np.maximum(inside.min(axis=0) - size, low), np.minimum(inside.max(axis=0) + size, high)


def _cell_centres(low: NDArray[np.float64], size: NDArray[np.float64]) -> NDArray[np.float64]:
    steps = (np.arange(_STEPS) + 0.5)[:, None] * size + low
    x, y, z = np.meshgrid(*steps.T, indexing="ij")
    return np.stack([x.ravel(), y.ravel(), z.ravel()], axis=1)


def _is_inside(world: World, places: NDArray[np.float32]) -> NDArray[np.bool_]:
    from irradia.transport.probe_light import look_around

    inside = np.empty(len(places), np.bool_)
    for part, sight in look_around(world, places, fibonacci_sphere(_DIRECTIONS).astype(np.float32)):
        backs = sight.back.mean(axis=1)
        fronts = (np.isfinite(sight.distance) & ~sight.back).mean(axis=1)
        inside[part] = (backs < _FEW_BACKS) & (fronts > _ENCLOSED)
    return inside
