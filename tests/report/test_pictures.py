"""Arrays as pictures."""

from __future__ import annotations

import base64
import io

import numpy as np
from PIL import Image

from irradia.core.colour import luminance
from irradia.report import pictures


def _decode(uri: str) -> np.ndarray:
    head, body = uri.split(",", 1)
    assert head == "data:image/webp;base64"
    return np.asarray(Image.open(io.BytesIO(base64.b64decode(body))).convert("RGB"))


def test_a_lossless_picture_holds_the_pixels():
    pixels = np.random.default_rng(1).integers(0, 256, (13, 29, 3), np.uint8)
    assert np.array_equal(_decode(pictures.data_uri(pixels)), pixels)


def test_exposure_by_one_stop_doubles_the_light():
    radiance = np.full((2, 2, 3), 0.2, np.float32)
    assert np.array_equal(pictures.display(radiance, 1.0), pictures.display(2 * radiance, 0.0))


def test_values_that_are_no_numbers_show_black():
    assert not pictures.display(np.full((2, 2, 3), np.nan, np.float32), 0.0).any()


def test_a_larger_error_is_always_brighter():
    ramp = pictures.error_colours(np.linspace(0, 1, 200, dtype=np.float32)[None])
    linear = (ramp[0] / 255.0) ** 2.2
    assert (np.diff(luminance(linear)) >= -1e-4).all()
    assert luminance(linear[0]) < 0.01
    assert luminance(linear[-1]) > 0.8


def test_an_error_that_is_no_number_counts_as_the_worst():
    worst = pictures.error_colours(np.ones((1, 1), np.float32))
    assert np.array_equal(pictures.error_colours(np.full((1, 1), np.nan, np.float32)), worst)


def test_a_large_page_is_scaled_down():
    page = np.zeros((3000, 3000, 3), np.float32)
    shown = pictures.page_display(page, np.ones((3000, 3000), np.float32), 0.0)
    assert max(shown.shape[:2]) <= pictures.MAX_PAGE_PX


def test_texels_without_a_chart_show_the_checkerboard():
    shown = pictures.page_display(np.ones((16, 16, 3), np.float32), np.zeros((16, 16), np.float32), 0.0)
    assert set(np.unique(shown)) == set(pictures.CHECKER_SRGB8)
