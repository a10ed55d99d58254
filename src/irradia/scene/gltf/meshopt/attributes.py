"""Mode 0, attributes: bytes of equal rank side by side, as differences, packed in groups of 16."""

from __future__ import annotations

import numpy as np
from numba import njit

from irradia.scene.types import U8

_GROUP = 16
_BLOCK_BYTES = 8192
# Bits per difference that a group's 2-bit header selects: version 0, then version 1's control 0 and 1.
_BITS = np.array([[0, 2, 4, 8], [0, 1, 2, 4], [1, 2, 4, 8]], np.int64)
_ALL_ZERO, _LITERAL = 2, 3


def decode_attributes(stream: U8, count: int, stride: int) -> U8:
    """(count, stride) bytes.

    Raises:
        ValueError: The stream is damaged.
    """
    version = int(stream[0]) - 0xA0 if len(stream) else -1
    if version not in (0, 1):
        raise ValueError("its header is not 0xa0 or 0xa1")
    n_modes = stride // 4 if version else 0
    tail = max(stride + n_modes, 24 if version else 32)
    if len(stream) < 1 + tail:
        raise ValueError("it ends before its tail")
    baseline = stream[len(stream) - n_modes - stride : len(stream) - n_modes]
    modes = stream[len(stream) - n_modes :] if version else np.zeros(stride // 4, np.uint8)
    if np.any((modes & 15) > 2) or np.any(((modes & 15) < 2) & (modes > 15)):
        raise ValueError("its tail holds an unknown channel mode")
    out = np.empty((count, stride), np.uint8)
    _decode_blocks(stream, len(stream) - tail, version, baseline, modes, out)
    return out


@njit(cache=True)
def _decode_blocks(stream, end, version, baseline, modes, out):
    """Fills ``out`` block by block."""
    count, stride = out.shape
    block_size = min(_BLOCK_BYTES // stride & ~(_GROUP - 1), 256)
    deltas = np.zeros((stride, block_size), np.uint8)
    previous = baseline.copy()
    position = 1
    for first in range(0, count, block_size):
        n_elements = min(block_size, count - first)
        controls = position
        if version:
            position += stride // 4
            if position > end:
                raise ValueError("it ends within a control header")
        for rank in range(stride):
            control = -1
            if version:
                control = (int(stream[controls + rank // 4]) >> (rank % 4 * 2)) & 3
            position = _decode_rank(stream, position, end, control, n_elements, deltas[rank])
        for channel in range(stride // 4):
            _undo_differences(
                deltas[channel * 4 : channel * 4 + 4],
                int(modes[channel]),
                previous[channel * 4 : channel * 4 + 4],
                out[first : first + n_elements, channel * 4 : channel * 4 + 4],
            )
    if position != end:
        raise ValueError("bytes are left over")


@njit(cache=True)
def _decode_rank(stream, position, end, control, n_elements, deltas):
    """Differences of the bytes of one rank in a block; returns where it ends in the stream."""
    if control == _ALL_ZERO:
        deltas[:n_elements] = 0
        return position
    if control == _LITERAL:
        if position + n_elements > end:
            raise ValueError("it ends within literal bytes")
        deltas[:n_elements] = stream[position : position + n_elements]
        return position + n_elements
    n_groups = (n_elements + _GROUP - 1) // _GROUP
    headers = position
    position += (n_groups + 3) // 4
    if position > end:
        raise ValueError("it ends within a header")
    for group in range(n_groups):
        selector = (int(stream[headers + group // 4]) >> (group % 4 * 2)) & 3
        bits = _BITS[control + 1, selector]
        position = _decode_group(stream, position, end, bits, deltas[group * _GROUP : (group + 1) * _GROUP])
    return position


@njit(cache=True)
def _decode_group(stream, position, end, bits, deltas):
    """16 differences of ``bits`` each; one with all bits set stands for a whole byte further on."""
    if bits == 0:
        deltas[:] = 0
        return position
    packed = position
    position += 2 * bits
    if position > end:
        raise ValueError("it ends within a group")
    sentinel = (1 << bits) - 1
    per_byte = 8 // bits
    for i in range(_GROUP):
        slot = i % per_byte
        # One-bit groups start at the lowest bit, the others at the highest.
        shift = slot if bits == 1 else (per_byte - 1 - slot) * bits
        value = (int(stream[packed + i // per_byte]) >> shift) & sentinel
        if value == sentinel and bits < 8:
            if position >= end:
                raise ValueError("it ends within a group")
            value = int(stream[position])
            position += 1
        deltas[i] = value
    return position


@njit(cache=True)
def _undo_differences(deltas, mode, previous, out):
    """Sums up a channel of 4 bytes; ``previous`` is left at the last element."""
    kind, turn = mode & 15, mode >> 4
    for i in range(len(out)):
        if kind == 0:  # four differences of bytes
            for k in range(4):
                delta = int(deltas[k, i])
                step = (delta >> 1) ^ -(delta & 1)
                previous[k] = (int(previous[k]) + step) & 0xFF
        elif kind == 1:  # two differences of 16 bits
            for k in range(0, 4, 2):
                delta = int(deltas[k, i]) | int(deltas[k + 1, i]) << 8
                step = (delta >> 1) ^ -(delta & 1)
                value = (int(previous[k]) | int(previous[k + 1]) << 8) + step
                previous[k] = value & 0xFF
                previous[k + 1] = (value >> 8) & 0xFF
        else:  # 32 bits that differ; the encoder turned them left, as the specification's formula does
            delta = 0
            for k in range(4):
                delta |= int(deltas[k, i]) << (8 * k)
            delta = (delta >> turn) | (delta << ((32 - turn) & 31))
            for k in range(4):
                previous[k] = int(previous[k]) ^ ((delta >> (8 * k)) & 0xFF)
        out[i] = previous
