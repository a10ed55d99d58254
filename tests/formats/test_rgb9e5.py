"""RGB9E5 against its definition."""

from __future__ import annotations

import numpy as np
import pytest

from irradia.formats.rgb9e5 import MAX_VALUE, pack_rgb9e5, unpack_rgb9e5


def pack_one(rgb: tuple[float, float, float]) -> int:
    """The specification's procedure for one texel, in exact integer and rational arithmetic."""
    from fractions import Fraction

    clamped = [min(max(Fraction(c), Fraction(0)), Fraction(65408)) for c in rgb]
    largest = max(clamped)
    floor_log2 = -16
    while largest >= Fraction(2) ** (floor_log2 + 1):
        floor_log2 += 1
    exponent = floor_log2 + 1 + 15
    if (largest / Fraction(2) ** (exponent - 24) + Fraction(1, 2)).__floor__() == 512:
        exponent += 1
    m = [(c / Fraction(2) ** (exponent - 24) + Fraction(1, 2)).__floor__() for c in clamped]
    return exponent << 27 | m[2] << 18 | m[1] << 9 | m[0]


def test_packing_follows_the_specification_bit_for_bit() -> None:
    rng = np.random.default_rng(8)
    rgb = np.exp2(rng.uniform(-28, 18, (3000, 3))).astype(np.float32)
    rgb[:300] = np.float32(511.5) * np.exp2(rng.integers(-24, 8, (300, 3))).astype(np.float32)
    expected = [pack_one(tuple(float(c) for c in texel)) for texel in rgb]
    np.testing.assert_array_equal(pack_rgb9e5(rgb), expected)


@pytest.mark.parametrize(
    ("rgb", "word"),
    [
        ((0.0, 0.0, 0.0), 0x00000000),
        ((1.0, 1.0, 1.0), 16 << 27 | 256 << 18 | 256 << 9 | 256),
        ((0.5, 1.0, 2.0), 17 << 27 | 256 << 18 | 128 << 9 | 64),
        ((MAX_VALUE, 1e9, -1.0), 31 << 27 | 0 << 18 | 511 << 9 | 511),
        ((float("nan"), float("inf"), 0.0), 31 << 27 | 511 << 9),
        ((2.0**-24, 0.0, 0.0), 1),
    ],
)
def test_golden_words(rgb: tuple[float, float, float], word: int) -> None:
    assert int(pack_rgb9e5(np.array(rgb))) == word


def test_error_is_at_most_half_a_step_of_the_largest_channel() -> None:
    rgb = np.exp(np.random.default_rng(9).normal(0, 3, (20000, 3)))
    rgb = np.minimum(rgb, MAX_VALUE)
    error = np.abs(unpack_rgb9e5(pack_rgb9e5(rgb)) - rgb).max(axis=1)
    assert np.all(error <= rgb.max(axis=1) / 512 * (1 + 1e-6))


def test_unpacking_then_packing_keeps_every_normalised_word() -> None:
    rng = np.random.default_rng(10)
    rgb = unpack_rgb9e5(pack_rgb9e5(np.exp(rng.normal(0, 5, (5000, 3)))))
    np.testing.assert_array_equal(unpack_rgb9e5(pack_rgb9e5(rgb)), rgb)
