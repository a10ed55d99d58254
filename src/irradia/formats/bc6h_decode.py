"""The reference decoder of unsigned BC6H blocks: all fourteen modes, in NumPy."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from irradia.formats.bc6h_tables import (
    BIT_POSITIONS,
    INDEX_AT,
    INDEX_WIDTH,
    LEVELS,
    MODES,
    PARTITION_AT,
    REGION,
    WHOLE,
    Mode,
)

I64 = NDArray[np.int64]
_RESERVED = -1


def half_bits_from_blocks(blocks: NDArray[np.uint8]) -> NDArray[np.uint16]:
    """(N, 16) bytes to (N, 16, 3) bits of half floats, texels row by row.

    Blocks with one of the four reserved codes are black, as the specification has it.
    """
    bits = np.unpackbits(blocks, axis=1, bitorder="little")
    texels = np.zeros((len(blocks), 16, 3), np.uint16)
    mode_of = _MODE_OF_CODE[_number(bits, np.arange(5))]
    for index, mode in enumerate(MODES):
        rows = np.flatnonzero(mode_of == index)
        if len(rows):
            texels[rows] = _decode(bits[rows], mode, BIT_POSITIONS[index])
    return texels


def unquantise(codes: I64, n_bits: int) -> I64:
    """Endpoint codes of ``n_bits`` to the 16-bit space in which blocks interpolate."""
    if n_bits >= 15:
        return codes
    spread = ((codes << 16) + 0x8000) >> n_bits
    return np.where(codes == 0, 0, np.where(codes == (1 << n_bits) - 1, 0xFFFF, spread))


def _decode(bits: NDArray[np.uint8], mode: Mode, positions: I64) -> NDArray[np.uint16]:
    """(K, 16, 3) of blocks that have one mode."""
    endpoints = unquantise(_endpoint_codes(bits, mode, positions), mode.base_bits)
    partition = np.full(len(bits), WHOLE)
    if mode.n_regions == 2:
        partition = _number(bits, PARTITION_AT + np.arange(5))
    region = REGION[partition]
    weight = LEVELS[mode.n_regions - 1][_indices(bits, partition)][..., None]
    rows = np.arange(len(bits))[:, None]
    low, high = endpoints[rows, 2 * region], endpoints[rows, 2 * region + 1]
    mixed = (low * (64 - weight) + high * weight + 32) >> 6
    return ((mixed * 31) >> 6).astype(np.uint16)


def _endpoint_codes(bits: NDArray[np.uint8], mode: Mode, positions: I64) -> I64:
    """(K, endpoints, 3), differences added to the first endpoint."""
    stored = positions[: mode.n_endpoints]
    present = (stored >= 0).astype(np.int64) << np.arange(16)
    codes = (bits[:, np.maximum(stored, 0)] * present).sum(axis=-1)
    if mode.transformed:
        sign = 1 << (np.array(mode.delta_bits, np.int64) - 1)
        deltas = (codes[:, 1:] ^ sign) - sign
        codes[:, 1:] = (codes[:, :1] + deltas) & ((1 << mode.base_bits) - 1)
    return codes


def _indices(bits: NDArray[np.uint8], partition: I64) -> I64:
    """(K, 16); an anchor's highest bit isn't stored and is 0."""
    at, width = INDEX_AT[partition], INDEX_WIDTH[partition]
    rows = np.arange(len(bits))[:, None]
    index = np.zeros(at.shape, np.int64)
    for bit in range(4):
        stored = bits[rows, np.minimum(at + bit, 127)].astype(np.int64) << bit
        index += np.where(bit < width, stored, 0)
    return index


def _number(bits: NDArray[np.uint8], positions: I64) -> I64:
    """(K,) numbers whose bits lie at ``positions``, lowest first."""
    return (bits[:, positions].astype(np.int64) << np.arange(len(positions))).sum(axis=1)


def _mode_of_code() -> I64:
    """(32,): the mode that a block's first five bits name."""
    table = np.full(32, _RESERVED, np.int64)
    for index, mode in enumerate(MODES):
        step = 1 << mode.code_bits
        table[mode.code :: step] = index
    return table


_MODE_OF_CODE = _mode_of_code()
