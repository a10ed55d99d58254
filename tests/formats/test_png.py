"""PNG: Pillow agrees with what we write, the sRGB curve is applied when reading."""

from __future__ import annotations

import io
import zlib
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from irradia.core.colour import srgb_from_linear
from irradia.core.errors import InputError
from irradia.formats.png import encode_png, read_png_linear, write_png


@pytest.mark.parametrize("n_channels", [1, 2, 3, 4])
@pytest.mark.parametrize("smooth", [True, False])
def test_pillow_reads_back_8_bits(tmp_path: Path, n_channels: int, smooth: bool) -> None:
    rng = np.random.default_rng(4)
    pixels = rng.integers(0, 256, (33, 21, n_channels), np.uint8)
    if smooth:
        pixels = np.cumsum(pixels % 3, axis=1).astype(np.uint8)
    write_png(tmp_path / "a.png", pixels)
    with Image.open(tmp_path / "a.png") as image:
        assert image.mode == ["L", "LA", "RGB", "RGBA"][n_channels - 1]
        np.testing.assert_array_equal(np.asarray(image).reshape(pixels.shape), pixels)


def test_every_filter_is_undone_by_pillow(tmp_path: Path) -> None:
    rng = np.random.default_rng(22)
    walk = np.cumsum(np.cumsum(rng.integers(-1, 2, (600, 40, 3)), axis=0), axis=1)
    pixels = (walk // 4).astype(np.uint8)
    pixels[:50] = rng.integers(0, 256, (50, 40, 3))
    pixels[50:100] = np.arange(40, dtype=np.uint8)[None, :, None] * 7
    pixels[100:150] = pixels[100]
    write_png(tmp_path / "a.png", pixels)
    with Image.open(tmp_path / "a.png") as image:
        np.testing.assert_array_equal(np.asarray(image), pixels)
    assert set(filters_of((tmp_path / "a.png").read_bytes(), 40 * 3)) == {0, 1, 2, 3, 4}


def test_filters_look_across_bands_of_rows(tmp_path: Path) -> None:
    row = np.random.default_rng(23).integers(0, 256, (1, 40, 3), np.uint8)
    data = encode_png(np.repeat(row, 600, axis=0))
    assert filters_of(data, 40 * 3)[1:] == bytes([2]) * 599  # "up": nothing is left of any row but the first
    (tmp_path / "a.png").write_bytes(data)
    with Image.open(tmp_path / "a.png") as image:
        assert np.all(np.asarray(image) == row)


@pytest.mark.parametrize("band_bytes", [1, 300, 5000])
def test_bands_deflated_apart_are_one_stream(monkeypatch: pytest.MonkeyPatch, band_bytes: int) -> None:
    """zlib checks the Adler-32 that is joined of theirs."""
    monkeypatch.setattr("irradia.formats.png._BAND_BYTES", band_bytes)
    pixels = np.random.default_rng(24).integers(0, 256, (60, 40, 3), np.uint8)
    data = encode_png(pixels)
    assert len(filters_of(data, 40 * 3)) == 60
    with Image.open(io.BytesIO(data)) as image:
        np.testing.assert_array_equal(np.asarray(image), pixels)


def filters_of(png: bytes, row_bytes: int) -> bytes:
    """The filter of each row, from a file with one IDAT chunk."""
    at = png.index(b"IDAT") - 4
    size = int.from_bytes(png[at : at + 4], "big")
    return zlib.decompress(png[at + 8 : at + 8 + size])[:: row_bytes + 1]


def test_pillow_reads_back_16_bit_grey(tmp_path: Path) -> None:
    pixels = np.random.default_rng(5).integers(0, 65536, (7, 9), np.uint16)
    write_png(tmp_path / "a.png", pixels)
    with Image.open(tmp_path / "a.png") as image:
        np.testing.assert_array_equal(np.asarray(image), pixels)


def test_16_bit_colour_keeps_its_high_bytes_in_pillow(tmp_path: Path) -> None:
    pixels = np.random.default_rng(6).integers(0, 65536, (7, 9, 3), np.uint16)
    write_png(tmp_path / "a.png", pixels)
    with Image.open(tmp_path / "a.png") as image:
        np.testing.assert_allclose(np.asarray(image).astype(int), pixels / 257.0, atol=1.0)


def test_golden_bytes_of_one_grey_pixel() -> None:
    data = encode_png(np.array([[[128]]], np.uint8))
    assert data[:33].hex() == ("89504e470d0a1a0a0000000d49484452000000010000000108000000003a7e9b55")
    assert data[-12:].hex() == "0000000049454e44ae426082"


def test_filters_make_gradients_small() -> None:
    ramp = np.arange(256, dtype=np.uint8)
    gradient = np.stack([ramp + row for row in range(256)]).astype(np.uint8)
    assert len(encode_png(gradient)) < 1500


def test_reading_decodes_srgb(tmp_path: Path) -> None:
    linear = np.linspace(0.0, 1.0, 256, dtype=np.float32)[None, :, None].repeat(3, axis=2)
    write_png(tmp_path / "a.png", np.round(srgb_from_linear(linear) * 65535.0).astype(np.uint16)[..., 0])
    np.testing.assert_allclose(read_png_linear(tmp_path / "a.png"), linear, atol=2e-5)


@pytest.mark.parametrize("keep", [0, 8, 20, 60])
def test_truncated_files_are_input_errors(tmp_path: Path, keep: int) -> None:
    data = encode_png(np.random.default_rng(7).integers(0, 256, (64, 64, 3), np.uint8))
    (tmp_path / "cut.png").write_bytes(data[:keep])
    with pytest.raises(InputError, match=r"cut\.png"):
        read_png_linear(tmp_path / "cut.png")


def test_absurd_size_is_refused(tmp_path: Path) -> None:
    data = bytearray(encode_png(np.zeros((1, 1), np.uint8)))
    data[16:24] = (60000).to_bytes(4, "big") * 2
    data[29:33] = zlib.crc32(data[12:29]).to_bytes(4, "big")
    (tmp_path / "huge.png").write_bytes(data)
    with pytest.raises(InputError):
        read_png_linear(tmp_path / "huge.png")


@pytest.mark.parametrize("pixels", [np.zeros((2, 2, 5), np.uint8), np.zeros((2, 2), np.float32)])
def test_other_pixels_are_refused(pixels: np.ndarray) -> None:
    with pytest.raises(InputError, match="uint8 or uint16"):
        encode_png(pixels)
