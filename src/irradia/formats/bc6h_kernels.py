"""Numba kernels of the BC6H encoder: each block tries modes and partitions and keeps the best.

Endpoints are sought in the 16-bit space in which blocks interpolate, which is proportional to the bits of
a half float and so nearly logarithmic. Errors are those of the decoded bits, weighted by texel and channel.

This work is based on: Waveren, "Real-Time DXT Compression", 2006 (principal axis, then least squares), and
Krajcevski et al., "FasTC: Accelerated Fixed-Rate Texture Encoding", 2013 (partitions estimated before they
are fitted).
"""

from __future__ import annotations

import numpy as np
from numba import njit

from irradia.formats.bc6h_tables import (
    ANCHORS,
    BIT_POSITIONS,
    INDEX_AT,
    INDEX_WIDTH,
    LEVELS,
    MODES,
    N_PARTITIONS,
    PARTITION_AT,
    REGION,
    WHOLE,
)

_CODE = np.array([mode.code for mode in MODES])
_CODE_BITS = np.array([mode.code_bits for mode in MODES])
_BASE_BITS = np.array([mode.base_bits for mode in MODES])
_DELTA_BITS = np.array([mode.delta_bits for mode in MODES])
_TRANSFORMED = np.array([mode.transformed for mode in MODES])
# Modes for one region and for two, finest endpoints first; the last of each takes any endpoints.
_ORDER = np.array([[13, 12, 11, 10, -1, -1, -1, -1, -1, -1], [2, 3, 4, 0, 5, 6, 7, 8, 1, 9]])
_BLACK = 10  # the mode of blocks that don't matter

_AXIS_STEPS = 4  # of the power iteration; more change no block's partition
_FITS = 3  # rounds of least squares; a fourth gains under 0.05 dB
_GOOD_ENOUGH = 9.0  # mean squared error in bits of a half: 0.2 %, less than a second region gains


@njit(cache=True)
def _unquantise(code, n_bits):
    if n_bits >= 15 or code == 0:
        return code
    if code == (1 << n_bits) - 1:
        return 0xFFFF
    return ((code << 16) + 0x8000) >> n_bits


@njit(cache=True)
def _nearest_code(value, n_bits):
    """The code whose value is nearest: steps are equally wide but for the outermost, at 0 and 65535."""
    if n_bits >= 15:
        return int(value + 0.5)
    largest = (1 << n_bits) - 1
    in_steps = value / (1 << (16 - n_bits))
    code = min(int(in_steps), largest)
    if code == 0 and in_steps > 0.75:
        return 1
    if code == largest and in_steps < largest + 0.25:
        return largest - 1
    return code


@njit(cache=True)
def _quantise(ends, n_ends, mode, codes):
    """Fills codes; false where a difference from the first endpoint is too wide for the mode."""
    for e in range(n_ends):
        for c in range(3):
            codes[e, c] = _nearest_code(ends[e, c], _BASE_BITS[mode])
            if e > 0 and _TRANSFORMED[mode]:
                reach = 1 << (_DELTA_BITS[mode, c] - 1)
                delta = codes[e, c] - codes[0, c]
                if delta < -reach or delta >= reach:
                    return False
    return True


@njit(cache=True)
def _assign(half, metric, partition, codes, mode, scratch):
    """Gives every texel its nearest palette entry and returns the block's error."""
    palette, errors, index = scratch
    two = int(partition != WHOLE)
    for r in range(two + 1):
        for c in range(3):
            low = _unquantise(codes[2 * r, c], _BASE_BITS[mode])
            high = _unquantise(codes[2 * r + 1, c], _BASE_BITS[mode])
            for k in range(16 >> two):
                level = LEVELS[two, k]
                palette[r, c, k] = (((low * (64 - level) + high * level + 32) >> 6) * 31) >> 6
    total = 0.0
    for i in range(16):
        r = REGION[partition, i]
        n = 1 << INDEX_WIDTH[partition, i]  # anchors have half as many
        for k in range(n):  # becomes vector instructions: no branches, 32-bit floats
            x, y, z = (
                palette[r, 0, k] - half[i, 0],
                palette[r, 1, k] - half[i, 1],
                palette[r, 2, k] - half[i, 2],
            )
            errors[k] = metric[i, 0] * (x * x) + metric[i, 1] * (y * y) + metric[i, 2] * (z * z)
        best = 0
        for k in range(1, n):
            if errors[k] < errors[best]:
                best = k
        index[i] = best
        total += errors[best]
    return total


