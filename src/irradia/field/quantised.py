"""Tables of features in 8 or 4 bits: codes times scales.

A tensor is cut into blocks of consecutive values; a block has one scale, a half float, and each of its values
a code from −127 to 127, or from −7 to 7: value = code · scale. Codes are signed bytes, or two to a byte with
8 added to each, the first in the lower four bits.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from irradia.core.errors import InputError
from irradia.field.field import Field

Bits = Literal[4, 8]
F32 = NDArray[np.float32]

LARGEST_CODE: dict[Bits, int] = {4: 7, 8: 127}
_NIBBLE_BIAS = 8
# Scales are sought among these shares of the one that reaches a block's largest value: few bits gain by
# clipping what is rare. A block's scale is sought on so many of its values.
_CLIPS: dict[Bits, tuple[float, ...]] = {
    8: (1.0, 0.9, 0.8, 0.7, 0.6),
    4: (1.0, 0.9, 0.8, 0.7, 0.6, 0.5, 0.42, 0.35, 0.3, 0.25, 0.2, 0.17, 0.14, 0.12, 0.1),
}
_SOUGHT_ON = 1 << 14


@dataclass(frozen=True)
class QuantisedTensor:
    """One tensor of a table.

    Attributes:
        codes: int8, of the tensor's shape.
        scales: (blocks,) float16.
        bits: 4 or 8.
        block: Values of a block; the last may have fewer.
    """

    codes: NDArray[np.int8]
    scales: NDArray[np.float16]
    bits: Bits
    block: int

    def values(self) -> F32:
        """What it stands for, of the tensor's shape."""
        scales = np.repeat(self.scales.astype(np.float32), min(self.block, self.codes.size))[
            : self.codes.size
        ]
        return self.codes.astype(np.float32) * scales.reshape(self.codes.shape)

    def stored_codes(self) -> NDArray[np.int8] | NDArray[np.uint8]:
        """As files hold them: (…) int8, or (bytes,) uint8."""
        return self.codes if self.bits == 8 else pack_nibbles(self.codes)


@dataclass(frozen=True)
class QuantisedField:
    """A field some of whose tensors are codes.

    Attributes:
        field: With the values that the codes stand for; everything else is rounded to halves.
        tensors: The codes, by names such as ``position.level.0``.
    """

    field: Field
    tensors: Mapping[str, QuantisedTensor]


def quantise(values: F32, bits: Bits, block: int) -> QuantisedTensor:
    """The codes and scales nearest to a tensor, by squared error in each block.

    Args:
        values: Of any shape.
        bits: 4 or 8.
        block: Values that share a scale, consecutive in memory.
    """
    rows = _blocks(np.asarray(values, np.float32), block)
    largest = np.abs(rows).max(axis=1, keepdims=True)
    some = rows[:, :: -(-rows.shape[1] // _SOUGHT_ON) | 1]  # odd, to meet all features of an entry
    scales = np.zeros(largest.shape, np.float16)
    least = np.full(largest.shape, np.inf, np.float32)
    for clip in _CLIPS[bits]:
        tried = _half(largest * np.float32(clip / LARGEST_CODE[bits]))
        error = np.square(_codes(some, tried, bits) * tried.astype(np.float32) - some)
        error = error.sum(axis=1, keepdims=True)
        scales = np.where(error < least, tried, scales)
        least = np.minimum(error, least)
    codes = _codes(rows, scales, bits).reshape(-1)[: values.size].reshape(values.shape)
    return QuantisedTensor(codes, scales[:, 0], bits, block)


def unquantised(
    codes: NDArray[np.int8] | NDArray[np.uint8],
    scales: NDArray[np.float16],
    bits: Bits,
    block: int,
    shape: tuple[int, ...],
    where: str,
) -> QuantisedTensor:
    """A tensor from what a file holds.

    Raises:
        InputError: Its parts don't have the sizes or types that the shape asks for.
    """
    size = math.prod(shape)
    n_blocks = -(-size // block)
    kind, n_codes = (np.int8, shape) if bits == 8 else (np.uint8, (-(-size // 2),))
    if codes.dtype != kind or codes.shape != n_codes:
        raise InputError(
            f"expected codes {n_codes} of {np.dtype(kind)}, found {codes.shape} of {codes.dtype}", where=where
        )
    if scales.dtype != np.float16 or scales.shape != (n_blocks,):
        raise InputError(
            f"expected {n_blocks} half scales, found {scales.shape} of {scales.dtype}", where=where
        )
    signed = codes.view(np.int8) if bits == 8 else unpack_nibbles(codes.view(np.uint8), size)
    return QuantisedTensor(signed.reshape(shape), scales, bits, block)


def pack_nibbles(codes: NDArray[np.int8]) -> NDArray[np.uint8]:
    """Two codes of −8 to 7 to a byte, the first in the lower bits; an odd one is followed by 0."""
    biased = (codes.reshape(-1) + _NIBBLE_BIAS).astype(np.uint8)
    if biased.size % 2:
        biased = np.append(biased, np.uint8(_NIBBLE_BIAS))
    return (biased[0::2] | (biased[1::2] << 4)).astype(np.uint8)


def unpack_nibbles(packed: NDArray[np.uint8], size: int) -> NDArray[np.int8]:
    """The first ``size`` codes of :func:`pack_nibbles`."""
    pairs = np.stack([packed & 15, packed >> 4], axis=-1)
    return (pairs.reshape(-1)[:size].astype(np.int8)) - np.int8(_NIBBLE_BIAS)


def _blocks(values: F32, block: int) -> F32:
    """(blocks, block), padded with zeros, which cost nothing."""
    flat = values.reshape(-1)
    return np.pad(flat, (0, -flat.size % block)).reshape(-1, block)


def _half(scales: F32) -> NDArray[np.float16]:
    """Rounded to halves, but never from something to nothing, nor to infinity."""
    tiny = np.float32(np.finfo(np.float16).smallest_subnormal)
    kept = np.where(scales > 0.0, np.clip(scales, tiny, np.float32(65504.0)), np.float32(0.0))
    return kept.astype(np.float16)


def _codes(rows: F32, scales: NDArray[np.float16], bits: Bits) -> NDArray[np.int8]:
    steps = scales.astype(np.float32)
    with np.errstate(divide="ignore"):
        inverse = np.where(steps > 0.0, np.float32(1.0) / steps, np.float32(0.0))
    largest = LARGEST_CODE[bits]
    return np.clip(np.rint(rows * inverse), -largest, largest).astype(np.int8)
