"""What probes see: whether they stand in a wall, how to get out, how far sight goes, how much is sky."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from irradia.bake.probes.octahedral import octahedral_directions
from irradia.core.progress import Stage
from irradia.core.sh import fibonacci_sphere, sh_basis

if TYPE_CHECKING:
    from irradia.transport.world import World

F32 = NDArray[np.float32]

DISTANCE_SIZE = 16  # texels a side of a probe's octahedral map
MAX_BACKS = 0.25  # a probe that sees more back faces than this stands in a wall
_QUICK_DIRECTIONS = 128
_DIRECTIONS = 4096
_LOBE_SHARPNESS = 256.0  # a texel of the map averages cos^256 around its direction, 6° wide
REACH_IN_SPACINGS = 2.2  # a cell's diagonal and as much as a probe may be moved
_BACKS_COUNT = 0.2  # as nearer than they are: on their other side is a room that the probe isn't in
_MAX_MOVE = 0.45  # of the spacing, so that neighbours never change places
_CLEARANCE = 0.2  # of the spacing: how far beyond the wall a probe is put; nearer, it sees along it badly
_TRIES = 4


@dataclass(frozen=True)
class Survey:
    """What N probes see from where their light is gathered.

    Attributes:
        offsets: (N, 3) metres from where they stand.
        validity: (N,) share of directions without a back face.
        sky: (N, 4) SH of the sky's visibility.
        distance: (N, S, S, 2) mean and standard deviation, metres.
        reach: (N,) metres at which distances are cut off.
    """

    offsets: F32
    validity: F32
    sky: F32
    distance: F32
    reach: F32

    @property
    def valid(self) -> NDArray[np.bool_]:
        """(N,) whether the probe stands in free space."""
        return self.validity >= 1.0 - MAX_BACKS


def quick_validity(world: World, places: F32) -> F32:
    """(N,) share of directions without a back face, from few rays."""
    from irradia.transport.probe_light import look_around

    validity = np.empty(len(places), np.float32)
    for part, sight in look_around(world, places, fibonacci_sphere(_QUICK_DIRECTIONS).astype(np.float32)):
        validity[part] = 1.0 - sight.back.mean(axis=1)
    return validity


def survey(world: World, positions: F32, spacing_m: F32, stage: Stage) -> Survey:
    """Moves probes out of walls where a short way leads out, and looks around from there.

    Args:
        world: The scene.
        positions: (N, 3) where probes stand.
        spacing_m: (N,) between a probe and its neighbours.
        stage: Advances by a probe at a time.
    """
    from irradia.transport.probe_light import look_around

    n = len(positions)
    offsets = _offsets(world, positions, spacing_m)
    places = positions + offsets
    reach = (REACH_IN_SPACINGS * spacing_m).astype(np.float32)
    directions = fibonacci_sphere(_DIRECTIONS)
    lobes = _lobes(directions)
    sky_weights = sh_basis(directions)[:, :4] * (4.0 * math.pi / _DIRECTIONS)
    validity, sky = np.empty(n, np.float32), np.empty((n, 4), np.float32)
    distance = np.empty((n, DISTANCE_SIZE * DISTANCE_SIZE, 2), np.float32)
    for part, sight in look_around(world, places, directions.astype(np.float32)):
        validity[part] = 1.0 - sight.back.mean(axis=1)
        sky[part] = sight.sky @ sky_weights
        blocked = sight.distance * np.where(sight.back, np.float32(_BACKS_COUNT), np.float32(1.0))
        seen = np.minimum(blocked, reach[part, None]).astype(np.float64)
        mean, square = seen @ lobes, (seen * seen) @ lobes
        distance[part, :, 0] = mean
        distance[part, :, 1] = np.sqrt(np.maximum(square - mean * mean, 0.0))
        stage.advance(len(seen))
    shape = (n, DISTANCE_SIZE, DISTANCE_SIZE, 2)
    return Survey(offsets, validity, sky, distance.reshape(shape), reach)


def _lobes(directions: NDArray[np.float64]) -> NDArray[np.float64]:
    """(D, S²) how much each direction counts in each texel of the octahedral map."""
    cosine = np.maximum(directions @ octahedral_directions(DISTANCE_SIZE).T, 0.0)
    weights = cosine**_LOBE_SHARPNESS
    return weights / weights.sum(axis=0)


def _offsets(world: World, positions: F32, spacing_m: F32) -> F32:
    """(N, 3) ways out of walls: towards the nearest back face and a little beyond it.

    The nearest may lead into the next wall or out of the building, so a few directions are tried.
    Probes for which none leads into the open stay where they are.
    """
    offsets = np.zeros((len(positions), 3), np.float32)
    distance, inside = _quick_look(world, positions)
    stuck = np.flatnonzero(inside)
    directions = fibonacci_sphere(_QUICK_DIRECTIONS).astype(np.float32)
    open_ = np.isfinite(distance[stuck])
    for _ in range(_TRIES):
        if len(stuck) == 0:
            break
        nearest = np.where(open_, distance[stuck], np.inf).argmin(axis=1)
        way = distance[stuck, nearest] + _CLEARANCE * spacing_m[stuck]
        short = open_[np.arange(len(stuck)), nearest] & (way <= _MAX_MOVE * spacing_m[stuck])
        stuck, open_, nearest, way = stuck[short], open_[short], nearest[short], way[short]
        move = (directions[nearest] * way[:, None]).astype(np.float32)
        still_inside = quick_validity(world, positions[stuck] + move) < 1.0 - MAX_BACKS
        offsets[stuck[~still_inside]] = move[~still_inside]
        tried = directions[nearest] @ directions.T > 0.5
        stuck, open_ = stuck[still_inside], (open_ & ~tried)[still_inside]
    return offsets


def _quick_look(world: World, places: F32) -> tuple[F32, NDArray[np.bool_]]:
    """(N, D) metres to back faces, inf elsewhere; (N,) whether too many are seen."""
    from irradia.transport.probe_light import look_around

    distance = np.empty((len(places), _QUICK_DIRECTIONS), np.float32)
    inside = np.empty(len(places), np.bool_)
    for part, sight in look_around(world, places, fibonacci_sphere(_QUICK_DIRECTIONS).astype(np.float32)):
        distance[part] = np.where(sight.back, sight.distance, np.inf)
        inside[part] = sight.back.mean(axis=1) > MAX_BACKS
    return distance, inside