@njit(cache=True)
def _least_squares(target, metric, partition, index, ends):
    """The endpoints that fit best if the indices stay; an endpoint that no texel determines stays."""
    two = int(partition != WHOLE)
    for r in range(two + 1):
        for c in range(3):
            aa = ab = bb = a_t = b_t = 0.0
            for i in range(16):
                if REGION[partition, i] == r:
                    b = LEVELS[two, index[i]] / 64.0
                    a = 1.0 - b
                    weight = metric[i, c]
                    aa += weight * a * a
                    ab += weight * a * b
                    bb += weight * b * b
                    a_t += weight * a * target[i, c]
                    b_t += weight * b * target[i, c]
            determinant = aa * bb - ab * ab
            if determinant > 1e-6 * (aa + bb) * (aa + bb):
                ends[2 * r, c] = min(max((bb * a_t - ab * b_t) / determinant, 0.0), 65535.0)
                ends[2 * r + 1, c] = min(max((aa * b_t - ab * a_t) / determinant, 0.0), 65535.0)


@njit(cache=True, inline="always")
def _covariance(moments):
    """About the mean and times the weight, of weighted moments (w, x, y, z, xx, xy, xz, yy, yz, zz)."""
    w = max(moments[0], 1e-30)
    x, y, z = moments[1] / w, moments[2] / w, moments[3] / w
    xx, xy, xz = moments[4] - w * x * x, moments[5] - w * x * y, moments[6] - w * x * z
    yy, yz, zz = moments[7] - w * y * y, moments[8] - w * y * z, moments[9] - w * z * z
    return xx, xy, xz, yy, yz, zz


@njit(cache=True)
def _axis(moments, axis):
    """Fills axis (3,) with the principal one, of length 1, by power iteration."""
    xx, xy, xz, yy, yz, zz = _covariance(moments)
    # Starts from the covariance's longest row, which is never across the axis.
    u, v, t = xx, xy, xz
    if yy > xx and yy >= zz:
        u, v, t = xy, yy, yz
    elif zz > xx:
        u, v, t = xz, yz, zz
    for _ in range(_AXIS_STEPS):
        scale = max(abs(u), abs(v), abs(t), 1e-30)
        u, v, t = u / scale, v / scale, t / scale
        u, v, t = xx * u + xy * v + xz * t, xy * u + yy * v + yz * t, xz * u + yz * v + zz * t
    length = np.sqrt(u * u + v * v + t * t)
    if length > 1e-12:
        axis[0], axis[1], axis[2] = u / length, v / length, t / length
    else:
        axis[0] = axis[1] = axis[2] = 3.0**-0.5


@njit(cache=True)
def _moments(target, metric, moments):
    """Fills (16, 10) with each texel's part of the moments, weighted by the mean of its channels'."""
    for i in range(16):
        w = (metric[i, 0] + metric[i, 1] + metric[i, 2]) / 3.0
        x, y, z = target[i, 0], target[i, 1], target[i, 2]
        row = moments[i]
        row[0], row[1], row[2], row[3] = w, w * x, w * y, w * z
        row[4], row[5], row[6] = w * x * x, w * x * y, w * x * z
        row[7], row[8], row[9] = w * y * y, w * y * z, w * z * z


@njit(cache=True)
def _first_ends(target, moments, partition, ends):
    """Endpoints on each region's principal axis about its texels, the anchor's end first."""
    axis, total = np.empty(3), np.empty(10)
    for r in range(1 + int(partition != WHOLE)):
        for k in range(10):
            total[k] = 0.0
            for i in range(16):
                if REGION[partition, i] == r:
                    total[k] += moments[i, k]
        if total[0] <= 0.0:  # nothing here matters: be where no difference is needed
            for c in range(3):
                ends[2 * r, c] = ends[2 * r + 1, c] = ends[0, c] if r > 0 else 0.0
            continue
        _axis(total, axis)
        low, high, here = np.inf, -np.inf, 0.0
        for i in range(16):
            if REGION[partition, i] == r:
                along = 0.0
                for c in range(3):
                    along += axis[c] * (target[i, c] - total[1 + c] / total[0])
                if i == r * ANCHORS[partition]:
                    here = along
                if moments[i, 0] > 0.0:
                    low, high = min(low, along), max(high, along)
        if 2.0 * here > low + high:
            low, high = high, low
        for c in range(3):
            mean = total[1 + c] / total[0]
            ends[2 * r, c] = min(max(mean + low * axis[c], 0.0), 65535.0)
            ends[2 * r + 1, c] = min(max(mean + high * axis[c], 0.0), 65535.0)


@njit(cache=True)
def _partition_scores(moments, scores):
    """What each partition would leave: all that lies off its regions' axes, and index steps along them."""
    part = np.empty((2, 10))
    for p in range(N_PARTITIONS):
        for k in range(10):
            part[0, k] = part[1, k] = 0.0
        for i in range(16):
            for k in range(10):
                part[REGION[p, i], k] += moments[i, k]
        scores[p] = 0.0
        for r in range(2):
            xx, xy, xz, yy, yz, zz = _covariance(part[r])
            # The covariance's Frobenius norm stands for its largest eigenvalue: they differ little
            # where one partition is clearly better than another, and iterating took 3 times as long.
            off = xy * xy + xz * xz + yz * yz
            along = np.sqrt(xx * xx + yy * yy + zz * zz + 2.0 * off)
            scores[p] += xx + yy + zz - along + along / 49.0


