"""All kinds of light in one scene: each counted once, whichever way sources are chosen."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from irradia.core.colour import linear_from_srgb
from irradia.scene.merge import merge
from irradia.scene.sky import sky
from irradia.scene.types import Image, Light, Material, Scene, TextureRef

from .flat_scenes import Sheet, irradiance_over_pi, matte, stacked, world_of

pytestmark = pytest.mark.usefixtures("cpu_device")


def panels() -> list[Sheet]:
    """Lit panels at several heights, one facing up, one double-sided, one a screen."""
    lit = [
        Material("panel", base_color=(0, 0, 0, 1), metallic=0.0, specular=0.0, emission=(3.0, 2.0, 1.0)),
        Material("blue", base_color=(0, 0, 0, 1), metallic=0.0, specular=0.0, emission=(0.1, 0.5, 4.0)),
    ]
    both = replace(lit[1], double_sided=True)
    screen = replace(lit[0], emission_texture=TextureRef(0), emission=(8.0, 8.0, 8.0))
    return [
        Sheet(lit[0], y=3.0, width=0.5, depth=0.4, up=False),
        Sheet(both, y=2.0, width=0.2, depth=0.3, up=True),
        Sheet(lit[1], y=0.5, width=0.1, depth=0.1, up=True),
        Sheet(screen, y=4.0, width=3.0, depth=3.0, up=False),
    ]


def lamps() -> tuple[Light, ...]:
    """Points and spots around the panels, and one that is off."""
    rng = np.random.default_rng(5)
    found = []
    for k in range(12):
        x, y, z = rng.uniform((-2, 0.6, -2), (2, 3.5, 2)).tolist()
        kind = "spot" if k % 3 == 0 else "point"
        down = (0.0, -1.0, 0.0)
        size = {"radius_m": 0.05 * (k % 2), "outer_cone_rad": 1.0}
        found.append(Light(kind, (1.0, 0.7, 0.4), (x, y, z), down, **size))
    return (*found, Light("point", (1e4, 1e4, 1e4), (0.0, 1.0, 1.0), mode="off"))


def scene_of(sheets, lights=(), environment=None) -> Scene:
    pattern = np.zeros((16, 16, 4), np.uint8)
    pattern[2:5, 9:12] = 255
    scene = stacked([Sheet(matte(0.5), width=6.0, depth=6.0), *sheets], lights, environment)
    return replace(scene, images=(Image("pattern", pattern),))


def chosen_by(scene: Scene, selection: str):
    from irradia.transport.light_setup import make_lights

    world = world_of(scene)
    world.lights = make_lights(scene, merge(scene), selection)
    return world


@pytest.mark.parametrize(
    "sources", ["panels", "lamps", "panels and lamps", "everything"], ids=lambda s: s.replace(" ", "-")
)
def test_tree_and_fixed_choice_estimate_the_same(sources):
    environment, sun = sky() if sources == "everything" else (None, None)
    lights = lamps() if sources != "panels" else ()
    lights = (*lights, sun) if sun else lights
    scene = scene_of(panels() if sources != "lamps" else [], lights, environment)
    fixed, tree = (irradiance_over_pi(chosen_by(scene, s), 0, 1 << 17) for s in ("fixed", "tree"))
    np.testing.assert_allclose(tree, fixed, rtol=0.02)


def test_textured_panel_sends_what_its_picture_sends():
    """Against the sum over the picture's pixels, each a small panel of its own."""
    rng = np.random.default_rng(3)
    pixels = np.dstack([rng.integers(0, 256, (8, 8))] * 3 + [np.full((8, 8), 255)]).astype(np.uint8)
    height, width, splits = 0.5, 1.2, 64
    glowing = Material(
        "screen",
        base_color=(0, 0, 0, 1),
        metallic=0.0,
        specular=0.0,
        emission=(2.0, 2.0, 2.0),
        emission_texture=TextureRef(0, nearest=True),
    )
    panel = Sheet(glowing, y=height, width=width, depth=width, up=False)
    scene = replace(scene_of([panel]), images=(Image("picture", pixels),))
    found = irradiance_over_pi(world_of(scene), 0, 1 << 16)

    t = (np.arange(splits) + 0.5) / splits
    u, v = np.meshgrid(t, t)  # a sheet's texture runs along x and z, from their smallest corner
    radiance = 2.0 * linear_from_srgb(pixels[(v * 8).astype(int), (u * 8).astype(int), 0] / 255.0)
    distance2 = ((u - 0.5) * width) ** 2 + ((v - 0.5) * width) ** 2 + height**2
    expected = (radiance * height**2 / distance2**2).sum() * (width / splits) ** 2 / np.pi
    np.testing.assert_allclose(found, expected, rtol=0.01)


