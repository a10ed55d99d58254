"""Light against answers on paper."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from irradia.scene.builtin import pane, plane_point, rectangle
from irradia.scene.environment import environment_from_color
from irradia.scene.types import Light

from .lit_scenes import bake, instance_of, laid_out, lit, places, without_light

pytestmark = pytest.mark.usefixtures("cpu_device")


@pytest.mark.parametrize(("name", "reflectance"), [("furnace", 0.5), ("furnace-80", 0.8)])
@pytest.mark.parametrize("integrator", ["cached", "path"])
def test_furnace_glows_with_the_geometric_series(name, reflectance, integrator):
    result = bake(lit(name), 64, 256, integrator=integrator)
    mean = result.irradiance_over_pi.mean(dtype=np.float64)
    assert mean == pytest.approx(1 / (1 - reflectance), rel=2e-3)


def test_point_light_follows_cosine_over_distance_squared():
    scene = lit("plane-point")
    _, _, positions = places(scene, laid_out(scene, 64))
    towards = np.array([0.0, plane_point.HEIGHT_M, 0.0]) - positions
    distance = np.linalg.norm(towards, axis=-1)
    irradiance = (towards[..., 1] / distance**3).mean(axis=1)
    expected = irradiance[:, None] * np.array(plane_point.INTENSITY_CD) / np.pi
    result = bake(scene, 64, 8)
    np.testing.assert_allclose(result.irradiance_over_pi, expected, rtol=5e-3)


def test_rectangle_light_follows_its_form_factor():
    scene = lit("rectangle")
    mesh, texels, positions = places(scene, laid_out(scene, 64))
    on_plane = instance_of(mesh, texels) == 0
    factor = _rectangle_form_factor(
        positions[on_plane], rectangle.WIDTH_M, rectangle.DEPTH_M, rectangle.HEIGHT_M
    ).mean(axis=1)
    expected = factor[:, None] * np.array(rectangle.RADIANCE)
    baked = bake(scene, 64, 256).irradiance_over_pi[on_plane]
    np.testing.assert_allclose(baked.mean(axis=0), expected.mean(axis=0), rtol=5e-3)
    assert np.percentile(np.abs(baked / expected - 1), 95) < 0.05


def test_tinted_pane_colours_what_it_lets_in():
    scene = lit("pane")
    mesh, texels, positions = places(scene, laid_out(scene, 64))
    on_floor = (instance_of(mesh, texels) == 0) & (positions[..., 1].max(axis=1) < 1e-6)
    factor = _rectangle_form_factor(
        positions[on_floor], pane.PANE_WIDTH_M, pane.PANE_DEPTH_M, pane.HEIGHT_M
    ).mean(axis=1)
    expected = factor.mean() * np.array(pane.TINT)
    baked = bake(scene, 64, 1024).irradiance_over_pi[on_floor]
    np.testing.assert_allclose(baked.mean(axis=0), expected, rtol=5e-3)


def test_closed_room_without_light_is_exactly_black():
    result = bake(lit("closed"), 64, 32)
    assert result.valid.all()
    assert not result.irradiance_over_pi.any()


def test_no_light_means_exactly_no_light():
    result = bake(without_light(lit("cornell")), 64, 8)
    assert not result.irradiance_over_pi.any()


def test_materials_that_would_never_let_light_die_are_named():
    scene = lit("furnace")
    white = replace(scene.materials[0], name="mirror-white", base_color=(1.0, 1.0, 1.0, 1.0))
    assert bake(scene, 64, 1).stats["clamped_materials"] == []
    result = bake(replace(scene, materials=(white,)), 64, 1)
    assert result.stats["clamped_materials"] == ["mirror-white"]


@pytest.mark.parametrize("integrator", ["cached", "path"])
def test_white_environment_is_never_exceeded(integrator):
    """A body in a uniform environment of 1 with ρ ≤ 1 can't gather more than 1."""
    scene = replace(without_light(lit("blocks")), environment=environment_from_color((1.0, 1.0, 1.0)))
    result = bake(scene, 192, 64, integrator=integrator)
    assert result.irradiance_over_pi.max() <= 1.0 + 1e-4


