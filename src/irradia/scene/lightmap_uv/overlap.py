"""Numba kernels: how many triangles of a uv set lie over each point of a grid."""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

from irradia.scene.types import F64

_STEPS = 1 << 12  # fixed-point steps per grid cell, so that shared edges are decided exactly
_MAX_CELLS = 1 << 26  # of one chart's grid


@njit(cache=True)
def _owns(ax, ay, bx, by, px, py):
    value = (bx - ax) * (py - ay) - (by - ay) * (px - ax)
    return value > 0 or (value == 0 and (by > ay or (by == ay and bx > ax)))


@njit(cache=True)
def _draw(corners, layers):
    """Counts the triangle (3, 2), in fixed-point steps, at the middles of the cells that it covers."""
    height, width = layers.shape
    half = _STEPS // 2
    ax, ay = np.int64(round(corners[0, 0])), np.int64(round(corners[0, 1]))
    bx, by = np.int64(round(corners[1, 0])), np.int64(round(corners[1, 1]))
    cx, cy = np.int64(round(corners[2, 0])), np.int64(round(corners[2, 1]))
    if (bx - ax) * (cy - ay) - (by - ay) * (cx - ax) < 0:
        bx, by, cx, cy = cx, cy, bx, by
    x_begin, x_end = max(min(ax, bx, cx) // _STEPS, 0), min(max(ax, bx, cx) // _STEPS + 1, width)
    y_begin, y_end = max(min(ay, by, cy) // _STEPS, 0), min(max(ay, by, cy) // _STEPS + 1, height)
    for y in range(y_begin, y_end):
        for x in range(x_begin, x_end):
            px, py = x * _STEPS + half, y * _STEPS + half
            if (
                _owns(ax, ay, bx, by, px, py)
                and _owns(bx, by, cx, cy, px, py)
                and _owns(cx, cy, ax, ay, px, py)
            ):
                layers[y, x] = min(layers[y, x] + 1, 2)


@njit(cache=True)
def _count(layers):
    """Grid points that are covered, and that are covered more than once."""
    covered, doubled = 0, 0
    for y in range(layers.shape[0]):
        for x in range(layers.shape[1]):
            covered += layers[y, x] > 0
            doubled += layers[y, x] > 1
    return covered, doubled


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
    for t in range(len(indices)):
        _draw(uv[indices[t]] * scale, layers)
    return _count(layers)


def overlapping_charts(corners: F64, chart: NDArray[np.int64], tolerated: float = 1e-3) -> NDArray[np.bool_]:
    """(C,) charts of which more than a small share of the points lies under two triangles.

    Args:
        corners: (T, 3, 2) in any unit; every chart in a plane of its own.
        chart: (T,) from 0 without gaps.
        tolerated: That share.
    """
    order = np.argsort(chart, kind="stable")
    first = np.searchsorted(chart[order], np.arange(chart.max() + 2))
    low, high = corners.min(axis=1)[order], corners.max(axis=1)[order]
    low, high = np.minimum.reduceat(low, first[:-1]), np.maximum.reduceat(high, first[:-1])
    first_edge, second_edge = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    area = 0.5 * np.abs(first_edge[:, 0] * second_edge[:, 1] - first_edge[:, 1] * second_edge[:, 0]).sum()
    # Some points in the average triangle, but never more than a large picture of them.
    cell = max(
        0.5 * np.sqrt(area / len(corners)), np.sqrt((high - low).prod(axis=1).max() / _MAX_CELLS), 1e-30
    )
    shape = np.ceil((high - low) / cell).astype(np.int64) + 1
    doubled = _doubled_share(corners, order, first, low, shape, cell)
    return doubled > tolerated


@njit(cache=True)
def _doubled_share(corners, order, first, low, shape, cell):
    """(C,) share of each chart's covered grid points that two triangles cover."""
    share = np.zeros(len(low))
    for c in range(len(low)):
        layers = np.zeros((shape[c, 1], shape[c, 0]), np.uint8)
        for i in range(first[c], first[c + 1]):
            _draw((corners[order[i]] - low[c]) / cell * _STEPS, layers)
        covered, doubled = _count(layers)
        if covered > 0:
            share[c] = doubled / covered
    return share