def test_single_sources_sum_to_all_of_them_together():
    environment, sun = sky()
    everything = (*lamps(), sun)
    n = 1 << 16
    dark = [replace(s, material=replace(s.material, emission=(0.0, 0.0, 0.0))) for s in panels()]
    parts = [
        irradiance_over_pi(chosen_by(scene_of(panels()), "auto"), 0, n),
        irradiance_over_pi(chosen_by(scene_of(dark, everything[:6]), "auto"), 0, n),
        irradiance_over_pi(chosen_by(scene_of(dark, everything[6:-1]), "auto"), 0, n),
        irradiance_over_pi(chosen_by(scene_of(dark, everything[-1:]), "auto"), 0, n),
        irradiance_over_pi(chosen_by(scene_of(dark, (), environment), "auto"), 0, n),
    ]
    joint = irradiance_over_pi(chosen_by(scene_of(panels(), everything, environment), "auto"), 0, n)
    np.testing.assert_allclose(joint, sum(parts), rtol=0.02)


@pytest.mark.parametrize("selection", ["fixed", "tree"])
def test_density_of_a_sample_is_the_density_that_a_ray_finds_there(selection):
    from irradia.transport.backend import dr, mi
    from irradia.transport.sampling import Sampler

    environment, sun = sky()
    world = chosen_by(scene_of(panels(), (*lamps(), sun), environment), selection)
    assert world.lights.p_local < 1.0
    n = 1 << 14
    lane = dr.arange(mi.UInt32, n)
    bary = Sampler(lane, mi.UInt32(1)).next_2d()
    place = mi.Point2f(bary.x, (1.0 - bary.x) * bary.y)
    point = world.point(mi.UInt32(0) + 0 * lane, place, mi.Bool(True))
    sampler = Sampler(lane, mi.UInt32(2))
    u, pick = sampler.next_2d(), sampler.next_1d()
    sample = world.lights.sample(world.geometry, world.emission, point, pick, u, mi.Bool(True))
    hit = world.geometry.intersect(point.origin, sample.direction, sample.pdf > 0.0)
    normal = world.geometry.normal(hit.triangle, hit.valid)
    cosine = dr.dot(normal, sample.direction)
    started = point.origin + sample.direction * hit.t - sample.direction * hit.t
    again = world.lights.area_pdf(hit.triangle, started, hit.t, cosine, hit.valid)
    reached = np.array(hit.valid & (dr.abs(hit.t / sample.distance - 1.0) < 1e-3))
    assert reached.sum() > n / 50
    np.testing.assert_allclose(np.array(again)[reached], np.array(sample.pdf)[reached], rtol=2e-3)


def test_samples_of_lamps_say_which_and_those_of_surfaces_and_sky_none():
    from irradia.transport.backend import dr, mi
    from irradia.transport.punctual import NO_LIGHT
    from irradia.transport.sampling import Sampler

    environment, sun = sky()
    world = chosen_by(scene_of(panels(), (*lamps(), sun), environment), "auto")
    n = 1 << 13
    lane = dr.arange(mi.UInt32, n)
    point = world.point(mi.UInt32(0) + 0 * lane, mi.Point2f(0.4, 0.3), mi.Bool(True))
    sampler = Sampler(lane, mi.UInt32(2))
    u, pick = sampler.next_2d(), sampler.next_1d()
    sample = world.lights.sample(world.geometry, world.emission, point, pick, u, mi.Bool(True))
    which, density = np.array(sample.punctual), np.array(sample.pdf)
    assert set(which[density > 0]) == {NO_LIGHT}
    named = set(which.tolist()) - {NO_LIGHT}
    assert named <= {*range(12), 13}  # 12 is off
    assert 13 in named
    assert len(named) > 6


def test_lights_that_are_off_or_black_leave_nothing_to_sample():
    dark = (Light("point", (0.0, 0.0, 0.0)), Light("directional", (1.0, 1.0, 1.0), mode="off"))
    assert not world_of(scene_of([], dark)).lights.any


def test_few_or_faint_sources_go_without_a_tree():
    from irradia.transport.light_choice import FixedChoice, TreeChoice
    from irradia.transport.light_setup import make_lights

    def choice(lights):
        scene = scene_of([], lights)
        return make_lights(scene, merge(scene))._local

    sun = Light("directional", (1e5, 1e5, 1e5), direction=(0.0, -1.0, 0.0))
    assert isinstance(choice((*lamps(), sun)), FixedChoice)  # in its light theirs is nothing
    assert isinstance(choice((*lamps(), replace(sun, intensity=(1.0, 1.0, 1.0)))), TreeChoice)
    assert choice(()) is None
    assert isinstance(choice(lamps()[:2]), FixedChoice)
    assert isinstance(choice(lamps()), TreeChoice)
