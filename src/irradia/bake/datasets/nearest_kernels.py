"""Numba kernels that find the nearest of many triangles: a tree of boxes, split at medians.

The closest point of a triangle goes by the regions around it (Ericson 2004, "Real-Time Collision
Detection", 5.1.5).
"""

from __future__ import annotations

import numpy as np
from numba import njit, prange

LEAF = 4  # triangles at most
_STACK = 64  # boxes waiting: more than the depth of a tree of 2³² triangles
_RUN = 256  # points that a task looks up


@njit(cache=True)
def build(corners):
    """Sorts triangles (T, 3, 3) into a tree.

    Returns:
        order: (T,) triangles as leaves name them.
        boxes: (M, 2, 3) of nodes, the children of k at ``link[k]`` and the next.
        link: (M,) first child, or of a leaf the first place in ``order``.
        count: (M,) triangles of a leaf; 0 of what has children.
    """
    n = len(corners)
    order = np.arange(n)
    centres = corners[:, 0] + corners[:, 1] + corners[:, 2]
    n_nodes = max(n, 1)  # leaves hold two triangles at least
    boxes, link, count = np.empty((n_nodes, 2, 3)), np.zeros(n_nodes, np.int64), np.zeros(n_nodes, np.int64)
    waiting = [(0, 0, n)]
    used = 1
    while len(waiting) > 0:
        node, first, last = waiting.pop()
        _bound(corners, order, first, last, boxes[node])
        if last - first <= LEAF:
            link[node], count[node] = first, last - first
            continue
        part = order[first:last]
        axis = _widest(centres, part)
        order[first:last] = part[np.argsort(centres[part, axis], kind="mergesort")]
        middle = (first + last) // 2
        link[node] = used
        waiting.append((used, first, middle))
        waiting.append((used + 1, middle, last))
        used += 2
    return order, boxes[:used], link[:used], count[:used]


@njit(cache=True)
def _bound(corners, order, first, last, box):
    box[0], box[1] = np.inf, -np.inf
    for i in range(first, last):
        for k in range(3):
            for axis in range(3):
                value = corners[order[i], k, axis]
                box[0, axis] = min(box[0, axis], value)
                box[1, axis] = max(box[1, axis], value)


@njit(cache=True)
def _widest(centres, part):
    best, widest = -1.0, 0
    for axis in range(3):
        low, high = np.inf, -np.inf
        for i in part:
            low, high = min(low, centres[i, axis]), max(high, centres[i, axis])
        if high - low > best:
            best, widest = high - low, axis
    return widest


@njit(cache=True, parallel=True)
def nearest(points, corners, order, boxes, link, count):
    """Squared distance (N,) from points (N, 3) to the nearest triangle, and which that is (N,)."""
    n = len(points)
    distance2, triangle = np.empty(n), np.empty(n, np.int64)
    for run in prange((n + _RUN - 1) // _RUN):
        stack = np.empty(_STACK, np.int64)
        for i in range(run * _RUN, min((run + 1) * _RUN, n)):
            distance2[i], triangle[i] = _nearest_one(points[i], corners, order, boxes, link, count, stack)
    return distance2, triangle


@njit(cache=True)
def _nearest_one(p, corners, order, boxes, link, count, stack):
    best, which = np.inf, -1
    stack[0], n_waiting = 0, 1
    while n_waiting > 0:
        n_waiting -= 1
        node = stack[n_waiting]
        if _to_box(p, boxes[node]) >= best:
            continue
        if count[node] > 0:
            for i in range(link[node], link[node] + count[node]):
                found = _to_triangle(p, corners[order[i], 0], corners[order[i], 1], corners[order[i], 2])
                if found < best:
                    best, which = found, order[i]
            continue
        near, far = link[node], link[node] + 1
        if _to_box(p, boxes[far]) < _to_box(p, boxes[near]):
            near, far = far, near
        stack[n_waiting], stack[n_waiting + 1] = far, near  # the nearer one is looked at first
        n_waiting += 2
    return best, which


@njit(cache=True)
def _to_box(p, box):
    total = 0.0
    for axis in range(3):
        away = max(box[0, axis] - p[axis], p[axis] - box[1, axis], 0.0)
        total += away * away
    return total


@njit(cache=True)
def _to_triangle(p, a, b, c):
    """Squared distance (Ericson 2005, 5.1.5). Edges without a length are passed over."""
    ab, ac, ap = b - a, c - a, p - a
    d1, d2 = _dot(ab, ap), _dot(ac, ap)
    if d1 <= 0.0 and d2 <= 0.0:
        return _dot(ap, ap)
    bp = p - b
    d3, d4 = _dot(ab, bp), _dot(ac, bp)
    if d3 >= 0.0 and d4 <= d3:
        return _dot(bp, bp)
    cp = p - c
    d5, d6 = _dot(ab, cp), _dot(ac, cp)
    if d6 >= 0.0 and d5 <= d6:
        return _dot(cp, cp)
    vc = d1 * d4 - d3 * d2
    if vc <= 0.0 and d1 >= 0.0 and d3 <= 0.0 and d1 > d3:
        return _length2(ap - ab * (d1 / (d1 - d3)))
    vb = d5 * d2 - d1 * d6
    if vb <= 0.0 and d2 >= 0.0 and d6 <= 0.0 and d2 > d6:
        return _length2(ap - ac * (d2 / (d2 - d6)))
    va = d3 * d6 - d5 * d4
    if va <= 0.0 and d4 >= d3 and d5 >= d6 and d4 - d3 > d6 - d5:
        return _length2(bp - (c - b) * ((d4 - d3) / ((d4 - d3) + (d5 - d6))))
    area = va + vb + vc
    if area <= 0.0:
        return min(_dot(ap, ap), _dot(bp, bp), _dot(cp, cp))
    scale = 1.0 / area
    return _length2(ap - ab * (vb * scale) - ac * (vc * scale))


@njit(cache=True, inline="always")
def _dot(a, b):
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@njit(cache=True, inline="always")
def _length2(a):
    return _dot(a, a)
