"""Radiance pictures: golden bytes of each encoding, both ways, and damage."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from irradia.core.errors import InputError
from irradia.formats.hdr import decode_hdr, linear_from_rgbe, read_hdr, rgbe_from_linear, write_hdr

HEAD = b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n"
GREY = bytes([128, 128, 128, 129])  # 128 · 2^(129−136) = 1


def test_golden_flat_pixels() -> None:
    rgb = decode_hdr(HEAD + b"-Y 1 +X 2\n" + GREY + bytes([255, 64, 0, 136]))
    np.testing.assert_array_equal(rgb, [[[1, 1, 1], [255, 64, 0]]])


def test_golden_old_runs() -> None:
    data = HEAD + b"-Y 1 +X 4\n" + GREY + bytes([1, 1, 1, 3])
    np.testing.assert_array_equal(decode_hdr(data), np.ones((1, 4, 3)))


def test_golden_old_runs_in_a_row_count_in_bytes() -> None:
    data = HEAD + b"-Y 1 +X 262\n" + GREY + bytes([1, 1, 1, 5]) + bytes([1, 1, 1, 1])
    np.testing.assert_array_equal(decode_hdr(data), np.ones((1, 262, 3)))


def test_golden_new_runs_and_literals() -> None:
    red = bytes([128 + 9, 128])
    green = bytes([9, *([64] * 9)])
    blue = bytes([128 + 4, 0, 5, *([32] * 5)])
    data = HEAD + b"-Y 1 +X 9\n" + bytes([2, 2, 0, 9]) + red + green + blue + bytes([128 + 9, 129])
    rgb = decode_hdr(data)[0]
    np.testing.assert_array_equal(rgb[:, 0], 1.0)
    np.testing.assert_array_equal(rgb[:, 1], 0.5)
    np.testing.assert_array_equal(rgb[:, 2], [0, 0, 0, 0, 0.25, 0.25, 0.25, 0.25, 0.25])


@pytest.mark.parametrize(
    ("size", "expected"),
    [
        (b"-Y 1 +X 2", [[1, 2]]),
        (b"-Y 1 -X 2", [[2, 1]]),
        (b"-Y 2 +X 1", [[1], [2]]),
        (b"+Y 2 +X 1", [[2], [1]]),
        (b"+X 2 -Y 1", [[1, 2]]),
        (b"-X 2 -Y 1", [[2, 1]]),
        (b"+X 1 -Y 2", [[1], [2]]),
        (b"+X 1 +Y 2", [[2], [1]]),
    ],
)
def test_all_eight_orientations_turn_upright(size: bytes, expected: list[list[float]]) -> None:
    data = HEAD + size + b"\n" + GREY + GREY[:3] + b"\x82"
    np.testing.assert_array_equal(decode_hdr(data)[..., 0], expected)


def test_recorded_exposures_are_divided_out() -> None:
    head = b"#?RGBE\nFORMAT=32-bit_rle_rgbe\nEXPOSURE=4\nEXPOSURE= 0.5\n\n"
    np.testing.assert_allclose(decode_hdr(head + b"-Y 1 +X 1\n" + GREY), 0.5)


def test_written_values_are_within_half_a_step_of_the_largest_channel(tmp_path: Path) -> None:
    rgb = np.exp(np.random.default_rng(3).normal(0, 6, (19, 64, 3))).astype(np.float32)
    write_hdr(tmp_path / "a.hdr", rgb)
    # The largest mantissa is at least 128, so half a step is at most 1/256 of the largest channel.
    error = np.abs(read_hdr(tmp_path / "a.hdr") - rgb).max(axis=-1)
    assert np.all(error <= rgb.max(axis=-1) / 256 * (1 + 1e-6))


@pytest.mark.parametrize("value", [0.0, 1e-45, 255.9, 0.99999994, 1.6e38, -1.0])
def test_edge_values_round_trip_without_wrapping(value: float) -> None:
    back = linear_from_rgbe(rgbe_from_linear(np.full((1, 3), value, np.float32)))
    np.testing.assert_allclose(back, max(value, 0.0), rtol=1 / 256, atol=1e-38)


@pytest.mark.parametrize(
    "body",
    [
        b"",
        GREY,
        bytes([1, 1, 1, 2]) + GREY,  # nothing to repeat
        GREY + bytes([1, 1, 1, 200]),  # leaves the scanline
    ],
)
def test_bad_old_pixels_are_input_errors(body: bytes) -> None:
    with pytest.raises(InputError, match="can't be decoded"):
        decode_hdr(HEAD + b"-Y 1 +X 2\n" + body)


@pytest.mark.parametrize(
    "body",
    [
        bytes([2, 2, 0, 8]),
        bytes([2, 2, 0, 9]) + bytes([136, 1]) * 4,  # another width
        bytes([2, 2, 0, 8, 0]) + bytes([136, 1]) * 4,  # empty run
        bytes([2, 2, 0, 8, 137, 1, 135, 1, 136, 1, 136, 1]),  # red runs into green
        bytes([2, 2, 0, 8]) + bytes([137, 1]) * 4,  # leaves the scanline
        bytes([2, 2, 0, 8]) + bytes([136, 1]) * 3 + bytes([8, 1, 2]),  # cut short
    ],
)
def test_bad_new_pixels_are_input_errors(body: bytes) -> None:
    with pytest.raises(InputError, match="can't be decoded"):
        decode_hdr(HEAD + b"-Y 1 +X 8\n" + body)


@pytest.mark.parametrize(
    "data",
    [
        b"",
        b"\x76\x2f\x31\x01",
        b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n",
        HEAD,
        HEAD + b"-Y 1 +Y 2\n" + GREY * 2,
        HEAD + b"-Y 0 +X 2\n",
        HEAD + b"-Y 99999999 +X 99999999\n" + GREY,
        b"#?RADIANCE\nFORMAT=32-bit_rle_xyze\n\n-Y 1 +X 1\n" + GREY,
        b"#?RADIANCE\nEXPOSURE=zero\n\n-Y 1 +X 1\n" + GREY,
        b"#?RADIANCE\nEXPOSURE=0\n\n-Y 1 +X 1\n" + GREY,
    ],
)
def test_bad_headers_are_input_errors(data: bytes) -> None:
    with pytest.raises(InputError):
        decode_hdr(data)


def test_missing_file_is_an_input_error(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="can't read"):
        read_hdr(tmp_path / "none.hdr")
