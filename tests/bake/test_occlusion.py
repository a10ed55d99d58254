"""Ambient occlusion against answers on paper."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from irradia.bake.occlusion import OcclusionOptions, bake_occlusion
from irradia.core.errors import InputError
from irradia.scene.types import Image, Material, TextureRef

from .lit_scenes import lit
from .quads import Traced, quad, quad_scene

pytestmark = pytest.mark.usefixtures("cpu_device")

_FLOOR = quad((0, 0, -4), (0, 0, 8), (4, 0, 0))
_WALL = quad((0, 0, -400), (0, 400, 0), (0, 0, 800))  # along the floor's edge x = 0


def _openness(scene, resolution=64, **options):
    traced = Traced(scene, resolution)
    chosen = OcclusionOptions(**options)
    return traced, bake_occlusion(traced.world, traced.subsamples, traced.texels, chosen)


def _beyond(c):
    """Share of a disc on one side of a line at distance c from its middle."""
    return (np.arccos(c) - c * np.sqrt(1 - c**2)) / np.pi


def test_a_plane_is_open():
    _, openness = _openness(quad_scene(_FLOOR), distance_m=math.inf)
    assert (openness == 1.0).all()


def test_a_convex_body_is_open_however_coarse():
    traced, openness = _openness(lit("cylinder"), 128, distance_m=0.01, samples=64)
    on_body = (traced.instance == 1) & (traced.places[..., 1].min(axis=1) > 0.02)
    assert on_body.any()
    assert (openness[on_body] == 1.0).all()


def test_a_wall_takes_the_part_of_the_disc_that_it_reaches():
    distance_m = 0.8
    traced, openness = _openness(quad_scene(_FLOOR, _WALL, mapped=1), distance_m=distance_m, samples=1024)
    c = np.clip(traced.places[..., 0] / distance_m, 0.0, 1.0)
    expected = 1.0 - _beyond(c).mean(axis=1)
    np.testing.assert_allclose(openness, expected, atol=0.015)
    assert openness.mean() == pytest.approx(expected.mean(), rel=5e-4)


def test_a_right_angle_without_limit_halves_the_sky():
    """Far beyond its own size, the wall takes half of what lies along its foot."""
    traced, openness = _openness(quad_scene(_FLOOR, _WALL, mapped=1), distance_m=math.inf, samples=512)
    x = traced.places[..., 0]
    expected = 1.0 - (0.5 * (1.0 - x / np.hypot(x, 400.0))).mean(axis=1)
    np.testing.assert_allclose(openness, expected, atol=0.02)
    assert openness.mean() == pytest.approx(expected.mean(), abs=2e-3)
    assert openness[x.max(axis=1) < 0.2].mean() == pytest.approx(0.5, abs=5e-3)


def test_a_closed_room_is_closed():
    _, openness = _openness(lit("closed"), distance_m=math.inf, samples=64)
    assert not openness.any()


def test_a_half_transparent_wall_takes_half():
    checks = np.full((1, 1, 4), 255, np.uint8)
    checks[..., 3] = 128
    blended = Material(base_color_texture=TextureRef(0), alpha_mode="blend", metallic=0.0, double_sided=True)
    wall = replace(_WALL, material=1)
    opaque = _openness(quad_scene(_FLOOR, _WALL, mapped=1), distance_m=2.0, samples=512)[1]
    scene = quad_scene(
        _FLOOR, wall, materials=(Material(), blended), images=(Image("half", checks),), mapped=1
    )
    half = _openness(scene, distance_m=2.0, samples=512)[1]
    np.testing.assert_allclose(1.0 - half, (1.0 - opaque) * 128 / 255, atol=2e-3)


def test_the_default_distance_is_a_metre_and_less_for_small_things():
    assert OcclusionOptions().distance_in(30.0) == 1.0
    assert OcclusionOptions().distance_in(0.1) == 0.05
    assert OcclusionOptions(distance_m=7.0).distance_in(0.1) == 7.0


def test_more_samples_go_on_with_the_same_sequence():
    """64 rays a launch: what is drawn depends on the count alone."""
    scene = quad_scene(_FLOOR, _WALL, mapped=1)
    first, second = (_openness(scene, distance_m=1.0, samples=96, seed=3)[1] for _ in range(2))
    assert first.tobytes() == second.tobytes()
    assert first.tobytes() != _openness(scene, distance_m=1.0, samples=96, seed=4)[1].tobytes()


@pytest.mark.parametrize("options", [{"samples": 0}, {"distance_m": 0.0}, {"distance_m": math.nan}])
def test_options_without_sense_are_bad_input(options):
    with pytest.raises(InputError):
        OcclusionOptions(**options)
