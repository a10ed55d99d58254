"""Diffuse transmission through whole bakes."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from irradia.scene.builtin import pane
from irradia.scene.types import Material, Scene

from .lit_scenes import bake, instance_of, laid_out, lit, places

pytestmark = pytest.mark.usefixtures("cpu_device")

SHARE, TINT, ALBEDO = 0.6, np.array([0.9, 0.5, 0.2]), 0.4
PAPER = Material(
    "paper",
    base_color=(ALBEDO, ALBEDO, ALBEDO, 1.0),
    metallic=0.0,
    specular=0.0,
    diffuse_transmission=SHARE,
    diffuse_transmission_color=(0.9, 0.5, 0.2),
)


def _papered(*, facing_in: bool) -> Scene:
    """The dark room whose window is now of paper, its front inside or outside."""
    scene = lit("pane")
    window = next(i for i, material in enumerate(scene.materials) if material.name == "glass")
    primitives = tuple(
        replace(p, indices=p.indices[:, ::-1].copy(), normals=-p.normals)
        if p.material == window and facing_in
        else p
        for p in scene.primitives
    )
    materials = tuple(PAPER if i == window else material for i, material in enumerate(scene.materials))
    return replace(scene, primitives=primitives, materials=materials)


@pytest.mark.parametrize("integrator", ["cached", "path"])
@pytest.mark.parametrize("facing_in", [True, False])
def test_paper_window_lights_the_floor_by_its_form_factor(integrator, facing_in):
    """Outside E/π is 1, so the window's radiance is T; the cache knows it where the front is inside."""
    scene = _papered(facing_in=facing_in)
    mesh, texels, positions = places(scene, laid_out(scene, 48))
    on_floor = (instance_of(mesh, texels) == 0) & (positions[..., 1].max(axis=1) < 1e-6)
    factor = _form_factor(positions[on_floor]).mean()
    baked = bake(scene, 48, 512, integrator=integrator).irradiance_over_pi[on_floor]
    np.testing.assert_allclose(baked.mean(axis=0), factor * SHARE * TINT, rtol=1e-2)


@pytest.mark.parametrize("facing_in", [True, False])
def test_albedo_times_map_is_what_the_window_shows_on_its_front(facing_in):
    """Inside it is dark: the window glows inward with T and shines outward with R."""
    scene = _papered(facing_in=facing_in)
    mesh, texels, _ = places(scene, laid_out(scene, 48))
    on_window = instance_of(mesh, texels) == 1
    shown = ALBEDO * bake(scene, 48, 128).irradiance_over_pi[on_window].mean(axis=0)
    np.testing.assert_allclose(shown, SHARE * TINT if facing_in else ALBEDO * (1 - SHARE), rtol=1e-2)


def test_cached_gather_has_the_path_tracers_mean_among_paper_boxes():
    """Cornell's blocks of thin, double-sided paper: light goes in and out, and bounces inside."""
    scene = lit("cornell")
    paper = len(scene.materials)
    primitives = tuple(replace(p, material=paper) if "block" in p.name else p for p in scene.primitives)
    assert sum(p.material == paper for p in primitives) == 2
    materials = (*scene.materials, replace(PAPER, double_sided=True))
    scene = replace(scene, primitives=primitives, materials=materials)
    cached = bake(scene, 64, 128)
    path = bake(scene, 64, 128, integrator="path")
    on_block = np.isin(*_instances(scene))
    for chosen in (on_block & path.valid, ~on_block & path.valid):
        ratio = cached.irradiance_over_pi[chosen].mean(0) / path.irradiance_over_pi[chosen].mean(0)
        np.testing.assert_allclose(ratio, 1.0, atol=1e-2)


def _instances(scene: Scene) -> tuple[np.ndarray, list[int]]:
    """The instance of each texel, and the instances of blocks."""
    mesh, texels, _ = places(scene, laid_out(scene, 64))
    blocks = [i for i, placed in enumerate(scene.instances) if "block" in placed.name]
    return instance_of(mesh, texels), blocks


def _form_factor(points: np.ndarray) -> np.ndarray:
    """Differential element facing the window (Howell, B-3)."""
    total = np.zeros(points.shape[:-1])
    for sx in (-1, 1):
        for sz in (-1, 1):
            x = (sx * pane.PANE_WIDTH_M / 2 - points[..., 0]) / pane.HEIGHT_M
            z = (sz * pane.PANE_DEPTH_M / 2 - points[..., 2]) / pane.HEIGHT_M
            rx, rz = np.sqrt(1 + x**2), np.sqrt(1 + z**2)
            total += sx * sz * (x / rx * np.arctan(z / rx) + z / rz * np.arctan(x / rz)) / (2 * np.pi)
    return total
