"""Closed boxes under a bright sky stay black, from traced texels to finished pages."""

from __future__ import annotations

import functools

import numpy as np
import pytest
from numpy.typing import NDArray

from irradia.bake.lightmap import LightmapResult
from irradia.metrics.leak import leak
from irradia.scene.builtin.leaks import CENTRE_Y_M, CENTRES_X_M, INNER_M, WALL_M

from .lit_scenes import bake, laid_out, lit, places

pytestmark = pytest.mark.usefixtures("cpu_device")

RESOLUTIONS = [96, 160, 288]  # texels of 0.4, 0.2 and 0.1 m; the walls have 0.2 m
_MOST = 1e-5


@functools.cache
def _baked(resolution: int) -> tuple[LightmapResult, NDArray[np.float64]]:
    """The bake with all finishing steps, and world positions (N, 3) of texel middles."""
    scene = lit("leaks")
    middle = places(scene, laid_out(scene, resolution))[2].mean(axis=1)
    return bake(scene, resolution, 64, denoise=True), middle


def _inside(middle: NDArray[np.float64], box: str, reach_m: float) -> NDArray[np.bool_]:
    centre = np.array([CENTRES_X_M[box], CENTRE_Y_M, 0.0])
    return (np.abs(middle - centre) <= reach_m).all(axis=1)


def _outside(middle: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Texels well clear of every box."""
    return ~np.any([_inside(middle, box, INNER_M / 2 + 2 * WALL_M) for box in CENTRES_X_M], axis=0)


@pytest.mark.parametrize("resolution", RESOLUTIONS)
@pytest.mark.parametrize("box", CENTRES_X_M)
def test_no_light_gets_into_a_closed_box(box, resolution):
    result, middle = _baked(resolution)
    inside = _inside(middle, box, INNER_M / 2 + 1e-4) & result.valid
    finished = result.pages.reshape(-1, 3)[result.texels.pixel]
    assert inside.sum() > 6 * 9
    assert leak(result.irradiance_over_pi, inside, _outside(middle)) <= _MOST
    assert leak(finished, inside, _outside(middle)) <= _MOST


@pytest.mark.parametrize("resolution", RESOLUTIONS)
def test_the_outside_keeps_its_light(resolution):
    """The boxes aren't black because everything is."""
    result, middle = _baked(resolution)
    lit_share = (result.irradiance_over_pi[_outside(middle) & result.valid] > 0).mean()
    assert lit_share > 0.9
