"""Procedural textures repeat without a seam and stay small."""

from __future__ import annotations

import io

import numpy as np
import pytest
from PIL import Image

from irradia.scene.builtin import textures
from irradia.scene.builtin.noise import cloud
from irradia.scene.builtin.png import encode_png

REPEATING = ["plaster", "limestone", "white_marble", "red_marble", "pink_marble", "green_marble", "cloth"]
ALL = [*REPEATING, "ashlar", "brick", "tile", "wood", "court_floor", "stained_glass"]


@pytest.mark.parametrize("name", REPEATING)
def test_texture_repeats_without_a_seam(name):
    pixels = getattr(textures, name)().astype(float)
    for axis in (0, 1):
        inside = np.abs(np.diff(pixels, axis=axis)).mean()
        across = np.abs(np.take(pixels, 0, axis) - np.take(pixels, -1, axis)).mean()
        assert across < 1.6 * inside


@pytest.mark.parametrize("name", ALL)
def test_texture_survives_its_png_which_is_small(name):
    pixels = getattr(textures, name)()
    encoded = encode_png(pixels)
    assert len(encoded) < 350_000
    np.testing.assert_array_equal(np.asarray(Image.open(io.BytesIO(encoded)).convert("RGB")), pixels)


def test_png_keeps_more_than_256_colours_and_alpha():
    colours = np.random.default_rng(1).integers(0, 256, (40, 40, 4)).astype(np.uint8)
    for pixels in (colours, np.ascontiguousarray(colours[..., :3])):
        np.testing.assert_array_equal(np.asarray(Image.open(io.BytesIO(encode_png(pixels)))), pixels)


def test_cloud_is_spread_over_the_unit_interval_whatever_its_slope():
    for slope in (0.6, 1.4, 2.0):
        values = cloud(256, "test", slope=slope)
        assert 0 <= values.min() < 0.1
        assert 0.9 < values.max() <= 1
        assert values.mean() == pytest.approx(0.5, abs=0.03)
