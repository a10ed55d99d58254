"""Dithered codes are on average what was coded."""

from __future__ import annotations

import numpy as np
import pytest

from irradia.core.colour import linear_from_srgb
from irradia.core.dither import dithered_srgb8


@pytest.mark.parametrize("value", [2e-5, 3e-4, 0.0021, 0.0313, 0.2, 0.77])
def test_an_even_surface_keeps_its_mean(value: float) -> None:
    even = np.full((64, 64, 3), value)
    decoded = linear_from_srgb(dithered_srgb8(even) / 255.0)
    assert decoded.mean(axis=(0, 1)) == pytest.approx([value] * 3, rel=0.01)


@pytest.mark.parametrize("value", [4e-4, 0.003, 0.05])
def test_eight_texels_square_keep_it_nearly(value: float) -> None:
    decoded = linear_from_srgb(dithered_srgb8(np.full((64, 64, 3), value)) / 255.0)
    blocks = decoded.reshape(8, 8, 8, 8, 3).mean(axis=(1, 3))
    step = np.diff(linear_from_srgb(np.arange(256) / 255.0))
    code_step = step[np.searchsorted(np.cumsum(step), value)]
    assert np.abs(blocks - value).max() < 0.08 * code_step


def test_codes_decode_and_encode_to_themselves() -> None:
    codes = np.broadcast_to(np.arange(256, dtype=np.uint8)[None, :, None], (16, 256, 3))
    assert np.array_equal(dithered_srgb8(linear_from_srgb(codes / 255.0)), codes)


def test_no_code_is_more_than_one_away() -> None:
    values = np.random.default_rng(3).uniform(0.0, 1.0, (64, 64, 3)) ** 3
    codes = dithered_srgb8(values).astype(int)
    below = linear_from_srgb(np.maximum(codes - 1, 0) / 255.0)
    above = linear_from_srgb(np.minimum(codes + 1, 255) / 255.0)
    assert np.all((below <= values + 1e-6) & (values <= above + 1e-6))


def test_what_lies_outside_is_clipped() -> None:
    assert np.array_equal(dithered_srgb8(np.full((4, 4, 3), 7.5)), np.full((4, 4, 3), 255))
    assert np.array_equal(dithered_srgb8(np.full((4, 4, 3), -1.0)), np.zeros((4, 4, 3)))


def test_bands_join_to_the_whole() -> None:
    values = np.random.default_rng(4).uniform(0.0, 1.0, (40, 24, 3))
    bands = [dithered_srgb8(values[start : start + 16], first_row=start) for start in (0, 16, 32)]
    assert np.array_equal(np.concatenate(bands), dithered_srgb8(values))
