"""Numba kernel: how many triangles of a uv set lie over each point of a grid."""

from __future__ import annotations

import numpy as np
from numba import njit

_STEPS = 1 << 12  # fixed-point steps per grid cell, so that shared edges are decided exactly


@njit(cache=True)
def _owns(ax, ay, bx, by, px, py):
    value = (bx - ax) * (py - ay) - (by - ay) * (px - ax)
    return value > 0 or (value == 0 and (by > ay or (by == ay and bx > ax)))


@njit(cache=True)
def count_layers(uv, indices, grid):
    """Counts grid points under at least one triangle, and under more than one.

    Args:
        uv: (V, 2) float64 in the unit square.
        indices: (T, 3) int64.
        grid: Points along each side; they stand in the middle of the cells.

    Returns:
        (covered points, points covered more than once).
    """
    layers = np.zeros((grid, grid), np.uint8)
    scale = grid * _STEPS
    half = _STEPS // 2
    for t in range(len(indices)):
        ax, ay = np.int64(round(uv[indices[t, 0], 0] * scale)), np.int64(round(uv[indices[t, 0], 1] * scale))
        bx, by = np.int64(round(uv[indices[t, 1], 0] * scale)), np.int64(round(uv[indices[t, 1], 1] * scale))
        cx, cy = np.int64(round(uv[indices[t, 2], 0] * scale)), np.int64(round(uv[indices[t, 2], 1] * scale))
        if (bx - ax) * (cy - ay) - (by - ay) * (cx - ax) < 0:
            bx, by, cx, cy = cx, cy, bx, by
        x_begin, x_end = max(min(ax, bx, cx) // _STEPS, 0), min(max(ax, bx, cx) // _STEPS + 1, grid)
        y_begin, y_end = max(min(ay, by, cy) // _STEPS, 0), min(max(ay, by, cy) // _STEPS + 1, grid)
        for y in range(y_begin, y_end):
            for x in range(x_begin, x_end):
                px, py = x * _STEPS + half, y * _STEPS + half
                if (
                    _owns(ax, ay, bx, by, px, py)
                    and _owns(bx, by, cx, cy, px, py)
                    and _owns(cx, cy, ax, ay, px, py)
                ):
                    layers[y, x] = min(layers[y, x] + 1, 2)
    covered, doubled = 0, 0
    for y in range(grid):
        for x in range(grid):
            covered += layers[y, x] > 0
            doubled += layers[y, x] > 1
    return covered, doubled
