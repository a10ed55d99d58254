"""The .bin of SH probes, version 2: golden bytes, and damage that is refused."""

from __future__ import annotations

import math
import struct
from pathlib import Path

import numpy as np
import pytest

from irradia.core.errors import InputError
from irradia.formats.probes_bin import decode_probes_bin, encode_probes_bin, read_probes_bin, write_probes_bin

POSITIONS = np.array([(1.0, 2.0, 3.0), (-1.0, 0.5, 4.0)], np.float32)


def numbered() -> np.ndarray:
    """Coefficient 100 · probe + 10 · i + channel, i in our order L0, y, z, x, then L2."""
    probe, i, channel = np.meshgrid(np.arange(2), np.arange(9), np.arange(3), indexing="ij")
    return (100 * probe + 10 * i + channel).astype(np.float32)


GOLDEN = (
    struct.pack("<I6fI", 2, -1.0, 0.5, 3.0, 1.0, 2.0, 4.0, 2)
    + struct.pack("<6f", 1.0, 2.0, 3.0, -1.0, 0.5, 4.0)
    # L0, L1x, L1y, L1z of red, then of green, then of blue
    + struct.pack("<12f", 0, 30, 10, 20, 1, 31, 11, 21, 2, 32, 12, 22)
    + struct.pack("<12f", 100, 130, 110, 120, 101, 131, 111, 121, 102, 132, 112, 122)
)


def test_bytes_are_golden():
    assert encode_probes_bin(POSITIONS, numbered()) == GOLDEN
    assert len(GOLDEN) == 32 + 60 * 2


def test_probes_come_back(tmp_path: Path):
    write_probes_bin(tmp_path / "probes.bin", POSITIONS, numbered())
    found = read_probes_bin(tmp_path / "probes.bin")
    np.testing.assert_array_equal(found.positions, POSITIONS)
    np.testing.assert_array_equal(found.coefficients, numbered()[:, :4])
    np.testing.assert_array_equal(found.aabb, [(-1.0, 0.5, 3.0), (1.0, 2.0, 4.0)])


def test_irradiance_coefficients_carry_the_cosine_lobe():
    data = encode_probes_bin(POSITIONS, numbered(), quantity="irradiance")
    stored = np.frombuffer(data, "<f4", offset=32 + 24).reshape(2, 3, 4)
    np.testing.assert_allclose(stored[1, 0], (100 * math.pi, *(np.array([130, 110, 120]) * 2 * math.pi / 3)))
    back = decode_probes_bin(data, quantity="irradiance")
    np.testing.assert_allclose(back.coefficients, numbered()[:, :4], rtol=1e-6)


def test_box_may_be_larger_than_the_probes_need():
    aabb = np.array([(-9, -9, -9), (9, 9, 9)], np.float32)
    np.testing.assert_array_equal(
        decode_probes_bin(encode_probes_bin(POSITIONS, numbered(), aabb=aabb)).aabb, aabb
    )


def test_no_probes_are_a_header():
    data = encode_probes_bin(np.zeros((0, 3), np.float32), np.zeros((0, 9, 3), np.float32))
    assert len(data) == 32
    assert len(decode_probes_bin(data).positions) == 0


@pytest.mark.parametrize("n_bytes", [0, 4, 31, 32, 33, 56, 151])
def test_file_cut_short_is_refused(n_bytes):
    with pytest.raises(InputError, match="expected"):
        decode_probes_bin(GOLDEN[:n_bytes])


def patched(offset: int, kind: str, *values: float) -> bytes:
    data = bytearray(GOLDEN)
    struct.pack_into(f"<{kind}", data, offset, *values)
    return bytes(data)


@pytest.mark.parametrize(
    ("data", "complaint"),
    [
        (GOLDEN + b"\0", "152 bytes"),
        (patched(0, "I", 0xFFFFFFFF), "4294967295 probes"),
        (patched(0, "I", 1), "1 probes"),
        (patched(28, "I", 1), "version 2"),
        (patched(28, "I", 3), "version 2"),
        (patched(4, "f", 5.0), "AABB"),
        (patched(4, "f", math.nan), "AABB"),
        (patched(32, "f", math.inf), "finite"),
        (patched(60, "f", math.nan), "finite"),
        (patched(32, "f", 77.0), "probe 0"),
    ],
)
def test_damage_is_refused_with_what_is_wrong(data, complaint):
    with pytest.raises(InputError, match=complaint):
        decode_probes_bin(data)


def test_missing_file_is_an_input_error(tmp_path: Path):
    with pytest.raises(InputError):
        read_probes_bin(tmp_path / "none.bin")
