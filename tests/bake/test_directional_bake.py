"""Bakes with directional maps and with normal maps against answers on paper."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest

from irradia.bake.directional_modes import MODES, SurfaceFrame
from irradia.cli.lighting import LightOptions, light_scene
from irradia.scene.builtin.builder import SceneBuilder
from irradia.scene.builtin.matte import matte
from irradia.scene.builtin.shapes import floor, quad
from irradia.scene.gltf import document_to_scene
from irradia.scene.types import Light, Material, Scene

from .lit_scenes import bake

pytestmark = pytest.mark.usefixtures("cpu_device")

UP = np.array([0.0, 1.0, 0.0])
TO_SUN = np.array([0.48, 0.8, -0.36])
SUN_LUX = np.array([3.0, 2.0, 1.0])
SKY = np.array([0.2, 0.4, 0.8])
ALL = {"sun": True, "sky": True, "lamp": True}
TILT = np.array([0.35, 0.15])  # of the normal map, along u and up the image
SURFACE = SurfaceFrame(UP, np.array([1.0, 0.0, 0.0]), np.array([0.0, 0.0, -1.0]))


def plane(*, sun=False, sky=False, lamp=False, bent=False) -> Scene:
    """A floor of 2 × 2 m, u along +X and the image's top toward −Z."""
    scene = SceneBuilder("plane")
    texture = scene.texture("bent", np.broadcast_to(normal_pixel(), (4, 4, 3)).copy()) if bent else None
    ground = Material("g", (0.5, 0.5, 0.5, 1.0), metallic=0.0, specular=0.0, normal_texture=texture)
    scene.object("ground", (floor(2, 2), scene.material(ground)))
    if lamp:
        light = matte("lamp", (0.0, 0.0, 0.0), emission=(6.0, 4.0, 2.0), double_sided=True)
        sheet = quad((-1.4, 0.2, -0.6), (0, 0.9, 0), (0, 0, 1.2))
        scene.object("lamp", (sheet, scene.material(light)), lightmap_scale=0.0)
    if sun:
        scene.light(Light("directional", tuple(SUN_LUX), direction=tuple(-TO_SUN)))
    scene.environment_color(tuple(SKY) if sky else (0.0, 0.0, 0.0))
    return light_scene(document_to_scene(scene.build()), LightOptions())


def normal_pixel() -> np.ndarray:
    return np.round((np.array([*TILT, np.sqrt(1 - TILT @ TILT)]) * 0.5 + 0.5) * 255).astype(np.uint8)


def bent_normal() -> np.ndarray:
    """World-space normal that the texture shows on the floor, its rounding included."""
    x, y, z = normal_pixel() / 255.0 * 2.0 - 1.0
    normal = x * SURFACE.tangent + y * SURFACE.bitangent + z * UP
    return normal / np.linalg.norm(normal)


@cache
def baked(mode: str | None, **light: bool):
    return bake(plane(**light), 16, 256, directional=mode)


@cache
def baked_with_normal_map():
    return bake(plane(bent=True, **ALL), 16, 256, normal_maps=True)


def inner(pages):
    """Texels away from the page's rim."""
    return pages[0, 4:12, 4:12].reshape(-1, 3)


def maps_of(result):
    return {name: inner(pages).astype(np.float64) for name, pages in result.directional.pages.items()}


def test_even_sky_has_half_its_radiance_as_mean_and_half_a_unit_as_direction():
    maps = maps_of(baked("sh", sky=True))
    np.testing.assert_allclose(maps["sh_l0"].mean(axis=0), SKY / 2, rtol=5e-3)
    np.testing.assert_allclose(maps["sh_y"].mean(axis=0), 0.75, atol=3e-3)
    for axis in "xz":
        np.testing.assert_allclose(maps[f"sh_{axis}"].mean(axis=0), 0.5, atol=3e-3)


def test_sun_is_one_direction_and_a_quarter_of_its_facing_light():
    maps = maps_of(baked("sh", sun=True))
    np.testing.assert_allclose(maps["sh_l0"], np.tile(SUN_LUX / (4 * np.pi), (64, 1)), rtol=1e-4)
    for axis, component in zip("xyz", TO_SUN, strict=True):
        np.testing.assert_allclose(2 * maps[f"sh_{axis}"] - 1, component, atol=1e-4)


@pytest.mark.parametrize("mode", MODES)
def test_a_directional_bake_has_the_plain_map_of_a_plain_bake(mode):
    plain, directional = (inner(baked(m, **ALL).pages) for m in (None, mode))
    assert directional.mean() == pytest.approx(plain.mean(), rel=5e-3)
    assert np.sqrt(np.mean((directional / plain - 1) ** 2)) < 0.05


@pytest.mark.parametrize(
    ("mode", "within"), [("dominant", 0.15), ("rnm", 0.15), ("sh", 0.04), ("mono-sh", 0.05)]
)
def test_relighting_gives_what_a_bake_with_normal_maps_gives(mode, within):
    truth = inner(baked_with_normal_map().pages)
    result = baked(mode, **ALL)
    plain = inner(result.pages)
    relit = MODES[mode].irradiance_over_pi(plain, maps_of(result), bent_normal(), SURFACE)
    error = np.sqrt(np.mean((relit / truth - 1) ** 2))
    assert error < within
    assert error < 0.6 * np.sqrt(np.mean((plain / truth - 1) ** 2))


def test_normal_maps_turn_the_receiver_towards_the_sun():
    result = bake(plane(sun=True, bent=True), 16, 16, normal_maps=True)
    expected = SUN_LUX * (bent_normal() @ TO_SUN) / np.pi
    np.testing.assert_allclose(inner(result.pages), np.tile(expected, (64, 1)), rtol=1e-4)


def test_a_plain_bake_has_no_directional_maps():
    assert baked(None, **ALL).directional is None
