"""Numba kernels of the search for chart borders that are one edge in space."""

from __future__ import annotations

import numpy as np
from numba import njit

from irradia.scene.merge import LEVEL_BITS

_NORMALS_AGREE = np.cos(np.radians(2.0))  # a crease of more is meant to be seen
_PARALLEL = 0.98  # |cosine| of two borders that run along each other
_FOLD = np.cos(np.radians(50.0))  # a surface that turns more sees another half of the scene, smooth or not
_SAME_PLACE_PX = 0.01
_MOST_MATCHES = 8  # a point of a border on which more charts meet keeps the first


@njit(cache=True, inline="always")
def _bucket(x, y, z, mask):
    """Hash of a grid cell (Teschner et al. 2003, "Optimized Spatial Hashing", section 4)."""
    return ((x * 73856093) ^ (y * 19349663) ^ (z * 83492791)) & mask


@njit(cache=True, inline="always")
def _cell_of(x, cell):
    return np.int64(np.floor(x / cell))


@njit(cache=True)
def _point_on(ends, e, share, out):
    for k in range(3):
        out[k] = ends[e, 0, k] + (ends[e, 1, k] - ends[e, 0, k]) * share


@njit(cache=True)
def _fill_grid(ends, edge, share, cell, mask):
    """Counting sort of points by bucket: (starts (B + 1,), points in that order)."""
    n = len(edge)
    bucket = np.empty(n, np.int64)
    starts = np.zeros(mask + 2, np.int64)
    p = np.empty(3)
    for i in range(n):
        _point_on(ends, edge[i], share[i], p)
        bucket[i] = _bucket(_cell_of(p[0], cell), _cell_of(p[1], cell), _cell_of(p[2], cell), mask)
        starts[bucket[i] + 1] += 1
    for b in range(mask + 1):
        starts[b + 1] += starts[b]
    order = np.empty(n, np.int64)
    at = starts[:-1].copy()
    for i in range(n):
        order[at[bucket[i]]] = i
        at[bucket[i]] += 1
    return starts, order


@njit(cache=True)
def _share_if_matches(borders, a, share, b, p):
    """Where on border b the point p of border a lies, in [0, 1], or −1 where they are not one edge."""
    ends, normals, ends_px = borders.ends, borders.normals, borders.ends_px
    lod_a, lod_b = borders.lod[a], borders.lod[b]
    if lod_a != lod_b and lod_a >> LEVEL_BITS == lod_b >> LEVEL_BITS:
        return -1.0  # levels of detail of one object

    # -- Near in space, and parallel
    d2, along, aa, ab = 0.0, 0.0, 0.0, 0.0
    for k in range(3):
        d = ends[b, 1, k] - ends[b, 0, k]
        e = ends[a, 1, k] - ends[a, 0, k]
        d2 += d * d
        aa += e * e
        ab += e * d
        along += (p[k] - ends[b, 0, k]) * d
    t = along / d2
    reach = min(borders.tolerance[a], borders.tolerance[b])
    slack = reach / np.sqrt(d2)
    if t < -slack or t > 1.0 + slack or ab * ab < _PARALLEL * _PARALLEL * aa * d2:
        return -1.0
    t = min(max(t, 0.0), 1.0)
    gap = 0.0
    for k in range(3):
        gap += (ends[b, 0, k] + t * (ends[b, 1, k] - ends[b, 0, k]) - p[k]) ** 2
    if gap > reach * reach:
        return -1.0

    # -- The surface goes on: normals agree, faces lie on different sides
    dot, na, nb, side, fold = 0.0, 0.0, 0.0, 0.0, 0.0
    for k in range(3):
        u = normals[a, 0, k] + share * (normals[a, 1, k] - normals[a, 0, k])
        v = normals[b, 0, k] + t * (normals[b, 1, k] - normals[b, 0, k])
        dot += u * v
        na += u * u
        nb += v * v
        side += borders.inward[a, k] * borders.inward[b, k]
        fold += borders.front[a, k] * borders.front[b, k]
    if side > 0.0 or fold < _FOLD or dot < _NORMALS_AGREE * np.sqrt(na * nb):
        return -1.0

    # -- Cut on the page
    dx = ends_px[a, 0, 0] + share * (ends_px[a, 1, 0] - ends_px[a, 0, 0])
    dx -= ends_px[b, 0, 0] + t * (ends_px[b, 1, 0] - ends_px[b, 0, 0])
    dy = ends_px[a, 0, 1] + share * (ends_px[a, 1, 1] - ends_px[a, 0, 1])
    dy -= ends_px[b, 0, 1] + t * (ends_px[b, 1, 1] - ends_px[b, 0, 1])
    if borders.page[a] == borders.page[b] and dx * dx + dy * dy < _SAME_PLACE_PX * _SAME_PLACE_PX:
        return -1.0
    return t


@njit(cache=True)
def _matches_of(borders, edge, share, grid, i, found, at):
    """Fills ``found`` and ``at`` with borders that pass through point i, and where; returns their number."""
    starts, order, cell, mask = grid
    a, n = edge[i], 0
    p = np.empty(3)
    _point_on(borders.ends, a, share[i], p)
    half = 0.5 * cell + borders.tolerance[a]
    for z in range(_cell_of(p[2] - half, cell), _cell_of(p[2] + half, cell) + 1):
        for y in range(_cell_of(p[1] - half, cell), _cell_of(p[1] + half, cell) + 1):
            for x in range(_cell_of(p[0] - half, cell), _cell_of(p[0] + half, cell) + 1):
                bucket = _bucket(x, y, z, mask)
                for j in range(starts[bucket], starts[bucket + 1]):
                    b = edge[order[j]]
                    known = b == a
                    for m in range(n):
                        known |= found[m] == b
                    if known or n == _MOST_MATCHES:
                        continue
                    t = _share_if_matches(borders, a, share[i], b, p)
                    if t >= 0.0:
                        found[n], at[n] = b, t
                        n += 1
    return n


@njit(cache=True)
def match_borders(borders, edge, share, cell):
    """Finds for every point all other borders that are the same edge in space there.

    Args:
        borders: :class:`irradia.bake.seam_points.Borders`.
        edge: (S,) border of each point.
        share: (S,) where on it, in [0, 1].
        cell: Edge of the search grid's cells; points of one border lie no farther apart.

    Returns:
        point (M,), border (M,) and share on that border (M,), by point.
    """
    n = len(edge)
    mask = 1
    while mask < 2 * n:
        mask *= 2
    mask -= 1
    starts, order = _fill_grid(borders.ends, edge, share, cell, mask)
    grid = (starts, order, cell, mask)
    found = np.empty((n, _MOST_MATCHES), np.int32)
    at = np.empty((n, _MOST_MATCHES), np.float32)
    count = np.zeros(n, np.int64)
    for i in range(n):
        count[i] = _matches_of(borders, edge, share, grid, i, found[i], at[i])
    total = count.sum()
    point, other, other_share = np.empty(total, np.int64), np.empty(total, np.int64), np.empty(total)
    m = 0
    for i in range(n):
        for k in range(count[i]):
            point[m], other[m], other_share[m] = i, found[i, k], at[i, k]
            m += 1
    return point, other, other_share
