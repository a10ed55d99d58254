"""Khronos data format descriptors of the three HDR texel layouts, as KTX2 carries them.

This work is based on: Khronos Data Format Specification 1.3, 2019, section 5 (basic descriptor block).
"""

from __future__ import annotations

import struct
from dataclasses import dataclass
from typing import Literal

_BASIC_VERSION = 2
_MODEL_RGBSDA, _MODEL_BC6H = 1, 133
_PRIMARIES_BT709, _TRANSFER_LINEAR, _ALPHA_STRAIGHT = 1, 1, 0
_RED, _GREEN, _BLUE, _ALPHA = 0, 1, 2, 15
_EXPONENT, _SIGNED, _FLOAT = 0x20, 0x40, 0x80
_MINUS_ONE_F32, _ONE_F32 = 0xBF800000, 0x3F800000
# A mantissa's "1.0" in the specification's RGB9E5 example, and the exponent's bias and largest code.
_MANTISSA_UPPER, _EXPONENT_BIAS, _EXPONENT_MAX = 8448, 15, 31


@dataclass(frozen=True)
class _Sample:
    """One channel's bits within a texel."""

    offset: int
    bits: int
    channel: int
    lower: int
    upper: int

    def pack(self) -> bytes:
        return struct.pack("<HBBIII", self.offset, self.bits - 1, self.channel, 0, self.lower, self.upper)


@dataclass(frozen=True)
class _Layout:
    """A texel, or a block of texels."""

    model: int
    block_side_px: int
    block_bytes: int
    samples: tuple[_Sample, ...]


def data_format_descriptor(encoding: Literal["half", "rgb9e5", "bc6h"]) -> bytes:
    """The descriptor with its leading total size; linear Rec.709, straight alpha."""
    layout = _LAYOUTS[encoding]
    block_size = 24 + 16 * len(layout.samples)
    colour = struct.pack("<4B", layout.model, _PRIMARIES_BT709, _TRANSFER_LINEAR, _ALPHA_STRAIGHT)
    block = (
        struct.pack("<IHH", 0, _BASIC_VERSION, block_size)
        + colour
        + bytes([layout.block_side_px - 1, layout.block_side_px - 1, 0, 0])
        + bytes([layout.block_bytes, 0, 0, 0, 0, 0, 0, 0])
        + b"".join(sample.pack() for sample in layout.samples)
    )
    return struct.pack("<I", 4 + len(block)) + block


_HALF_RGBA = tuple(
    _Sample(16 * index, 16, channel | _SIGNED | _FLOAT, _MINUS_ONE_F32, _ONE_F32)
    for index, channel in enumerate((_RED, _GREEN, _BLUE, _ALPHA))
)
_RGB9E5 = tuple(
    sample
    for index, channel in enumerate((_RED, _GREEN, _BLUE))
    for sample in (
        _Sample(9 * index, 9, channel, 0, _MANTISSA_UPPER),
        _Sample(27, 5, channel | _EXPONENT, _EXPONENT_BIAS, _EXPONENT_MAX),
    )
)
_BC6H = (_Sample(0, 128, _RED | _FLOAT, 0, _ONE_F32),)
_LAYOUTS = {
    "half": _Layout(_MODEL_RGBSDA, 1, 8, _HALF_RGBA),
    "rgb9e5": _Layout(_MODEL_RGBSDA, 1, 4, _RGB9E5),
    "bc6h": _Layout(_MODEL_BC6H, 4, 16, _BC6H),
}
