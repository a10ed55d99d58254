"""BC6H's fourteen modes, thirty-two partitions and index weights, as the decoder and the encoder read them.

This work is based on: EXT_texture_compression_bptc and its ARB forerunner, OpenGL registry, 2010, and
Khronos Data Format Specification 1.3, 2019, section 20.2. Modes have the order and numbers of Direct3D's
documentation, less one.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

BLOCK_BYTES = 16
TEXELS = 16
N_PARTITIONS = 32
INDEX_BITS = {1: 4, 2: 3}  # by the number of regions
INDICES_AT = {1: 65, 2: 82}
PARTITION_AT = 77
HALF_MAX_BITS = 0x7BFF  # 65504, the largest that the unsigned format decodes to

# The second endpoint's share in 64ths by index; a row for one region and, of eight, for two.
LEVELS = np.array(
    [
        [0, 4, 9, 13, 17, 21, 26, 30, 34, 38, 43, 47, 51, 55, 60, 64],
        [0, 9, 18, 27, 37, 46, 55, 64, -1, -1, -1, -1, -1, -1, -1, -1],
    ],
    np.int64,
)


@dataclass(frozen=True)
class Mode:
    """One way to spend a block's bits.

    Attributes:
        code: The block's first bits; two of them for codes 0 and 1, else five.
        n_regions: 1, or 2 with a partition.
        base_bits: Of the first endpoint, and of each where there are no deltas.
        delta_bits: Of the other endpoints, by channel; as wide as the base where they aren't deltas.
        transformed: Whether the other endpoints are stored as differences from the first.
        layout: The bits after the code in order. ``r0[9:0]`` is bits 0 to 9, lowest first, of red of
            endpoint 0; ``r0[10:11]`` is bit 11, then 10. Endpoints 0 and 1 bound region 0, 2 and 3 region 1.
    """

    code: int
    n_regions: int
    base_bits: int
    delta_bits: tuple[int, int, int]
    transformed: bool
    layout: str

    @property
    def code_bits(self) -> int:
        """How many bits the code takes."""
        return 2 if self.code < 2 else 5

    @property
    def n_endpoints(self) -> int:
        """Two for each region."""
        return 2 * self.n_regions


MODES = (
    Mode(0b00, 2, 10, (5, 5, 5), True,
         "g2[4] b2[4] b3[4] r0[9:0] g0[9:0] b0[9:0] r1[4:0] g3[4] g2[3:0] g1[4:0] b3[0] g3[3:0] b1[4:0] "
         "b3[1] b2[3:0] r2[4:0] b3[2] r3[4:0] b3[3]"),
    Mode(0b01, 2, 7, (6, 6, 6), True,
         "g2[5] g3[4] g3[5] r0[6:0] b3[0] b3[1] b2[4] g0[6:0] b2[5] b3[2] g2[4] b0[6:0] b3[3] b3[5] b3[4] "
         "r1[5:0] g2[3:0] g1[5:0] g3[3:0] b1[5:0] b2[3:0] r2[5:0] r3[5:0]"),
    Mode(0b00010, 2, 11, (5, 4, 4), True,
         "r0[9:0] g0[9:0] b0[9:0] r1[4:0] r0[10] g2[3:0] g1[3:0] g0[10] b3[0] g3[3:0] b1[3:0] b0[10] b3[1] "
         "b2[3:0] r2[4:0] b3[2] r3[4:0] b3[3]"),
    Mode(0b00110, 2, 11, (4, 5, 4), True,
         "r0[9:0] g0[9:0] b0[9:0] r1[3:0] r0[10] g3[4] g2[3:0] g1[4:0] g0[10] g3[3:0] b1[3:0] b0[10] b3[1] "
         "b2[3:0] r2[3:0] b3[0] b3[2] r3[3:0] g2[4] b3[3]"),
    Mode(0b01010, 2, 11, (4, 4, 5), True,
         "r0[9:0] g0[9:0] b0[9:0] r1[3:0] r0[10] b2[4] g2[3:0] g1[3:0] g0[10] b3[0] g3[3:0] b1[4:0] b0[10] "
         "b2[3:0] r2[3:0] b3[1] b3[2] r3[3:0] b3[4] b3[3]"),
    Mode(0b01110, 2, 9, (5, 5, 5), True,
         "r0[8:0] b2[4] g0[8:0] g2[4] b0[8:0] b3[4] r1[4:0] g3[4] g2[3:0] g1[4:0] b3[0] g3[3:0] b1[4:0] "
         "b3[1] b2[3:0] r2[4:0] b3[2] r3[4:0] b3[3]"),
    Mode(0b10010, 2, 8, (6, 5, 5), True,
         "r0[7:0] g3[4] b2[4] g0[7:0] b3[2] g2[4] b0[7:0] b3[3] b3[4] r1[5:0] g2[3:0] g1[4:0] b3[0] g3[3:0] "
         "b1[4:0] b3[1] b2[3:0] r2[5:0] r3[5:0]"),
    Mode(0b10110, 2, 8, (5, 6, 5), True,
         "r0[7:0] b3[0] b2[4] g0[7:0] g2[5] g2[4] b0[7:0] g3[5] b3[4] r1[4:0] g3[4] g2[3:0] g1[5:0] g3[3:0] "
         "b1[4:0] b3[1] b2[3:0] r2[4:0] b3[2] r3[4:0] b3[3]"),
    Mode(0b11010, 2, 8, (5, 5, 6), True,
         "r0[7:0] b3[1] b2[4] g0[7:0] b2[5] g2[4] b0[7:0] b3[5] b3[4] r1[4:0] g3[4] g2[3:0] g1[4:0] b3[0] "
         "g3[3:0] b1[5:0] b2[3:0] r2[4:0] b3[2] r3[4:0] b3[3]"),
    Mode(0b11110, 2, 6, (6, 6, 6), False,
         "r0[5:0] g3[4] b3[0] b3[1] b2[4] g0[5:0] g2[5] b2[5] b3[2] g2[4] b0[5:0] g3[5] b3[3] b3[5] b3[4] "
         "r1[5:0] g2[3:0] g1[5:0] g3[3:0] b1[5:0] b2[3:0] r2[5:0] r3[5:0]"),
    Mode(0b00011, 1, 10, (10, 10, 10), False,
         "r0[9:0] g0[9:0] b0[9:0] r1[9:0] g1[9:0] b1[9:0]"),
    Mode(0b00111, 1, 11, (9, 9, 9), True,
         "r0[9:0] g0[9:0] b0[9:0] r1[8:0] r0[10] g1[8:0] g0[10] b1[8:0] b0[10]"),
    Mode(0b01011, 1, 12, (8, 8, 8), True,
         "r0[9:0] g0[9:0] b0[9:0] r1[7:0] r0[10:11] g1[7:0] g0[10:11] b1[7:0] b0[10:11]"),
    Mode(0b01111, 1, 16, (4, 4, 4), True,
         "r0[9:0] g0[9:0] b0[9:0] r1[3:0] r0[10:15] g1[3:0] g0[10:15] b1[3:0] b0[10:15]"),
)  # fmt: skip

WHOLE = N_PARTITIONS  # the row of blocks with one region, in tables by partition
# Bit i of a mask: texel i, row by row, lies in region 1.
_PARTITION_MASKS = (
    *(0xCCCC, 0x8888, 0xEEEE, 0xECC8, 0xC880, 0xFEEC, 0xFEC8, 0xEC80),
    *(0xC800, 0xFFEC, 0xFE80, 0xE800, 0xFFE8, 0xFF00, 0xFFF0, 0xF000),
    *(0xF710, 0x008E, 0x7100, 0x08CE, 0x008C, 0x7310, 0x3100, 0x8CCE),
    *(0x088C, 0x3110, 0x6666, 0x366C, 0x17E8, 0x0FF0, 0x718E, 0x399C),
    0x0000,
)
# Region 1's texel whose index is stored without its highest bit, which is 0; region 0's is texel 0.
ANCHORS = np.array([15] * 17 + [2, 8, 2, 2, 8, 8, 15, 2, 8, 2, 2, 8, 8, 2, 2, 0], np.int64)
REGION = (np.array(_PARTITION_MASKS)[:, None] >> np.arange(TEXELS) & 1).astype(np.int64)


def _bit_positions(mode: Mode) -> NDArray[np.int64]:
    """(4, 3, 16): where in the block each bit of each endpoint's channel lies; −1 where it isn't stored."""
    positions = np.full((4, 3, 16), -1, np.int64)
    at = mode.code_bits
    for item in mode.layout.split():
        name, bits = item[:-1].split("[")
        high, _, low = bits.partition(":")
        first, last = int(low or high), int(high)
        step = 1 if first <= last else -1
        for bit in range(first, last + step, step):
            positions[int(name[1]), "rgb".index(name[0]), bit] = at
            at += 1
    return positions


def _index_positions() -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """(33, 16) each: the first bits and the widths of texels' indices, by partition."""
    starts, widths = np.empty((2, N_PARTITIONS + 1, TEXELS), np.int64)
    for row in range(N_PARTITIONS + 1):
        n_regions = 1 if row == WHOLE else 2
        widths[row] = INDEX_BITS[n_regions]
        widths[row, [0, ANCHORS[row]]] -= 1
        starts[row] = INDICES_AT[n_regions] + np.cumsum(widths[row]) - widths[row]
    return starts, widths


BIT_POSITIONS = np.stack([_bit_positions(mode) for mode in MODES])
INDEX_AT, INDEX_WIDTH = _index_positions()
