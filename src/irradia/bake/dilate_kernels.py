"""Numba kernel that grows known texels outward, ring by ring."""

from __future__ import annotations

import numpy as np
from numba import njit

KNOWN, WANTED, NEVER, _QUEUED = 0, 1, 2, 3


@njit(cache=True)
def _has_known_neighbour(state, owner, y, x):
    for v in range(max(y - 1, 0), min(y + 2, state.shape[0])):
        for u in range(max(x - 1, 0), min(x + 2, state.shape[1])):
            if state[v, u] == KNOWN and owner[v, u] == owner[y, x]:
                return True
    return False


@njit(cache=True)
def _mean_of_known(values, state, owner, y, x):
    total = np.zeros(3)
    count = 0
    for v in range(max(y - 1, 0), min(y + 2, state.shape[0])):
        for u in range(max(x - 1, 0), min(x + 2, state.shape[1])):
            if state[v, u] == KNOWN and owner[v, u] == owner[y, x]:
                for c in range(3):
                    total[c] += values[v, u, c]
                count += 1
    return total / count


@njit(cache=True)
def grow(values, state, owner, n_rings):
    """Gives wanted texels the mean of their known neighbours of the same owner, nearest rings first.

    Args:
        values: (H, W, 3) float32, filled in place.
        state: (H, W) uint8 of KNOWN, WANTED and NEVER; what is filled becomes KNOWN.
        owner: (H, W) int64; light passes only between texels of one owner.
        n_rings: How far to go; −1 until nothing more can be reached.
    """
    height, width = state.shape
    queue = np.empty(height * width, np.int64)
    end = 0
    for y in range(height):
        for x in range(width):
            if state[y, x] == WANTED and _has_known_neighbour(state, owner, y, x):
                queue[end] = y * width + x
                end += 1
    begin = 0
    while begin < end and n_rings != 0:
        n_rings -= 1
        for i in range(begin, end):
            y, x = queue[i] // width, queue[i] % width
            values[y, x] = _mean_of_known(values, state, owner, y, x)
        for i in range(begin, end):
            state[queue[i] // width, queue[i] % width] = KNOWN
        ring_end = end
        for i in range(begin, ring_end):
            y, x = queue[i] // width, queue[i] % width
            for v in range(max(y - 1, 0), min(y + 2, height)):
                for u in range(max(x - 1, 0), min(x + 2, width)):
                    if state[v, u] == WANTED and owner[v, u] == owner[y, x]:
                        state[v, u] = _QUEUED
                        queue[end] = v * width + u
                        end += 1
        begin = ring_end
    for i in range(begin, end):
        state[queue[i] // width, queue[i] % width] = WANTED
