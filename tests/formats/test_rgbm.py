"""RGBM: the promise of its formula, what its file says, and files that are not whole."""

from __future__ import annotations

import contextlib
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from irradia.core.errors import InputError
from irradia.formats.png import write_png
from irradia.formats.rgbm import RgbmCoding, decode_rgbm, encode_rgbm, read_rgbm_png, write_rgbm_png

CODINGS = [RgbmCoding(), RgbmCoding(gamma=1.0), RgbmCoding(34.49, 1.0)]


@pytest.fixture
def rgb() -> np.ndarray:
    rng = np.random.default_rng(41)
    return np.exp2(rng.uniform(-9, 2.9, (40, 30, 1)) - rng.uniform(0, 2, (40, 30, 3))).astype(np.float32)


@pytest.mark.parametrize("coding", CODINGS)
def test_error_is_at_most_half_a_step_of_the_largest_channel(rgb: np.ndarray, coding: RgbmCoding) -> None:
    texels = encode_rgbm(rgb, coding)
    coded = rgb ** (1 / coding.gamma) / coding.range
    back = decode_rgbm(texels, coding) ** (1 / coding.gamma) / coding.range
    half_step = texels[..., 3:] / 255.0 / 255.0 / 2.0
    assert np.all(np.abs(back - coded) <= half_step * (1 + 1e-4) + 1e-7)
    # M is the smallest that fits, so RGB's steps are used, but for what is too dark for M's own.
    assert np.all((texels[..., :3].max(axis=-1) >= 127) | (texels[..., 3] == 1))


@pytest.mark.parametrize(
    ("texel", "value"),
    [
        ((255, 255, 255, 255), 64.0),
        ((255, 0, 0, 128), (8 * 128 / 255) ** 2),
        ((128, 128, 128, 1), (8 * 128 / 255**2) ** 2),
    ],
)
def test_golden_texels(texel: tuple[int, ...], value: float) -> None:
    assert decode_rgbm(np.array([[texel]], np.uint8))[0, 0, 0] == pytest.approx(value, rel=1e-6)


def test_golden_encoding() -> None:
    rgb = np.array([[[64.0, 16.0, 0.0], [1e9, -1.0, np.nan], [0.0, 0.0, 0.0]]], np.float32)
    expected = [[[255, 128, 0, 255], [255, 0, 0, 255], [0, 0, 0, 1]]]
    np.testing.assert_array_equal(encode_rgbm(rgb), expected)


@pytest.mark.parametrize("coding", CODINGS)
def test_file_says_how_it_is_decoded(tmp_path: Path, rgb: np.ndarray, coding: RgbmCoding) -> None:
    write_rgbm_png(tmp_path / "a.png", rgb, coding, {"irradia:scale": "4.0", "note": "ρ = ½"})
    with Image.open(tmp_path / "a.png") as image:
        assert image.mode == "RGBA"
        m = np.asarray(image, np.float64) / 255.0
        power = float(image.info["irradia:rgbm_gamma"])
        theirs = (float(image.info["irradia:rgbm_range"]) * m[..., 3:] * m[..., :3]) ** power
        assert (image.info["irradia:scale"], image.info["note"]) == ("4.0", "ρ = ½")
    found = read_rgbm_png(tmp_path / "a.png")
    assert found.coding == coding
    np.testing.assert_allclose(found.rgb, theirs, rtol=1e-5)


def test_plain_pngs_are_refused(tmp_path: Path) -> None:
    write_png(tmp_path / "rgb.png", np.zeros((4, 4, 3), np.uint8))
    with pytest.raises(InputError, match="RGBA"):
        read_rgbm_png(tmp_path / "rgb.png")
    write_png(tmp_path / "rgba.png", np.zeros((4, 4, 4), np.uint8))
    with pytest.raises(InputError, match="rgbm_range"):
        read_rgbm_png(tmp_path / "rgba.png")
    for bad in ("nan", "-1", "inf", "1e30", "eight"):
        write_png(
            tmp_path / "bad.png",
            np.zeros((4, 4, 4), np.uint8),
            {"irradia:rgbm_range": bad, "irradia:rgbm_gamma": "1"},
        )
        with pytest.raises(InputError):
            read_rgbm_png(tmp_path / "bad.png")
    with pytest.raises(InputError, match="can't be read"):
        read_rgbm_png(tmp_path / "none.png")


def test_every_truncation_that_loses_pixels_is_an_input_error(tmp_path: Path, rgb: np.ndarray) -> None:
    write_rgbm_png(tmp_path / "a.png", rgb[:6, :5])
    data = (tmp_path / "a.png").read_bytes()
    checksums_and_end = 4 + 4 + 12
    for keep in range(len(data) - checksums_and_end - 2):
        (tmp_path / "cut.png").write_bytes(data[:keep])
        with pytest.raises(InputError):
            read_rgbm_png(tmp_path / "cut.png")


def test_flipped_bytes_never_give_another_error(tmp_path: Path, rgb: np.ndarray) -> None:
    write_rgbm_png(tmp_path / "a.png", rgb[:6, :5])
    data = (tmp_path / "a.png").read_bytes()
    rng = np.random.default_rng(42)
    for _ in range(600):
        bad = bytearray(data)
        for at in rng.integers(len(bad), size=2):
            bad[at] = rng.integers(256)
        (tmp_path / "bad.png").write_bytes(bad)
        with contextlib.suppress(InputError):
            assert read_rgbm_png(tmp_path / "bad.png").rgb.ndim == 3


def test_absurd_size_is_refused_before_memory_is_asked_for(tmp_path: Path, rgb: np.ndarray) -> None:
    import zlib

    write_rgbm_png(tmp_path / "a.png", rgb)
    data = bytearray((tmp_path / "a.png").read_bytes())
    for side in (40_000, 20_000, 0x7FFFFFFF):
        data[16:24] = side.to_bytes(4, "big") * 2
        data[29:33] = zlib.crc32(data[12:29]).to_bytes(4, "big")
        (tmp_path / "huge.png").write_bytes(data)
        with pytest.raises(InputError):
            read_rgbm_png(tmp_path / "huge.png")
