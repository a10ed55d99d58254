"""Numba kernels that set up the seams' equations: what filtering reads, and which texels may change."""

from __future__ import annotations

import numpy as np
from numba import njit


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
    """Neighbours of each covered unknown on its region; uncovered ones have none.

    Returns:
        neighbour (n, 4) int32, −1 where there is none that changes; and how many there are in all (n,),
        those that stay as they are included.
    """
    neighbour = np.full((len(pixels), 4), -1, np.int32)
    degree = np.zeros(len(pixels), np.float32)
    for i in range(len(pixels)):
        for direction in range(4):
            p = _neighbour(pixels[i], direction, width, height)
            if p < 0 or texel_at[p] < 0 or texel_at[pixels[i]] < 0:
                continue
            j, t = unknown[p], texel_at[p]
            if valid[t] and np.int64(region[t]) == regions[i]:
                neighbour[i, direction] = j
                degree[i] += 1
    return neighbour, degree
