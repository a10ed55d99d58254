"""Numba kernels of the rasteriser: fixed-point triangles against texel squares.

Vertices are snapped to 2⁻¹⁴ of a texel and every edge test is exact in 64-bit integers, so two
triangles that share an edge neither both claim nor both miss a sub-sample on it. Triangles come wound
so that their area is not negative.
"""

from __future__ import annotations

import numpy as np
from numba import njit, prange

from irradia.transport.subsample_set import CODE_BITS, STEPS, SUBSAMPLES, TRIANGLE_SHIFT, Y_SHIFT

ONE = 1 << 14  # fixed-point steps per texel; pages of up to 2^16 texels keep edge products below 2^62
_RUN = 1024  # texels that share their scratch space
_MIN_COVERAGE = 1e-6  # of triangles without area on the page
_CLIP_CORNERS = 8  # a triangle cut by four lines has at most seven

# Eight rooks that attack neither each other nor, nearly, along a diagonal: one sample in each of the
# eight rows and columns of the texel.
SUBSAMPLE_X = (np.arange(SUBSAMPLES) * 2 + 1) * ONE // (2 * SUBSAMPLES)
SUBSAMPLE_Y = (np.array([3, 6, 0, 5, 7, 1, 4, 2]) * 2 + 1) * ONE // (2 * SUBSAMPLES)


@njit(cache=True, inline="always")
def _edge(ax, ay, bx, by, px, py):
    """Twice the signed area of a, b, p."""
    return (bx - ax) * (py - ay) - (by - ay) * (px - ax)


@njit(cache=True)
def _owns(ax, ay, bx, by, px, py):
    """Whether p lies inside edge a→b; on it, one of the edge and its reverse owns it."""
    value = _edge(ax, ay, bx, by, px, py)
    if value != 0:
        return value > 0
    return by > ay or (by == ay and bx > ax)


@njit(cache=True)
def _contains(tri, px, py):
    """Whether a sub-sample belongs to the triangle (3, 2)."""
    return (
        _owns(tri[0, 0], tri[0, 1], tri[1, 0], tri[1, 1], px, py)
        and _owns(tri[1, 0], tri[1, 1], tri[2, 0], tri[2, 1], px, py)
        and _owns(tri[2, 0], tri[2, 1], tri[0, 0], tri[0, 1], px, py)
    )


@njit(cache=True)
def _area(tri):
    return _edge(tri[0, 0], tri[0, 1], tri[1, 0], tri[1, 1], tri[2, 0], tri[2, 1])


@njit(cache=True)
def _edges_touch(tri, flat, x, y):
    """Separating-axis test along the three edge normals for the square with its corner at x, y.

    A triangle with area must overlap the open square; one without must meet the closed one.
    """
    for i in range(3):
        j = (i + 1) % 3
        dx = tri[j, 0] - tri[i, 0]
        dy = tri[j, 1] - tri[i, 1]
        corner = _edge(tri[i, 0], tri[i, 1], tri[j, 0], tri[j, 1], x, y)
        most = corner + (max(dx, 0) + max(-dy, 0)) * ONE
        if flat:
            least = corner + (min(dx, 0) + min(-dy, 0)) * ONE
            if most < 0 or least > 0:
                return False
        elif most <= 0:
            return False
    return True