@njit(cache=True)
def _fit(half, target, metric, moments, partition, scratch, best):
    """Fits one partition, or the whole block; what beats ``best`` replaces it.

    Args:
        half: (16, 3) bits of half floats, as float32.
        target: The same in the space of endpoints.
        metric: (16, 3) weights of squared errors.
        moments: (16, 10).
        partition: Number, or WHOLE.
        scratch: Palette (2, 3, 16) and errors (16,), float32, and index (16,).
        best: Error (1,), mode and partition (2,), codes (4, 3), index (16,).
    """
    index = scratch[2]
    best_error, best_head, best_codes, best_index = best
    two = int(partition != WHOLE)
    n_ends = 2 + 2 * two
    ends, codes = np.empty((4, 3)), np.empty((4, 3), np.int64)
    _first_ends(target, moments, partition, ends)
    for _ in range(_FITS):
        choice = 0
        while not _quantise(ends, n_ends, _ORDER[two, choice], codes):
            choice += 1
        mode = _ORDER[two, choice]
        error = _assign(half, metric, partition, codes, mode, scratch)
        if error < best_error[0]:
            best_error[0] = error
            best_head[0], best_head[1] = mode, partition
            for e in range(n_ends):
                for c in range(3):
                    best_codes[e, c] = codes[e, c]
            for i in range(16):
                best_index[i] = index[i]
        _least_squares(target, metric, partition, index, ends)


@njit(cache=True)
def _write_bits(out, at, value, n_bits):
    for bit in range(n_bits):
        if (value >> bit) & 1:
            out[(at + bit) >> 3] |= 1 << ((at + bit) & 7)


@njit(cache=True)
def _write_block(out, mode, partition, codes, index):
    """Fills 16 bytes that are 0."""
    _write_bits(out, 0, _CODE[mode], _CODE_BITS[mode])
    whole = partition == WHOLE
    if not whole:
        _write_bits(out, PARTITION_AT, partition, 5)
    for e in range(2 if whole else 4):
        for c in range(3):
            value = codes[e, c] - codes[0, c] if e > 0 and _TRANSFORMED[mode] else codes[e, c]
            for bit in range(16):
                at = BIT_POSITIONS[mode, e, c, bit]
                if at >= 0 and (value >> bit) & 1:
                    out[at >> 3] |= 1 << (at & 7)
    for i in range(16):
        _write_bits(out, INDEX_AT[partition, i], index[i], INDEX_WIDTH[partition, i])


@njit(cache=True)
def _encode_block(half_bits, metric, n_partitions, out):
    half, target, moments = np.empty((16, 3), np.float32), np.empty((16, 3)), np.empty((16, 10))
    weight = 0.0
    for i in range(16):
        for c in range(3):
            half[i, c] = half_bits[i, c]
            # The centre of the values that decode to these bits: bits = value · 31 >> 6.
            target[i, c] = (half_bits[i, c] * 64.0 + 31.5) / 31.0
            weight += metric[i, c]
    _moments(target, metric, moments)
    scratch = (np.empty((2, 3, 16), np.float32), np.empty(16, np.float32), np.empty(16, np.int64))
    error, head = np.array([np.inf]), np.array([_BLACK, WHOLE])
    codes, index = np.zeros((4, 3), np.int64), np.zeros(16, np.int64)
    best = (error, head, codes, index)
    partition = WHOLE
    scores = np.empty(N_PARTITIONS)
    for attempt in range(1 + n_partitions if weight > 0.0 else 0):
        if attempt == 1:
            if error[0] <= _GOOD_ENOUGH * weight:
                break
            _partition_scores(moments, scores)
        if attempt > 0:
            partition = 0
            for p in range(1, N_PARTITIONS):
                if scores[p] < scores[partition]:
                    partition = p
            scores[partition] = np.inf
        _fit(half, target, metric, moments, partition, scratch, best)
    _write_block(out, head[0], head[1], codes, index)


@njit(cache=True, nogil=True)
def encode_blocks(half_bits, metric, n_partitions, out):
    """Encodes blocks; threads may do so side by side.

    Args:
        half_bits: (N, 16, 3) uint16 bits of half floats from 0 to HALF_MAX_BITS.
        metric: (N, 16, 3) float32 weights of squared errors, 0 for texels that don't matter.
        n_partitions: How many of the 32 partitions are fitted, the likeliest first; 0 for one region only.
        out: (N, 16) uint8 of zeros.
    """
    for n in range(len(half_bits)):
        _encode_block(half_bits[n], metric[n], n_partitions, out[n])
