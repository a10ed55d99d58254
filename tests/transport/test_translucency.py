"""Diffuse transmission: what comes through a sheet, and what its own texels hold."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from irradia.scene.environment import environment_from_color
from irradia.scene.types import Image, Light, Material, TextureRef

from .flat_scenes import BLACK, Sheet, form_factor, irradiance_over_pi, matte, stacked, world_of

pytestmark = pytest.mark.usefixtures("cpu_device")

ALBEDO, SHARE, TINT = np.array([0.8, 0.4, 0.2]), 0.7, np.array([0.9, 0.5, 0.3])
PAPER = Material(
    "paper",
    base_color=(*ALBEDO, 1.0),
    metallic=0.0,
    specular=0.0,
    diffuse_transmission=SHARE,
    diffuse_transmission_color=tuple(TINT),
)
SUN = Light("directional", (2.0, 3.0, 5.0), direction=(0.0, -1.0, 0.0))
WHITE_SKY = environment_from_color((1.0, 1.0, 1.0))


def _appearance(material: Material, images=()):
    from irradia.transport.backend import mi
    from irradia.transport.materials import MaterialTable
    from irradia.transport.textures import TextureTable

    textures = TextureTable(images)
    table = MaterialTable((material,), textures)
    textures.freeze()
    centre = mi.Point2f(0.5, 0.5)
    return table.appearance(mi.UInt32(0), centre, centre, mi.Vector4f(1.0), mi.Bool(True))


def _rgb(value) -> np.ndarray:
    return np.array(value).ravel()


def test_diffuse_part_is_shared_between_reflection_and_transmission():
    looks = _appearance(PAPER)
    np.testing.assert_allclose(_rgb(looks.reflected), ALBEDO * (1 - SHARE), rtol=1e-5)
    np.testing.assert_allclose(_rgb(looks.transmitted), TINT * SHARE, rtol=1e-5)
    np.testing.assert_allclose(_rgb(looks.reflectance), ALBEDO, rtol=1e-5)


def test_transmission_textures_are_alpha_for_the_share_and_srgb_for_the_colour():
    image = Image("leaf", np.full((1, 1, 4), (188, 255, 0, 51), np.uint8))
    looks = _appearance(
        Material(
            base_color=(0.5, 0.5, 0.5, 1.0),
            metallic=0.0,
            specular=0.0,
            diffuse_transmission=1.0,
            diffuse_transmission_texture=TextureRef(0),
            diffuse_transmission_color_texture=TextureRef(0),
        ),
        (image,),
    )
    np.testing.assert_allclose(_rgb(looks.transmitted), [0.2 * 0.503, 0.2, 0.0], rtol=2e-3)
    np.testing.assert_allclose(_rgb(looks.reflected), 0.5 * 0.8, rtol=1e-5)


@pytest.mark.parametrize("share", [0.3, 1.0])
@pytest.mark.parametrize("alpha", [0.3, 1.0])
@pytest.mark.parametrize("transmission", [0.0, 0.6])
@pytest.mark.parametrize("specular", [0.0, 1.0])
def test_no_split_of_light_creates_any(share, alpha, transmission, specular):
    looks = _appearance(
        Material(
            base_color=(1.0, 1.0, 0.2, alpha),
            metallic=0.0,
            specular=specular,
            alpha_mode="blend",
            transmission=transmission,
            diffuse_transmission=share,
            diffuse_transmission_color=(1.0, 4.0, 1.0),
        )
    )
    total = _rgb(looks.reflected) + _rgb(looks.transmitted) + _rgb(looks.through)
    assert (total <= 1.0 + 1e-6).all()
    assert (_rgb(looks.transmitted) > 0.0).all()


@pytest.mark.parametrize("up", [True, False])
def test_sheet_lit_from_behind_shines_on_what_is_before_it(up):
    """Radiance T·E/π all over the sheet, seen under its form factor."""
    world = world_of(stacked([Sheet(BLACK), Sheet(PAPER, y=1.0, width=3.0, depth=2.0, up=up)], lights=(SUN,)))
    expected = form_factor(3.0, 2.0, 1.0) * TINT * SHARE * np.array(SUN.intensity) / np.pi
    np.testing.assert_allclose(irradiance_over_pi(world, 0), expected, rtol=5e-3)


@pytest.mark.parametrize("double_sided", [True, False])
def test_only_double_sided_backs_reflect(double_sided):
    """From above, the sheet's back is seen: its light is R·E/π, or nothing where it has one side."""
    paper = replace(PAPER, double_sided=double_sided)
    lamp = Light("directional", (2.0, 3.0, 5.0), direction=(0.0, -1.0, 0.0))
    sheets = [
        Sheet(paper, y=-1.0, width=3.0, depth=2.0, up=False),
        Sheet(BLACK, up=False, instance={"casts": False}),
    ]
    world = world_of(stacked(sheets, lights=(lamp,)))
    reflected = ALBEDO * (1 - SHARE) * double_sided
    expected = form_factor(3.0, 2.0, 1.0) * reflected * np.array(lamp.intensity) / np.pi
    np.testing.assert_allclose(irradiance_over_pi(world, 2, 1 << 16), expected, rtol=1e-2)


