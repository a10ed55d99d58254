"""Numba kernels that fill texels from their surroundings."""

from __future__ import annotations

import numpy as np
from numba import njit

KNOWN, WANTED, _QUEUED = 0, 1, 2


@njit(cache=True)
def _lowest_known_region(texel_at, region, chart, y, x):
    """Region of the known texels round one of a chart; of several, the one that was numbered first."""
    best, own = np.int64(-1), texel_at[y, x]
    for v in range(max(y - 1, 0), min(y + 2, texel_at.shape[0])):
        for u in range(max(x - 1, 0), min(x + 2, texel_at.shape[1])):
            t = texel_at[v, u]
            if t >= 0 and chart[t] == chart[own] and region[t] >= 0:
                best = region[t] if best < 0 else min(best, region[t])
    return best


@njit(cache=True)
def _mean_of_region(values, texel_at, region, wanted, y, x, mean):
    """Mean of the known texels of a region round a place."""
    mean[:] = 0.0
    count = 0
    for v in range(max(y - 1, 0), min(y + 2, texel_at.shape[0])):
        for u in range(max(x - 1, 0), min(x + 2, texel_at.shape[1])):
            t = texel_at[v, u]
            if t >= 0 and region[t] == wanted:
                for c in range(len(mean)):
                    mean[c] += values[t, c]
                count += 1
    for c in range(len(mean)):
        mean[c] /= count


@njit(cache=True)
def fill_rings(values, region, chart, pixel, texel_at):
    """Gives texels without a region, ring by ring, that of a neighbour on their chart and its mean.

    Args:
        values: (N, C) float32 of one page's texels, filled in place.
        region: (N,) int64, −1 where light is wanted; filled in place.
        chart: (N,).
        pixel: (N,) int64 on the page.
        texel_at: (H, W) int32 number of the texel at each pixel, or −1.
    """
    height, width = texel_at.shape
    n = len(pixel)
    ring, found = np.empty(n, np.int64), np.empty(n, np.int64)
    queued = np.zeros(n, np.bool_)
    mean = np.empty(values.shape[1])
    end = 0
    for i in range(n):
        if (
            region[i] < 0
            and _lowest_known_region(texel_at, region, chart, pixel[i] // width, pixel[i] % width) >= 0
        ):
            ring[end], queued[i] = i, True
            end += 1
    begin = 0
    while begin < end:
        for k in range(begin, end):
            y, x = pixel[ring[k]] // width, pixel[ring[k]] % width
            found[k] = _lowest_known_region(texel_at, region, chart, y, x)
            _mean_of_region(values, texel_at, region, found[k], y, x, mean)
            values[ring[k]] = mean
        for k in range(begin, end):
            region[ring[k]] = found[k]
        ring_end = end
        for k in range(begin, ring_end):
            i = ring[k]
            y, x = pixel[i] // width, pixel[i] % width
            for v in range(max(y - 1, 0), min(y + 2, height)):
                for u in range(max(x - 1, 0), min(x + 2, width)):
                    t = texel_at[v, u]
                    if t >= 0 and region[t] < 0 and chart[t] == chart[i] and not queued[t]:
                        ring[end], queued[t] = t, True
                        end += 1
        begin = ring_end


@njit(cache=True)
def _mean_of_known(values, state, y, x, mean):
    mean[:] = 0.0
    count = 0
    for v in range(max(y - 1, 0), min(y + 2, state.shape[0])):
        for u in range(max(x - 1, 0), min(x + 2, state.shape[1])):
            if state[v, u] == KNOWN:
                for c in range(len(mean)):
                    mean[c] += values[v, u, c]
                count += 1
    for c in range(len(mean)):
        mean[c] /= count


@njit(cache=True)
def _queue_around(state, y, x, queue, end):
    """Appends the wanted texels round a place; returns the queue's new end."""
    height, width = state.shape
    for v in range(max(y - 1, 0), min(y + 2, height)):
        for u in range(max(x - 1, 0), min(x + 2, width)):
            if state[v, u] == WANTED:
                state[v, u] = _QUEUED
                queue[end] = v * width + u
                end += 1
    return end


@njit(cache=True)
def grow(values, state, n_rings):
    """Gives wanted texels the mean of their known neighbours, nearest rings first.

    Args:
        values: (H, W, C) float32, filled in place.
        state: (H, W) uint8 of KNOWN and WANTED; what is filled becomes KNOWN.
        n_rings: How far to go.
    """
    height, width = state.shape
    queue = np.empty(height * width, np.int32)
    mean = np.empty(values.shape[2])
    end = 0
    for y in range(height):
        for x in range(width):
            if state[y, x] == KNOWN:
                end = _queue_around(state, y, x, queue, end)
    begin = 0
    for ring in range(n_rings):
        ring_end = end
        for k in range(begin, ring_end):
            y, x = queue[k] // width, queue[k] % width
            _mean_of_known(values, state, y, x, mean)
            values[y, x] = mean
        for k in range(begin, ring_end):
            state[queue[k] // width, queue[k] % width] = KNOWN
        if ring + 1 < n_rings:
            for k in range(begin, ring_end):
                end = _queue_around(state, queue[k] // width, queue[k] % width, queue, end)
        begin = ring_end
    for k in range(begin, end):
        state[queue[k] // width, queue[k] % width] = WANTED


@njit(cache=True)
def halve(image, known):
    """Means over the known texels of each 2 × 2 square, (⌈H/2⌉, ⌈W/2⌉, C), and which have any."""
    height, width, channels = image.shape
    coarse = np.zeros(((height + 1) // 2, (width + 1) // 2, channels), np.float32)
    coarse_known = np.zeros(coarse.shape[:2], np.bool_)
    for y in range(coarse.shape[0]):
        for x in range(coarse.shape[1]):
            count = 0
            for v in range(2 * y, min(2 * y + 2, height)):
                for u in range(2 * x, min(2 * x + 2, width)):
                    if known[v, u]:
                        count += 1
                        for c in range(channels):
                            coarse[y, x, c] += image[v, u, c]
            if count > 0:
                coarse_known[y, x] = True
                for c in range(channels):
                    coarse[y, x, c] /= count
    return coarse, coarse_known


@njit(cache=True)
def fill_from(coarse, image, known):
    """Fills unknown texels, in place, by bilinear magnification of an image half as large."""
    height, width, channels = image.shape
    for y in range(height):
        near_y = y // 2
        far_y = min(max(near_y + (1 if y % 2 else -1), 0), coarse.shape[0] - 1)
        for x in range(width):
            if known[y, x]:
                continue
            near_x = x // 2
            far_x = min(max(near_x + (1 if x % 2 else -1), 0), coarse.shape[1] - 1)
            for c in range(channels):
                near = 0.75 * coarse[near_y, near_x, c] + 0.25 * coarse[near_y, far_x, c]
                far = 0.75 * coarse[far_y, near_x, c] + 0.25 * coarse[far_y, far_x, c]
                image[y, x, c] = 0.75 * near + 0.25 * far
