"""Light for probes inside walls, from their neighbours, so that plain trilinear filtering works too.

A wall has two sides, and what lights one must not come out at the other. So a neighbour counts only if
the way to it leads through a single surface, that of the wall the probe stands in, and the nearer that
surface is, the more it counts: a probe 2 cm under the lit side of a wall takes the lit side's light.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from irradia.formats.probes import EMPTY, FILLED, VALID

if TYPE_CHECKING:
    from irradia.transport.world import World

F32 = NDArray[np.float32]
I64 = NDArray[np.int64]

_ROUNDS = 16
_SAME_PLACE = 1e-3  # of a way's length: two hits that near to each other are one surface


def fill_invalid(
    world: World, places: F32, values: F32, valid: NDArray[np.bool_], pairs: I64
) -> tuple[F32, NDArray[np.uint8]]:
    """Gives invalid probes the light of neighbours that are not behind another wall.

    Args:
        world: The scene.
        places: (N, 3) where light was gathered.
        values: (N, …) what to fill.
        valid: (N,) which probes have light of their own.
        pairs: (P, 2) neighbours.

    Returns:
        The values, zeros where nothing could be found, and states (N,).
    """
    flat = values.reshape(len(values), -1).astype(np.float64)
    flat[~valid] = 0.0
    taker, giver, weight = _ways(world, places, valid, pairs)
    state = np.where(valid, VALID, EMPTY).astype(np.uint8)
    for _ in range(_ROUNDS):
        useful = (state[taker] == EMPTY) & (state[giver] != EMPTY) & (weight > 0.0)
        if not useful.any():
            break
        total = np.zeros(len(flat))
        light = np.zeros_like(flat)
        np.add.at(total, taker[useful], weight[useful])
        np.add.at(light, taker[useful], weight[useful, None] * flat[giver[useful]])
        reached = total > 0.0
        flat[reached] = light[reached] / total[reached, None]
        state[reached] = FILLED
    return flat.reshape(values.shape).astype(np.float32), state


def _ways(
    world: World, places: F32, valid: NDArray[np.bool_], pairs: I64
) -> tuple[I64, I64, NDArray[np.float64]]:
    """Who may take light from whom, and how much that counts; takers are invalid probes."""
    from irradia.transport.probe_light import look_along

    both = np.concatenate([pairs, pairs[:, ::-1]])
    taker, giver = both[~valid[both[:, 0]]].T
    way = places[giver] - places[taker]
    length = np.maximum(np.linalg.norm(way, axis=1), 1e-9).astype(np.float32)
    direction = way / length[:, None]
    there = look_along(world, places[taker], direction)
    back_again = look_along(world, places[giver], -direction)
    clear = (there.distance >= length) & (back_again.distance >= length)
    single = there.back & ~back_again.back
    single &= there.distance + back_again.distance >= length * (1.0 - _SAME_PLACE)
    # Under a surface its depth counts; between two probes inside the same wall, their distance.
    depth = np.where(single, there.distance, 0.5 * length).astype(np.float64)
    weight = np.where(single | clear, 1.0 / np.maximum(depth, 1e-3 * length) ** 2, 0.0)
    return taker, giver, weight
