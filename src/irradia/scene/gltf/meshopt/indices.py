"""Modes 1 and 2: triangles by the edges and vertices met last, and plain index sequences."""

from __future__ import annotations

import numpy as np
from numba import njit

from irradia.scene.types import U8, U32

_MASK = 0xFFFFFFFF
_CODEAUX_BYTES = 16
_SEQUENCE_TAIL_BYTES = 4


def decode_triangles(stream: U8, count: int) -> U32:
    """(count,) indices of a triangle list.

    Raises:
        ValueError: The stream is damaged.
    """
    if len(stream) < 1 + count // 3 + _CODEAUX_BYTES or stream[0] != 0xE1:
        raise ValueError("its header is not 0xe1, or it is too short")
    out = np.empty(count, np.uint32)
    _decode_triangles(stream, out)
    return out


def decode_index_sequence(stream: U8, count: int) -> U32:
    """(count,) indices of any topology.

    Raises:
        ValueError: The stream is damaged.
    """
    if len(stream) < 1 + count + _SEQUENCE_TAIL_BYTES or stream[0] != 0xD1:
        raise ValueError("its header is not 0xd1, or it is too short")
    out = np.empty(count, np.uint32)
    _decode_sequence(stream, out)
    return out


@njit(cache=True)
def _read_varint(stream, position, end):
    """An unsigned LEB128 number of at most 5 bytes, and the position after it."""
    value = 0
    for i in range(5):
        if position >= end:
            raise ValueError("it ends within a number")
        byte = int(stream[position])
        position += 1
        value |= (byte & 0x7F) << (7 * i)
        if byte < 0x80:
            return value & _MASK, position
    raise ValueError("a number has more than 5 bytes")


@njit(cache=True)
def _unzigzag(value):
    return (value >> 1) ^ -(value & 1)


@njit(cache=True)
def _decode_sequence(stream, out):
    end = len(stream) - _SEQUENCE_TAIL_BYTES
    position = 1
    last = np.zeros(2, np.int64)  # two baselines: one for each of two interleaved runs
    for i in range(len(out)):
        value, position = _read_varint(stream, position, end)
        last[value & 1] = (last[value & 1] + _unzigzag(value >> 1)) & _MASK
        out[i] = last[value & 1]
    if position != end:
        raise ValueError("bytes are left over")


@njit(cache=True)
def _decode_triangles(stream, out):
    # ---- State ------------------------------------------------------------------------------
    n_triangles = len(out) // 3
    end = len(stream) - _CODEAUX_BYTES
    position = 1 + n_triangles  # in the extra data after the codes
    edges = np.full((16, 2), _MASK, np.int64)  # ring of the edges met last
    vertices = np.full(16, _MASK, np.int64)  # ring of the vertices met last
    n_edges, n_vertices = 0, 0  # pushed so far
    following = 0  # the next index that was never used
    last = 0  # baseline of explicit indices

    for triangle in range(n_triangles):
        code = int(stream[1 + triangle])
        low = code & 15

        # ---- An edge met before, and one more vertex ----------------------------------------
        if code < 0xF0:
            a, b = edges[(n_edges - 1 - (code >> 4)) & 15]
            if low == 0:
                c = following
                following += 1
            elif low < 0xD:
                c = vertices[(n_vertices - 1 - low) & 15]
            else:
                if low == 0xF:
                    value, position = _read_varint(stream, position, end)
                    last = (last + _unzigzag(value)) & _MASK
                else:
                    last = (last + (1 if low == 0xE else -1)) & _MASK
                c = last
            if low == 0 or low >= 0xD:
                vertices[n_vertices & 15] = c
                n_vertices += 1

        # ---- Three vertices of their own ----------------------------------------------------
        else:
            if code < 0xFE:
                recipe = int(stream[end + low])
            else:
                if position >= end:
                    raise ValueError("it ends within a triangle")
                recipe = int(stream[position])
                position += 1
                if recipe == 0:
                    following = 0
            if code < 0xFF:
                a = following
                following += 1
            else:
                value, position = _read_varint(stream, position, end)
                last = (last + _unzigzag(value)) & _MASK
                a = last
            of_b, of_c = recipe >> 4, recipe & 15
            if of_b == 0:
                b = following
                following += 1
            elif of_b < 0xF:
                b = vertices[(n_vertices - of_b) & 15]
            else:
                value, position = _read_varint(stream, position, end)
                last = (last + _unzigzag(value)) & _MASK
                b = last
            if of_c == 0:
                c = following
                following += 1
            elif of_c < 0xF:
                c = vertices[(n_vertices - of_c) & 15]
            else:
                value, position = _read_varint(stream, position, end)
                last = (last + _unzigzag(value)) & _MASK
                c = last
            vertices[n_vertices & 15] = a
            n_vertices += 1
            if of_b == 0 or of_b == 0xF:
                vertices[n_vertices & 15] = b
                n_vertices += 1
            if of_c == 0 or of_c == 0xF:
                vertices[n_vertices & 15] = c
                n_vertices += 1
            edges[n_edges & 15, 0], edges[n_edges & 15, 1] = b, a
            n_edges += 1

        # ---- Its two new edges, and out -----------------------------------------------------
        edges[n_edges & 15, 0], edges[n_edges & 15, 1] = c, b
        n_edges += 1
        edges[n_edges & 15, 0], edges[n_edges & 15, 1] = a, c
        n_edges += 1
        out[3 * triangle], out[3 * triangle + 1], out[3 * triangle + 2] = a, b, c
    if position != end:
        raise ValueError("bytes are left over")
