"""The scale of 8-bit lightmaps."""

from __future__ import annotations

import math

import numpy as np
import pytest

from irradia.export.moz_lightmap import moz_scale


def page(*, brightest: float, n_brightest: int = 1) -> np.ndarray:
    values = np.random.default_rng(24).uniform(0.1, 1.0, (100, 100, 3)).astype(np.float32)
    values[:50] = 0.0  # empty texels have no say
    values[60, :n_brightest] = brightest
    return values


@pytest.mark.parametrize("factor", [1e-3, 1.0, 3e4])
def test_moderate_maximum_is_covered_by_the_smallest_power_of_two(factor: float) -> None:
    scale = moz_scale(page(brightest=3.0) * np.float32(factor))
    assert math.log2(scale) == round(math.log2(scale))
    assert scale / 2 < 3.0 * factor <= scale


def test_a_few_texels_of_a_lamp_are_clipped() -> None:
    assert moz_scale(page(brightest=500.0)) == 1.0


def test_a_bright_area_is_not() -> None:
    assert moz_scale(page(brightest=500.0, n_brightest=50)) == 512.0


def test_black_page_has_scale_1() -> None:
    assert moz_scale(np.zeros((4, 4, 3), np.float32)) == 1.0