def test_single_sources_sum_to_all_of_them_together():
    scene = replace(without_light(lit("cornell")), lights=())
    lamps = lit("cornell").materials
    point = (Light("point", (0.02, 0.02, 0.02), position=(0.15, 0.4, 0.3)),)
    sky = environment_from_color((0.2, 0.3, 0.4))
    alone = [
        replace(scene, materials=lamps),
        replace(scene, lights=point),
        replace(scene, environment=sky),
    ]
    together = replace(scene, materials=lamps, lights=point, environment=sky)
    total = sum(bake(s, 64, 128).irradiance_over_pi.mean(axis=0, dtype=np.float64) for s in alone)
    joint = bake(together, 64, 128).irradiance_over_pi.mean(axis=0, dtype=np.float64)
    np.testing.assert_allclose(joint, total, rtol=5e-3)


@pytest.mark.parametrize("source", ["environment", "emission", "point", "all"])
def test_cached_gather_has_the_path_tracers_mean(source):
    scene = lit("cornell")
    lamps, scene = scene.materials, without_light(scene)
    if source in ("emission", "all"):
        scene = replace(scene, materials=lamps)
    if source in ("point", "all"):
        scene = replace(scene, lights=(Light("point", (0.02, 0.02, 0.02), position=(0.15, 0.4, 0.3)),))
    if source in ("environment", "all"):
        scene = replace(scene, environment=environment_from_color((0.2, 0.3, 0.4)))
    cached = bake(scene, 96, 256)
    path = bake(scene, 96, 256, integrator="path")
    ratio = cached.irradiance_over_pi[path.valid].mean(0) / path.irradiance_over_pi[path.valid].mean(0)
    np.testing.assert_allclose(ratio, 1.0, atol=1e-2)


def test_smooth_cylinder_shades_like_a_round_one():
    """Facets that face the sun show max(0, n·l) of the interpolated normal: no terminator bands."""
    scene = lit("cylinder")
    layout = laid_out(scene, 256)
    mesh, texels, _ = places(scene, layout)
    sun = scene.lights[0]
    triangle, weights = texels.locate(mesh)
    corners = mesh.indices[triangle]
    smooth = np.einsum("nsk,nskc->nsc", weights, mesh.normals[corners].astype(np.float64))
    smooth /= np.linalg.norm(smooth, axis=-1, keepdims=True)
    edges = mesh.positions[corners].astype(np.float64)
    facet = np.cross(edges[:, :, 1] - edges[:, :, 0], edges[:, :, 2] - edges[:, :, 0])
    towards_sun = -np.array(sun.direction)
    faces_sun = facet @ towards_sun > 1e-6 * np.linalg.norm(facet, axis=-1)
    expected = np.where(faces_sun, np.maximum(smooth @ towards_sun, 0.0), 0.0).mean(axis=1)
    on_side = (instance_of(mesh, texels) == 1) & (np.abs(smooth[..., 1]).max(axis=1) < 0.1)
    baked = bake(scene, 256, 8).irradiance_over_pi[:, 0] * np.pi / sun.intensity[0]
    np.testing.assert_allclose(baked[on_side], expected[on_side], atol=2e-3)


def _rectangle_form_factor(points, width, depth, height):
    """Differential element facing a parallel rectangle centred above the origin (Howell, B-3)."""
    total = np.zeros(points.shape[:-1])
    for sx in (-1, 1):
        for sz in (-1, 1):
            x = (sx * width / 2 - points[..., 0]) / height
            z = (sz * depth / 2 - points[..., 2]) / height
            rx, rz = np.sqrt(1 + x**2), np.sqrt(1 + z**2)
            corner = (x / rx * np.arctan(z / rx) + z / rz * np.arctan(x / rz)) / (2 * np.pi)
            total += sx * sz * corner
    return total
