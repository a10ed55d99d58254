"""Numba kernels of the seams: the search for matching borders, and the least-squares operator."""

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


@njit(cache=True)
def _footprint(x, y, first, width, height, pixel, weight, sign):
    """The four texels that bilinear filtering mixes at a point of a page, clamped at its border."""
    x0, y0 = np.floor(x - 0.5), np.floor(y - 0.5)
    fx, fy = x - 0.5 - x0, y - 0.5 - y0
    for k in range(4):
        dx, dy = k & 1, k >> 1
        column = min(max(np.int64(x0) + dx, 0), width - 1)
        row = min(max(np.int64(y0) + dy, 0), height - 1)
        pixel[k] = first + row * width + column
        weight[k] = sign * (fx if dx else 1.0 - fx) * (fy if dy else 1.0 - fy)


@njit(cache=True)
def footprints(page, position_px, width, height):
    """What filtering reads on both sides of each point.

    Args:
        page: (M, 2).
        position_px: (M, 2, 2).
        width: Of a page, in texels.
        height: The same.

    Returns:
        pixel (M, 8) uint32 and weight (M, 8) float32: first side positive, second negative.
    """
    n = len(page)
    pixel, weight = np.empty((n, 8), np.uint32), np.empty((n, 8), np.float32)
    for m in range(n):
        for side in range(2):
            first = np.int64(page[m, side]) * width * height
            x, y = position_px[m, side, 0], position_px[m, side, 1]
            four = slice(4 * side, 4 * side + 4)
            _footprint(x, y, first, width, height, pixel[m, four], weight[m, four], 1.0 - 2.0 * side)
    return pixel, weight


@njit(cache=True)
def side_trust(pixel, weight, chart, texel_at, texel_chart, valid):
    """(M,) the smaller of the two sides' shares that come from valid texels of the point's own chart."""
    trust = np.empty(len(pixel), np.float32)
    for m in range(len(pixel)):
        share = np.zeros(2, np.float32)
        for k in range(8):
            t = texel_at[pixel[m, k]]
            if t >= 0 and texel_chart[t] == chart[m, k // 4] and valid[t]:
                share[k // 4] += abs(weight[m, k])
        trust[m] = min(share[0], share[1])
    return trust


@njit(cache=True)
def _region_of_side(pixel, weight, chart, texel_at, texel_chart, region, valid):
    """Region of the texel that weighs most among the valid ones of a chart."""
    best, heaviest = np.int64(-1), np.float32(0.0)
    for k in range(4):
        t = texel_at[pixel[k]]
        if t >= 0 and texel_chart[t] == chart and valid[t] and abs(weight[k]) > heaviest:
            best, heaviest = np.int64(region[t]), abs(weight[k])
    return best


@njit(cache=True)
def _neighbour(pixel, direction, width, height):
    """Pixel beside another on its page, or −1 beyond the border; 0 to 3: left, right, up, down."""
    x, y = pixel % width, pixel // width % height
    if direction == 0:
        return pixel - 1 if x > 0 else -1
    if direction == 1:
        return pixel + 1 if x < width - 1 else -1
    if direction == 2:
        return pixel - width if y > 0 else -1
    return pixel + width if y < height - 1 else -1


@njit(cache=True)
def choose_unknowns(pixel, weight, chart, texel_at, texel_chart, region, valid, width, height, n_rings):
    """Numbers the texels that closing seams may change.

    They are what filtering reads at the points: valid texels of the point's chart and uncovered ones
    round it, and ``n_rings`` further texels of the same region, over which a change is spread.

    Returns:
        unknown (pages · H · W,) int32, −1 elsewhere; its pixel (n,); its region (n,).
    """
    unknown = np.full(len(texel_at), -1, np.int32)
    pixels = np.empty(len(texel_chart) + pixel.size, np.int64)
    regions = np.empty(len(pixels), np.int64)
    n = 0
    for m in range(len(pixel)):
        for side in range(2):
            four = slice(4 * side, 4 * side + 4)
            c = chart[m, side]
            own = _region_of_side(pixel[m, four], weight[m, four], c, texel_at, texel_chart, region, valid)
            for p in pixel[m, four]:
                t = texel_at[p]
                if unknown[p] < 0 and (t < 0 or (texel_chart[t] == c and valid[t])):
                    unknown[p], pixels[n] = n, p
                    regions[n] = own if t < 0 else np.int64(region[t])
                    n += 1
    begin = 0
    for _ in range(n_rings):
        end = n
        for i in range(begin, end):
            for direction in range(4):
                p = _neighbour(pixels[i], direction, width, height)
                if p < 0 or unknown[p] >= 0:
                    continue
                t = texel_at[p]
                if t >= 0 and valid[t] and np.int64(region[t]) == regions[i]:
                    unknown[p], pixels[n], regions[n] = n, p, regions[i]
                    n += 1
        begin = end
    return unknown, pixels[:n].copy(), regions[:n].copy()


@njit(cache=True)
def smoothness(unknown, pixels, regions, texel_at, region, valid, width, height):
    """Neighbours of each unknown on its region.

    Returns:
        neighbour (n, 4) int32, −1 where there is none that changes; and how many there are in all (n,),
        those that stay as they are included.
    """
    neighbour = np.full((len(pixels), 4), -1, np.int32)
    degree = np.zeros(len(pixels), np.float32)
    for i in range(len(pixels)):
        for direction in range(4):
            p = _neighbour(pixels[i], direction, width, height)
            if p < 0:
                continue
            j, t = unknown[p], texel_at[p]
            if j >= 0 and regions[j] == regions[i]:
                neighbour[i, direction] = j
                degree[i] += 1
            elif j < 0 and t >= 0 and valid[t] and np.int64(region[t]) == regions[i]:
                degree[i] += 1
    return neighbour, degree