@njit(cache=True)
def _texel_range(tri, axis, flat, size):
    """First and one past the last texel that the triangle's extent along an axis touches."""
    low = min(tri[0, axis], tri[1, axis], tri[2, axis])
    high = max(tri[0, axis], tri[1, axis], tri[2, axis])
    end = high // ONE + 1 if flat else (high + ONE - 1) // ONE
    return max(min(low // ONE, size - 1), 0), min(end, size)


@njit(cache=True)
def _visit(tri, first_pixel, width, height, pixels, at):
    """Writes the flat indices of the touched texels from ``at`` on if there is room; counts them."""
    flat = _area(tri) == 0
    x_begin, x_end = _texel_range(tri, 0, flat, width)
    y_begin, y_end = _texel_range(tri, 1, flat, height)
    count = 0
    for y in range(y_begin, y_end):
        for x in range(x_begin, x_end):
            if _edges_touch(tri, flat, x * ONE, y * ONE):
                if at + count < len(pixels):
                    pixels[at + count] = first_pixel + y * width + x
                count += 1
    return count


@njit(cache=True, parallel=True)
def touched_texels(fixed, page, width, height, offsets, pixels):
    """Lists the texels that each triangle touches.

    Args:
        fixed: (T, 3, 2) int64 vertices in steps of 1/ONE texel.
        page: (T,) page of each triangle.
        width: Of a page, in texels.
        height: The same.
        offsets: (T,) where each triangle's texels begin in ``pixels``.
        pixels: (F,) uint32, filled; empty to count only.

    Returns:
        (T,) how many texels each triangle touches.
    """
    counts = np.zeros(len(fixed), np.int64)
    for t in prange(len(fixed)):
        first = np.int64(page[t]) * height * width
        counts[t] = _visit(fixed[t], first, width, height, pixels, offsets[t])
    return counts


@njit(cache=True)
def group_by_texel(pixels, triangle_of, n_pixels):
    """Counting sort of fragments by texel; within a texel triangles stay in ascending order.

    Returns:
        (covered pixels, offsets of their fragments (N + 1,), triangle of each fragment in that order).
    """
    slot = np.zeros(n_pixels + 1, np.uint32)
    for p in pixels:
        slot[p + 1] += 1
    n_covered = 0
    for p in range(n_pixels):
        n_covered += slot[p + 1] > 0
        slot[p + 1] += slot[p]
    covered = np.empty(n_covered, np.uint32)
    offsets = np.empty(n_covered + 1, np.int64)
    k = 0
    for p in range(n_pixels):
        if slot[p + 1] > slot[p]:
            covered[k] = p
            offsets[k] = slot[p]
            k += 1
    offsets[n_covered] = len(pixels)
    ordered = np.empty(len(pixels), np.uint32)
    for i in range(len(pixels)):
        p = pixels[i]
        ordered[slot[p]] = triangle_of[i]
        slot[p] += 1
    return covered, offsets, ordered


@njit(cache=True)
def _clip_axis(polygon, n, axis, sign, limit, out):
    """Sutherland–Hodgman against sign · p[axis] ≤ limit; returns the number of corners kept."""
    kept = 0
    for i in range(n):
        j = (i + 1) % n
        a = sign * polygon[i, axis] - limit
        b = sign * polygon[j, axis] - limit
        if a <= 0:
            out[kept] = polygon[i]
            kept += 1
        if (a < 0 < b) or (b < 0 < a):
            share = a / (a - b)
            out[kept, 1 - axis] = polygon[i, 1 - axis] + share * (polygon[j, 1 - axis] - polygon[i, 1 - axis])
            out[kept, axis] = sign * limit
            kept += 1
    return kept


@njit(cache=True)
def _clip(tri, x, y, polygon, scratch):
    """Cuts the triangle to the texel at x, y; corners in texel units about its centre."""
    for i in range(3):
        polygon[i, 0] = (tri[i, 0] - x) / ONE - 0.5
        polygon[i, 1] = (tri[i, 1] - y) / ONE - 0.5
    n = _clip_axis(polygon, 3, 0, -1.0, 0.5, scratch)
    n = _clip_axis(scratch, n, 0, 1.0, 0.5, polygon)
    n = _clip_axis(polygon, n, 1, -1.0, 0.5, scratch)
    return _clip_axis(scratch, n, 1, 1.0, 0.5, polygon)


@njit(cache=True)
def _polygon_area(polygon, n):
    total = 0.0
    for i in range(n):
        j = (i + 1) % n
        total += polygon[i, 0] * polygon[j, 1] - polygon[j, 0] * polygon[i, 1]
    return 0.5 * abs(total)


@njit(cache=True)
def _covers_square(tri, x, y):
    for i in range(3):
        j = (i + 1) % 3
        dx = tri[j, 0] - tri[i, 0]
        dy = tri[j, 1] - tri[i, 1]
        if _edge(tri[i, 0], tri[i, 1], tri[j, 0], tri[j, 1], x, y) + (min(dx, 0) + min(-dy, 0)) * ONE < 0:
            return False
    return True


@njit(cache=True)
def _area_in_texel(tri, x, y, polygon, scratch):
    """Share of the texel that the triangle covers, exact."""
    if _area(tri) > 0 and _covers_square(tri, x, y):
        return 1.0
    return _polygon_area(polygon, _clip(tri, x, y, polygon, scratch))


@njit(cache=True)
def _nearest_to_origin(polygon, n):
    """Point of a convex polygon that does not hold the origin which is nearest to it."""
    best = np.inf
    best_x, best_y = 0.0, 0.0
    for i in range(n):
        j = (i + 1) % n
        ax, ay = polygon[i, 0], polygon[i, 1]
        dx, dy = polygon[j, 0] - ax, polygon[j, 1] - ay
        length2 = dx * dx + dy * dy
        t = min(max(-(ax * dx + ay * dy) / length2, 0.0), 1.0) if length2 > 0 else 0.0
        px, py = ax + t * dx, ay + t * dy
        if px * px + py * py < best:
            best = px * px + py * py
            best_x, best_y = px, py
    return best_x, best_y


@njit(cache=True)
def _chart_share(fixed, chart, fragments, wanted, x, y, polygon, scratch):
    """How many sub-samples a chart has in a texel, and how much of its area."""
    hits = 0
    for s in range(SUBSAMPLES):
        for t in fragments:
            if chart[t] == wanted and _contains(fixed[t], x + SUBSAMPLE_X[s], y + SUBSAMPLE_Y[s]):
                hits += 1
                break
    area = 0.0
    for t in fragments:
        if chart[t] == wanted:
            area += _area_in_texel(fixed[t], x, y, polygon, scratch)
    return hits, area


@njit(cache=True)
def _owner(fixed, chart, fragments, x, y, polygon, scratch):
    """The chart with most sub-samples, then most area, then the lowest triangle; and its area."""
    owner = chart[fragments[0]]
    contested = False
    for t in fragments:
        contested |= chart[t] != owner
    if not contested:
        area = 0.0
        for t in fragments:
            area += _area_in_texel(fixed[t], x, y, polygon, scratch)
        return owner, area
    hits, area = _chart_share(fixed, chart, fragments, owner, x, y, polygon, scratch)
    for i in range(1, len(fragments)):
        rival = chart[fragments[i]]
        if rival == owner or rival == chart[fragments[i - 1]]:
            continue
        rival_hits, rival_area = _chart_share(fixed, chart, fragments, rival, x, y, polygon, scratch)
        if rival_hits > hits or (rival_hits == hits and rival_area > area):
            owner, hits, area = rival, rival_hits, rival_area
    return owner, area


@njit(cache=True)
def _code(px, py, which):
    """A sub-sample as it is kept (see :class:`SubsampleSet`), of its place in the texel in steps of 1/ONE."""
    x = min(max(px * STEPS // ONE, 0), STEPS - 1)
    y = min(max(py * STEPS // ONE, 0), STEPS - 1)
    return np.uint32(x | (y << Y_SHIFT) | (which << TRIANGLE_SHIFT))


@njit(cache=True)
def _sliver_sample(fixed, chart, fragments, owner, x, y, polygon, scratch):
    """Triangle and code of the chart's point nearest to the texel's centre, where no sub-sample hits it."""
    best = np.inf
    triangle, code = fragments[0], np.uint32(0)
    for t in fragments:
        if chart[t] != owner:
            continue
        n = _clip(fixed[t], x, y, polygon, scratch)
        px, py = _nearest_to_origin(polygon, n)
        if px * px + py * py < best:
            best = px * px + py * py
            triangle, code = t, _code(np.int64((px + 0.5) * ONE), np.int64((py + 0.5) * ONE), 0)
    return triangle, code


@njit(cache=True)
def _resolve_texel(fixed, chart, here, x, y, polygon, scratch, codes, used):
    """Fills one texel's codes and the triangles that they use.

    Returns:
        The chart that owns the texel, the share that it covers, and the number of triangles used.
    """
    # -- Who owns the texel
    owner, area = _owner(fixed, chart, here, x, y, polygon, scratch)

    # -- What each sub-sample sees: the lowest triangle of that chart
    n_hits, n_used = 0, 0
    for s in range(SUBSAMPLES):
        for t in here:
            if chart[t] == owner and _contains(fixed[t], x + SUBSAMPLE_X[s], y + SUBSAMPLE_Y[s]):
                which = 0
                while which < n_used and used[which] != t:
                    which += 1
                used[which] = t
                n_used = max(n_used, which + 1)
                codes[n_hits] = _code(SUBSAMPLE_X[s], SUBSAMPLE_Y[s], which)
                n_hits += 1
                break
    if n_hits == 0:
        used[0], codes[0] = _sliver_sample(fixed, chart, here, owner, x, y, polygon, scratch)
        n_hits, n_used = 1, 1

    # -- A texel covered in part repeats what it has
    for s in range(n_hits, SUBSAMPLES):
        codes[s] = codes[s - n_hits]
    return owner, area, n_used


@njit(cache=True, parallel=True)
def resolve(fixed, chart, pixels, offsets, fragments, width, height):
    """Decides for each covered texel which chart owns it and what its sub-samples see.

    Args:
        fixed: (T, 3, 2) int64 vertices in steps of 1/ONE texel.
        chart: (T,).
        pixels: (N,) the covered texels.
        offsets: (N + 1,) where each texel's triangles begin in ``fragments``.
        fragments: Triangles by texel, ascending within each; see :func:`group_by_texel`. Each
            texel's are overwritten from the front by those that its sub-samples see.
        width: Of a page, in texels.
        height: The same.

    Returns:
        Codes (SUBSAMPLES / 2, N) uint32 of :class:`SubsampleSet`, how many triangles each texel
        uses (N,) uint8, coverage (N,) float32, chart (N,) uint32.
    """
    n = len(pixels)
    words = np.empty((SUBSAMPLES // 2, n), np.uint32)
    n_used = np.empty(n, np.uint8)
    coverage = np.empty(n, np.float32)
    chart_of = np.empty(n, np.uint32)
    for run in prange((n + _RUN - 1) // _RUN):
        polygon = np.empty((_CLIP_CORNERS, 2))
        scratch = np.empty((_CLIP_CORNERS, 2))
        codes = np.empty(SUBSAMPLES, np.uint32)
        used = np.empty(SUBSAMPLES, np.uint32)
        for k in range(run * _RUN, min((run + 1) * _RUN, n)):
            in_page = np.int64(pixels[k]) % (width * height)
            x = (in_page % width) * ONE
            y = (in_page // width) * ONE
            here = fragments[offsets[k] : offsets[k + 1]]
            owner, area, count = _resolve_texel(fixed, chart, here, x, y, polygon, scratch, codes, used)
            here[:count] = used[:count]
            n_used[k] = count
            for s in range(0, SUBSAMPLES, 2):
                words[s // 2, k] = codes[s] | (codes[s + 1] << CODE_BITS)
            chart_of[k] = owner
            coverage[k] = min(max(area, _MIN_COVERAGE), 1.0)
    return words, n_used, coverage, chart_of


@njit(cache=True)
def gather_used(offsets, n_used, fragments):
    """Closes the gaps between the triangles that texels use.

    Args:
        offsets: (N + 1,) where each texel's triangles begin in ``fragments``.
        n_used: (N,) how many of them count.
        fragments: As :func:`resolve` leaves them.

    Returns:
        Where each texel's triangles begin (N,) uint32 in the list of them all (M,) uint32.
    """
    first = np.empty(len(n_used), np.uint32)
    total = 0
    for k in range(len(n_used)):
        first[k] = total
        total += n_used[k]
    triangle = np.empty(total, np.uint32)
    for k in range(len(n_used)):
        for i in range(n_used[k]):
            triangle[first[k] + i] = fragments[offsets[k] + i]
    return first, triangle