@pytest.mark.parametrize(("up", "reaches"), [(True, ALBEDO * (1 - SHARE)), (False, TINT * SHARE)])
def test_albedo_times_map_is_what_leaves_the_front(up, reaches):
    """Lit from above, a sheet facing up shows R·E/π, and one facing down glows with T·E/π."""
    world = world_of(stacked([Sheet(PAPER, up=up)], lights=(SUN,)))
    expected = reaches * np.array(SUN.intensity) / np.pi
    np.testing.assert_allclose(irradiance_over_pi(world, 0) * ALBEDO, expected, rtol=1e-2)


def test_dark_paper_glows_at_most_sixteen_times_its_albedo():
    black = Material("film", (0.0, 0.0, 0.0, 1.0), metallic=0.0, specular=0.0, diffuse_transmission=0.5)
    world = world_of(stacked([Sheet(black, up=False)], lights=(SUN,)))
    np.testing.assert_allclose(irradiance_over_pi(world, 0), 16 * np.array(SUN.intensity) / np.pi, rtol=1e-2)


@pytest.mark.parametrize("share", [0.0, 0.25, 1.0])
def test_white_paper_under_a_white_sky_neither_gains_nor_loses(share):
    white = Material("white", metallic=0.0, specular=0.0, double_sided=True, diffuse_transmission=share)
    world = world_of(stacked([Sheet(white)], environment=WHITE_SKY))
    np.testing.assert_allclose(irradiance_over_pi(world, 0), 1.0, rtol=3e-3)


@pytest.mark.parametrize("share", [0.25, 1.0])
def test_stack_of_papers_never_gathers_more_than_the_sky_gives(share):
    paper = Material("white", metallic=0.0, specular=0.0, double_sided=True, diffuse_transmission=share)
    sheets = [Sheet(matte(1.0))] + [Sheet(paper, y=0.1 * k) for k in (1, 2, 3)]
    world = world_of(stacked(sheets, environment=WHITE_SKY))
    for sheet in range(4):
        assert irradiance_over_pi(world, 2 * sheet, 1 << 12).max() <= 1.0 + 1e-4


def test_opaque_scenes_know_no_sides():
    world = world_of(stacked([Sheet(matte(0.5))], lights=(SUN,)))
    from irradia.transport.backend import mi

    assert not world.translucent
    assert world.point(mi.UInt32(0), mi.Point2f(0.3, 0.3), mi.Bool(True)).sides is None


def test_back_of_paper_hides_no_texel():
    from irradia.transport.backend import mi

    from .flat_scenes import mi_point

    world = world_of(stacked([Sheet(PAPER), Sheet(matte(0.5), y=-1.0)]))
    backs = world.meets_back(mi_point(0.1, -0.5, 0.0), mi.Vector3f(0, 1, 0), mi.Bool(True))
    assert not np.array(backs)[0]
