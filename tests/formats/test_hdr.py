"""Radiance pictures: golden bytes of each encoding, both ways, and damage."""

from __future__ import annotations

import contextlib
from pathlib import Path

import numpy as np
import pytest

from irradia.core.errors import InputError
from irradia.formats.hdr import (
    decode_hdr,
    linear_from_rgbe,
    read_hdr,
    read_hdr_image,
    rgbe_from_linear,
    write_hdr,
)

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


def pattern(width: int, height: int = 70) -> np.ndarray:
    """Noise, long flat runs, short runs, black, and rows that repeat; over a band's edge."""
    rng = np.random.default_rng(width)
    rgb = np.exp(rng.normal(0, 3, (height, width, 3))).astype(np.float32)
    rgb[10:30] = rng.integers(1, 5, (20, -(-width // 5), 3)).repeat(5, axis=1)[:, :width]
    rgb[30:40] = 0.25
    rgb[40:45, width // 3 :] = 0.0
    return rgb


@pytest.mark.parametrize("width", [1, 7, 8, 9, 127, 128, 129, 130, 131, 255, 256, 300])
def test_written_runs_come_back_at_every_width(tmp_path: Path, width: int) -> None:
    rgb = pattern(width)
    write_hdr(tmp_path / "a.hdr", rgb, {"irradia:scale": "0.5"})
    image = read_hdr_image(tmp_path / "a.hdr")
    np.testing.assert_array_equal(image.rgb, linear_from_rgbe(rgbe_from_linear(rgb)))
    assert image.metadata == {"FORMAT": "32-bit_rle_rgbe", "irradia:scale": "0.5"}


def test_golden_written_runs(tmp_path: Path) -> None:
    """Reds 1 2 3 then a run; a run of exponents longer than 127 is split."""
    rgb = np.ones((1, 130, 3), np.float32)
    rgb[0, :3, 0] = (0.5, 0.25, 0.75)
    write_hdr(tmp_path / "a.hdr", rgb)
    body = (tmp_path / "a.hdr").read_bytes().partition(b"+X 130\n")[2]
    red = bytes([3, 64, 32, 96, 255, 128])
    full = bytes([255, 128, 131, 128])
    assert body == bytes([2, 2, 0, 130]) + red + full + full + bytes([255, 129, 131, 129])


def test_runs_make_flat_pictures_small(tmp_path: Path) -> None:
    write_hdr(tmp_path / "a.hdr", np.full((256, 256, 3), 0.5, np.float32))
    assert (tmp_path / "a.hdr").stat().st_size < 256 * 256 * 4 // 30


def test_three_js_reads_what_is_written(web_check, tmp_path: Path) -> None:
    """three.js divides mantissas by 255 and not by 256."""
    rgb = np.clip(pattern(131), 0.0, 100.0)
    write_hdr(tmp_path / "a.hdr", rgb, {"irradia:unit": "1.0"})
    size = web_check("read-image", tmp_path / "a.hdr", tmp_path / "pixels.bin")
    found = np.frombuffer((tmp_path / "pixels.bin").read_bytes(), "<f4")
    found = found.reshape(size["height"], size["width"], 4)[..., :3] * (255.0 / 256.0)
    np.testing.assert_allclose(found, read_hdr(tmp_path / "a.hdr"), rtol=1e-6, atol=1e-30)


def test_every_truncation_is_an_input_error(tmp_path: Path) -> None:
    write_hdr(tmp_path / "a.hdr", pattern(20, 50)[:3])
    data = (tmp_path / "a.hdr").read_bytes()
    for keep in range(len(data)):
        with pytest.raises(InputError):
            decode_hdr(data[:keep])


def test_flipped_bytes_never_give_another_error(tmp_path: Path) -> None:
    write_hdr(tmp_path / "a.hdr", pattern(20, 50)[:12])
    data = (tmp_path / "a.hdr").read_bytes()
    rng = np.random.default_rng(43)
    for _ in range(2000):
        bad = bytearray(data)
        for at in rng.integers(len(bad), size=2):
            bad[at] = rng.integers(256)
        with contextlib.suppress(InputError):
            assert decode_hdr(bytes(bad)).ndim == 3
