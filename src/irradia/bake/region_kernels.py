"""Numba kernel that finds connected texels in the compact list."""

from __future__ import annotations

import numpy as np
from numba import njit

_NOWHERE = np.uint32(0xFFFFFFFF)


@njit(cache=True)
def _root(parent, i):
    while parent[i] != i:
        parent[i] = parent[parent[i]]
        i = parent[i]
    return i


@njit(cache=True)
def _join(parent, i, j):
    """The lower number becomes the root of both."""
    a, b = _root(parent, i), _root(parent, j)
    if a < b:
        parent[b] = a
    else:
        parent[a] = b


@njit(cache=True)
def join_neighbours(pixel, chart, visible, cut_off, width, height):
    """Connected components of visible texels over their eight neighbours on the chart.

    Args:
        pixel: (N,) ascending.
        chart: (N,).
        visible: (N,).
        cut_off: (N,) bits of preceding neighbours that don't count: left, upper left, above, upper right.
        width: Of a page, in texels.
        height: The same.

    Returns:
        (N,) uint32 first texel of the component; 0xFFFFFFFF for what is not visible.
    """
    n = len(pixel)
    parent = np.arange(n).astype(np.uint32)
    above = 0  # no texel before this one lies beside a coming one in the row above
    for i in range(n):
        p = np.int64(pixel[i])
        x, y = p % width, p // width % height
        while above < i and np.int64(pixel[above]) < p - width - 1:
            above += 1
        if not visible[i]:
            continue
        beside = x > 0 and i > 0 and np.int64(pixel[i - 1]) == p - 1
        if beside and visible[i - 1] and chart[i - 1] == chart[i] and not cut_off[i] & 1:
            _join(parent, i, i - 1)
        j = above
        while y > 0 and j < i and np.int64(pixel[j]) <= p - width + 1:
            step = np.int64(pixel[j]) - (p - width)
            if (
                0 <= x + step < width
                and visible[j]
                and chart[j] == chart[i]
                and not cut_off[i] >> (step + 2) & 1
            ):
                _join(parent, i, j)
            j += 1
    region = np.empty(n, np.uint32)
    for i in range(n):
        region[i] = _root(parent, i) if visible[i] else _NOWHERE
    return region
