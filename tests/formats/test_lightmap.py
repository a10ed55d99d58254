"""The lightmap file: what it promises about values, scale and pages."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from irradia.core.errors import InputError
from irradia.formats.exr import read_exr, read_exr_image, read_exr_metadata, write_exr, write_exr_rgb
from irradia.formats.lightmap import (
    LightmapFile,
    is_lightmap,
    make_lightmap,
    power_of_two_scale,
    read_lightmap,
    unit_of,
    write_lightmap,
)


@pytest.fixture
def lightmap() -> LightmapFile:
    rng = np.random.default_rng(13)
    pages = np.exp(rng.normal(4, 1, (2, 12, 9, 3))).astype(np.float32)
    coverage = (rng.random((2, 12, 9)) * (rng.random((2, 12, 9)) > 0.3)).astype(np.float32)
    return make_lightmap(pages, coverage, {"seed": 7, "scene": "cornell"})


def test_lightmap_comes_back_whole(tmp_path: Path, lightmap: LightmapFile) -> None:
    paths = write_lightmap(tmp_path / "lightmap.exr", lightmap)
    assert [path.name for path in paths] == ["lightmap.exr", "lightmap.1.exr"]
    back = read_lightmap(paths[0])
    np.testing.assert_array_equal(back.pages, lightmap.pages)
    np.testing.assert_array_equal(back.coverage, lightmap.coverage)
    assert (back.scale, back.quantity) == (lightmap.scale, "irradiance_over_pi")
    assert back.exposure_ev == pytest.approx(lightmap.exposure_ev, rel=1e-6)
    assert back.provenance == {"seed": 7, "scene": "cornell"}
    assert is_lightmap(paths[1])


def test_pixels_are_irradiance_over_pi_whatever_the_scale(tmp_path: Path, lightmap: LightmapFile) -> None:
    write_lightmap(tmp_path / "lightmap.exr", replace(lightmap, scale=1024.0))
    np.testing.assert_array_equal(read_exr(tmp_path / "lightmap.exr"), lightmap.pages[0])


@pytest.mark.parametrize("brightness", [1e-6, 0.7, 1.0, 3e4])
def test_scale_is_a_power_of_two_that_brings_the_brightest_near_1(brightness: float) -> None:
    values = np.random.default_rng(14).random((10000, 3)) * brightness
    scale = power_of_two_scale(values)
    assert math.log2(scale) == round(math.log2(scale))
    assert 0.7 < np.percentile(values.max(axis=1), 99.9) / scale < 1.42


def test_uncovered_texels_choose_neither_scale_nor_exposure(lightmap: LightmapFile) -> None:
    bright = np.where(lightmap.covered[..., None], lightmap.pages, 1e9)
    again = make_lightmap(bright, lightmap.coverage)
    assert (again.scale, again.exposure_ev) == (lightmap.scale, lightmap.exposure_ev)


def test_black_lightmap_has_scale_1_and_exposure_0() -> None:
    black = make_lightmap(np.zeros((1, 2, 2, 3), np.float32), np.ones((1, 2, 2), np.float32))
    assert (black.scale, black.exposure_ev) == (1.0, 0.0)


@pytest.mark.parametrize("brightness", [1e-5, 1.0, 1e7])
def test_half_floats_hold_any_brightness_to_eleven_bits(
    tmp_path: Path, lightmap: LightmapFile, brightness: float
) -> None:
    bright = make_lightmap(lightmap.pages * np.float32(brightness), lightmap.coverage)
    paths = write_lightmap(tmp_path / "lightmap.half.exr", bright, half=True)
    assert [path.name for path in paths] == ["lightmap.half.exr", "lightmap.half.1.exr"]
    stored = read_exr_image(paths[0])
    assert {plane.dtype for plane in stored.channels.values()} == {np.dtype(np.float16)}
    assert stored.metadata["irradia:unit"] == stored.metadata["irradia:scale"] == bright.scale
    assert 0.1 < np.percentile(stored.channels["G"].astype(np.float64), 99) < 2.0
    back = read_lightmap(paths[0])
    np.testing.assert_allclose(back.pages, bright.pages, rtol=2.0**-11)
    assert back.scale == bright.scale


def test_further_channels_come_back_in_their_types(tmp_path: Path, lightmap: LightmapFile) -> None:
    rng = np.random.default_rng(18)
    validity = rng.random((2, 12, 9)).astype(np.float16)
    samples = rng.integers(0, 1 << 20, (2, 12, 9), np.uint32)
    both = replace(lightmap, extra={"validity": validity, "samples": samples})
    for half in (False, True):
        found = read_lightmap(write_lightmap(tmp_path / "lightmap.exr", both, half=half)[0]).extra
        assert {name: plane.dtype for name, plane in found.items()} == {
            "samples": np.dtype(np.uint32),
            "validity": np.dtype(np.float16),
        }
        np.testing.assert_array_equal(found["samples"], samples)
        np.testing.assert_array_equal(found["validity"], validity)


def test_three_js_reads_half_and_float(web_check, tmp_path: Path, lightmap: LightmapFile) -> None:
    for half in (False, True):
        path = write_lightmap(tmp_path / "lightmap.exr", lightmap, half=half)[0]
        size = web_check("read-image", path, tmp_path / "pixels.bin")
        pixels = np.frombuffer((tmp_path / "pixels.bin").read_bytes(), "<f4")
        pixels = pixels.reshape(size["height"], size["width"], 4)[::-1, :, :3]  # three.js: bottom row first
        np.testing.assert_array_equal(pixels, read_exr(path))


def test_version_1_had_no_unit(tmp_path: Path, lightmap: LightmapFile) -> None:
    path = write_lightmap(tmp_path / "lightmap.exr", replace(lightmap, pages=lightmap.pages[:1]))[0]
    image = read_exr_image(path)
    old = {key: value for key, value in image.metadata.items() if key.startswith("irradia:")}
    del old["irradia:unit"]
    write_exr(path, image.channels, old | {"irradia:version": 1})
    np.testing.assert_array_equal(read_lightmap(path).pages, lightmap.pages[:1])


@pytest.mark.parametrize("unit", ["nan", "inf", "0", "-2", "3", "1e300", "two"])
def test_units_that_are_no_power_of_two_are_refused(unit: str) -> None:
    attributes = {"irradia:quantity": "irradiance_over_pi", "irradia:version": "2"}
    assert unit_of(attributes | {"irradia:unit": "0.25"}, "a.hdr") == 0.25
    with pytest.raises(InputError, match="power of two"):
        unit_of(attributes | {"irradia:unit": unit}, "a.hdr")


def test_later_versions_are_refused(tmp_path: Path, lightmap: LightmapFile) -> None:
    path = write_lightmap(tmp_path / "lightmap.exr", replace(lightmap, pages=lightmap.pages[:1]))[0]
    image = read_exr_image(path)
    later = {**read_exr_metadata(path), "irradia:version": 3}
    write_exr(path, image.channels, {k: v for k, v in later.items() if k.startswith("irradia:")})
    with pytest.raises(InputError, match="version 2, found 3"):
        read_lightmap(path)


def test_missing_page_is_an_input_error(tmp_path: Path, lightmap: LightmapFile) -> None:
    paths = write_lightmap(tmp_path / "lightmap.exr", lightmap)
    paths[1].unlink()
    with pytest.raises(InputError, match=r"lightmap\.1\.exr"):
        read_lightmap(paths[0])


def test_page_of_another_lightmap_is_an_input_error(tmp_path: Path, lightmap: LightmapFile) -> None:
    paths = write_lightmap(tmp_path / "lightmap.exr", lightmap)
    other = make_lightmap(lightmap.pages[:, :5], lightmap.coverage[:, :5])
    paths[1].write_bytes(write_lightmap(tmp_path / "other.exr", other)[1].read_bytes())
    with pytest.raises(InputError, match="another size"):
        read_lightmap(paths[0])
    paths[1].write_bytes(paths[0].read_bytes())
    with pytest.raises(InputError, match="another lightmap"):
        read_lightmap(paths[0])


def test_plain_image_is_no_lightmap(tmp_path: Path) -> None:
    write_exr_rgb(tmp_path / "a.exr", np.ones((2, 2, 3), np.float32))
    assert not is_lightmap(tmp_path / "a.exr")
    with pytest.raises(InputError, match="irradia bake"):
        read_lightmap(tmp_path / "a.exr")
