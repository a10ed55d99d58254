"""The Unity project's weight file: golden bytes, sizes inferred from its own figures, damage refused."""

from __future__ import annotations

import math
import struct
from dataclasses import replace

import numpy as np
import pytest

from irradia.core.errors import InputError
from irradia.formats.field_bin import (
    FREQUENCY,
    HASH,
    TRI_PLANE,
    BinHeader,
    decode_field_bin,
    encode_field_bin,
    layer_sizes,
)

BOX = np.array([(-1, 0, 0.5), (1, 2, 4.5)], np.float32)
SMALL = BinHeader(TRI_PLANE, 2, 0, 1, (0.0, 0.0), 4, 1, BOX)
PLANES = np.arange(12, dtype=np.float16) / 8
NETWORK = np.arange(4 * 8 + 4 + 4 * 4 + 4, dtype=np.float16) / 16  # 3 features and a normal, padded to 8
GOLDEN = (
    struct.pack("<4I2f2I6f", 1, 2, 0, 1, 0, 0, 4, 1, -1, 0, 0.5, 1, 2, 4.5)
    + struct.pack("<12e", *(i / 8 for i in range(12)))
    + struct.pack("<56e", *(i / 16 for i in range(56)))
)


def test_bytes_are_golden() -> None:
    assert encode_field_bin(SMALL, PLANES, NETWORK) == GOLDEN
    assert len(GOLDEN) == 56 + 2 * (12 + 56)


def test_file_comes_apart_into_what_was_put_in() -> None:
    found = decode_field_bin(GOLDEN)
    np.testing.assert_array_equal(found.encoding, PLANES)
    np.testing.assert_array_equal(found.network, NETWORK)
    assert (found.n_inputs, found.n_outputs) == (8, 4)
    assert replace(found.header, aabb=BOX) == SMALL
    np.testing.assert_array_equal(found.header.aabb, BOX)


# Its published results: parameters of fields of 12 SH coefficients, without padding.
TABLE = [
    (BinHeader(TRI_PLANE, 64, 0, 8, (0, 0), 32, 2, BOX), 100_556),
    (BinHeader(TRI_PLANE, 128, 0, 16, (0, 0), 64, 2, BOX), 794_508),
    (BinHeader(TRI_PLANE, 256, 0, 32, (0, 0), 64, 3, BOX), 6_306_764),
    (BinHeader(HASH, 8, 1 << 17, 2, (16, 512), 32, 2, BOX), 2_099_148),
    (BinHeader(HASH, 16, 1 << 19, 2, (16, 2048), 64, 2, BOX), 16_784_268),
    (BinHeader(HASH, 16, 1 << 21, 2, (16, 4096), 64, 3, BOX), 67_120_076),
]


@pytest.mark.parametrize(("header", "n_parameters"), TABLE)
def test_its_own_figures_give_its_own_sizes(header: BinHeader, n_parameters: int) -> None:
    n_network = n_parameters - header.n_encoding
    assert layer_sizes(n_network, header, "") == (header.n_features, 12)


def n_halves(i: int, h: int, layers: int, o: int) -> int:
    return h * i + h + (layers - 1) * (h * h + h) + o * h + o


@pytest.mark.parametrize("width", [4, 12, 16, 20, 32, 64, 128])
@pytest.mark.parametrize("layers", [1, 2, 6])
@pytest.mark.parametrize("n_outputs", [3, 4, 12, 16])
@pytest.mark.parametrize("pad", [False, True])
def test_inputs_and_outputs_follow_from_the_size(width: int, layers: int, n_outputs: int, pad: bool) -> None:
    header = BinHeader(FREQUENCY, 5, 0, 1, (0, 0), width, layers, BOX)
    n_inputs = 33 + (3 if n_outputs <= 4 else 0)
    n_inputs = -(-n_inputs // 4) * 4 if pad else n_inputs
    found = layer_sizes(n_halves(n_inputs, width, layers, n_outputs), header, "")
    assert found == (n_inputs, n_outputs)


def test_normal_of_four_numbers_is_told_from_padding() -> None:
    header = BinHeader(FREQUENCY, 5, 0, 1, (0, 0), 32, 2, BOX)
    assert layer_sizes(n_halves(33 + 4, 32, 2, 3), header, "") == (37, 3)


def patched(offset: int, kind: str, *values: float) -> bytes:
    data = bytearray(GOLDEN)
    struct.pack_into(f"<{kind}", data, offset, *values)
    return bytes(data)


def hashed(levels: int = 2, entries: int = 8, features: int = 2, low: float = 4, high: float = 8) -> bytes:
    return struct.pack("<4I2f2I6f", 0, levels, entries, features, low, high, 4, 1, -1, 0, 0, 1, 2, 4)


DAMAGED = [
    (b"", "header of 56 bytes, found 0"),
    (b"levels = 16\n", "found 12"),
    (b"a field of light, written down as text that is quite long enough", "encoding of 0, 1 or 2"),
    (GOLDEN[:55], "found 55"),
    (GOLDEN[:56], "expected over 80 bytes"),
    (GOLDEN[:81], "odd number"),
    (GOLDEN[:-2], "no network of 1 hidden layers of 4"),
    (GOLDEN + b"\0\0", "no network"),
    (patched(0, "I", 3), "encoding of 0, 1 or 2, found 3"),
    (patched(4, "I", 1), "planes of 2 to 8192"),
    (patched(4, "I", 0xFFFFFFFF), "planes of 2"),
    (patched(4, "I", 8192), "expected over"),
    (patched(12, "I", 0), "features a plane"),
    (patched(12, "I", 0xFFFFFFFF), "features a plane"),
    (patched(24, "I", 0), "hidden units, found 0"),
    (patched(24, "I", 0xFFFFFFFF), "hidden units"),
    (patched(28, "I", 0), "hidden layers, found 0"),
    (patched(28, "I", 7), "hidden layers, found 7"),
    (patched(32, "f", math.nan), "AABB"),
    (patched(44, "f", -2.0), "AABB"),
    (patched(60, "H", 0x7E00), "not numbers"),
    (patched(100, "H", 0x7C00), "infinite"),
    (hashed(levels=33), "1 to 32 levels"),
    (hashed(entries=12), "power of two, found 12"),
    (hashed(entries=0), "power of two, found 0"),
    (hashed(entries=1 << 29), "power of two"),
    (hashed(features=17), "1 to 16 features"),
    (hashed(low=9), "resolutions 9.0 to 8.0"),
    (hashed(low=math.nan), "resolutions nan"),
    (hashed(high=math.inf), "resolutions 4.0 to inf"),
    (hashed(levels=32, entries=1 << 28, features=16), "expected over"),
    (struct.pack("<4I2f2I6f", 2, 25, 0, 0, 0, 0, 4, 1, *[0] * 6), "1 to 24 frequencies"),
    (struct.pack("<4I2f2I6f", 2, 4, 0, 2, 0, 0, 4, 1, *[0] * 6), "0 or 1 for the identity"),
]


@pytest.mark.parametrize(("data", "complaint"), DAMAGED)
def test_damage_is_refused_with_file_and_reason(data: bytes, complaint: str) -> None:
    with pytest.raises(InputError, match=complaint) as caught:
        decode_field_bin(data, "room.bin")
    assert caught.value.where == "room.bin"
