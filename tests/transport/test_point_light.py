"""Light at points, and how uncertain it is, against answers on paper."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from irradia.core.sh import fibonacci_sphere, irradiance, sh_basis
from irradia.scene.environment import environment_from_color
from irradia.scene.types import Light

from .flat_scenes import BLACK, Sheet, matte, stacked, world_of

pytestmark = pytest.mark.usefixtures("cpu_device")

LAMP = Light("point", (8.0, 4.0, 2.0), position=(0.3, 2.0, -0.1))
GREY_SKY = environment_from_color((2.0, 1.0, 0.5))


def above_floor(n: int, normal=(0.0, 1.0, 0.0), *, y: float = 0.5):
    """Points over a square around the Y axis, all under one normal."""
    from irradia.transport.receivers import Receivers

    places = np.random.default_rng(1).uniform(-1.0, 1.0, (n, 3)).astype(np.float32)
    places[:, 1] = y
    return Receivers.in_space(places, np.tile(np.float32(normal), (n, 1)))


def gather(scene, receivers, n_samples=16, *, first=0, seed=3):
    from irradia.transport.point_light import gather_irradiance

    return gather_irradiance(world_of(scene), receivers, first, n_samples, seed, None)


def test_point_light_follows_cosine_over_distance_squared():
    places = above_floor(200, (0.6, 0.8, 0.0))
    found = gather(stacked([Sheet(BLACK, y=-1.0)], (LAMP,)), places)
    towards = np.array(LAMP.position) - places.positions
    distance = np.linalg.norm(towards, axis=1)
    cosine = np.maximum(towards @ (0.6, 0.8, 0.0), 0.0) / distance
    np.testing.assert_allclose(
        found.values, (cosine / distance**2)[:, None] * LAMP.intensity, rtol=1e-4, atol=1e-6
    )
    assert found.variance.max() < 1e-8


def test_even_sky_gives_pi_times_its_radiance():
    found = gather(stacked([Sheet(BLACK, y=-1.0)], environment=GREY_SKY), above_floor(64), 1024)
    np.testing.assert_allclose(found.values.mean(axis=0), math.pi * np.array((2.0, 1.0, 0.5)), rtol=5e-3)


def test_light_from_below_the_geometric_plane_does_not_count():
    """A normal bent by 60° loses the part of its hemisphere that the plane cuts off: cos θ weighs ¼."""
    places = above_floor(256, (math.sin(math.pi / 3), 0.5, 0.0), y=10.0)
    bent = replace(places, geometric=np.tile(np.float32((0.0, 1.0, 0.0)), (len(places), 1)))
    dark_floor = stacked([Sheet(BLACK, y=-50.0, up=False)], environment=GREY_SKY)
    found = gather(dark_floor, bent, 256)
    assert found.values[:, 1].mean() == pytest.approx(math.pi * (1 + math.cos(math.pi / 3)) / 2, rel=0.01)


@pytest.mark.parametrize("mode", ["mixed", "realtime"])
def test_first_bounce_of_lights_that_are_lit_live_is_left_out_and_the_second_is_not(mode):
    sheets = [Sheet(matte(0.5), width=40.0, depth=40.0)]
    lit = gather(stacked(sheets, (LAMP,)), above_floor(256), 64)
    live = gather(stacked(sheets, (replace(LAMP, mode=mode),)), above_floor(256), 64)
    assert live.values.max() == 0.0  # the floor's light comes from below
    down = above_floor(256, (0.0, -1.0, 0.0))
    lit, live = (
        gather(stacked(sheets, (LAMP,)), down),
        gather(stacked(sheets, (replace(LAMP, mode=mode),)), down),
    )
    np.testing.assert_array_equal(lit.values, live.values)
    assert live.values.min() > 0.0


def test_variance_is_that_of_each_channel_on_average():
    """At one place under a small bright sheet, points differ by noise alone."""
    sheet = Sheet(matte(0.0, emission=(9.0, 3.0, 1.0)), y=2.0, width=3.0, depth=3.0, up=False)
    scene = stacked([sheet, Sheet(matte(0.6), width=9.0, depth=9.0)])
    places = above_floor(4096, (0.6, 0.8, 0.0))
    same = replace(
        places, positions=places.positions * 0.0, origins=np.float32([[0, 0.5, 0]]).repeat(4096, 0)
    )
    found = gather(scene, same, 16)
    spread = found.values.var(axis=0, ddof=1).mean()
    assert float(found.variance.mean()) == pytest.approx(float(spread), rel=0.08)
    assert spread > 1.2 * found.values.mean(axis=1).var(ddof=1), (
        "the light must be coloured to tell both apart"
    )


def test_numbers_decide_randomness_and_launches_do_not():
    sheet = Sheet(matte(0.5, emission=(1.0, 1.0, 1.0)), width=9.0, depth=9.0)
    scene, places = stacked([sheet]), above_floor(100, (1.0, 0.0, 0.0))
    whole = gather(scene, places)
    parts = [gather(scene, places.take(p), first=f) for p, f in ((slice(0, 37), 0), (slice(37, 100), 37))]
    np.testing.assert_array_equal(whole.values, np.concatenate([p.values for p in parts]))
    np.testing.assert_array_equal(whole.variance, np.concatenate([p.variance for p in parts]))
    assert not np.array_equal(whole.values, gather(scene, places, seed=4).values)


def test_coefficients_give_the_irradiance_of_the_same_place_and_its_uncertainty():
    from irradia.transport.point_light import gather_coefficients

    scene = stacked([Sheet(matte(0.6), width=9.0, depth=9.0)], (LAMP,), GREY_SKY)
    world, place = world_of(scene), np.zeros((2048, 3), np.float32) + np.float32([0.0, 0.7, 0.0])
    found = gather_coefficients(world, place, 0, 64, 5, None)
    normals = fibonacci_sphere(64)
    e = irradiance(found.values[:, None], normals[None])
    spread = e.var(axis=0, ddof=1).mean()
    assert float(found.variance.mean()) == pytest.approx(float(spread), rel=0.08)
    half_sky = math.pi * np.mean((2.0, 1.0, 0.5))
    lamp = irradiance(sh_basis((0.3, 1.3, -0.1) / np.sqrt(1.79))[:, None], (0.0, 1.0, 0.0))[0]
    lamp *= np.mean(LAMP.intensity) / 1.79
    up = irradiance(found.values, (0.0, 1.0, 0.0)).mean()
    assert up == pytest.approx(half_sky + lamp, rel=0.05)  # order 2 misses a little
    four = gather_coefficients(world, place[:8], 0, 64, 5, None, 4)
    np.testing.assert_array_equal(four.values, found.values[:8, :4])


def test_backs_are_seen_from_inside_and_from_below():
    from irradia.transport.point_light import share_of_backs

    world = world_of(stacked([Sheet(matte(0.5), width=1e4, depth=1e4)]))
    for y, normal, all_round, expected in (
        (0.5, (0.0, -1.0, 0.0), False, 0.0),
        (-0.5, (0.0, 1.0, 0.0), False, 1.0),
        (-0.5, (0.0, 1.0, 0.0), True, 0.5),
        (0.5, (0.0, 1.0, 0.0), True, 0.0),
    ):
        share = share_of_backs(world, above_floor(5, normal, y=y), 256, all_round=all_round)
        np.testing.assert_allclose(share, expected, atol=0.02)
