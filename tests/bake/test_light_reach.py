"""What a light is said not to reach, it doesn't; and the bounds are tight enough to be of use."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from irradia.bake import light_reach
from irradia.bake.light_reach import cut_patches, reaches, strength
from irradia.bake.shadow_mask import plan_shadow_mask
from irradia.scene.merge import merge
from irradia.scene.types import IesProfile, Light

from .lit_scenes import laid_out, lit
from .quads import quad, quad_scene

_FLOOR = quad((-5, 0, -5), (0, 0, 10), (10, 0, 0))


def _mesh(*quads):
    scene = quad_scene(*quads)
    return merge(scene, laid_out(scene, 64))


def _random_light(rng, kind: str, high: np.ndarray) -> Light:
    direction = rng.normal(size=3)
    direction /= np.linalg.norm(direction)
    return Light(
        kind,
        (1.0, 1.0, 1.0),
        position=tuple(rng.uniform(-0.2, 1.2, 3) * high),
        direction=tuple(direction),
        range_m=float(rng.uniform(0.1, 0.6)) if rng.random() < 0.7 else None,
        outer_cone_rad=float(rng.uniform(0.1, math.pi / 2)),
        mode="mixed",
    )


def _offers(light: Light, points: np.ndarray, normals: np.ndarray) -> np.ndarray:
    """Whether points get any light with nothing in the way, by the definition of each kind."""
    if light.kind == "directional":
        return normals @ -np.array(light.direction) > 0.0
    towards = np.array(light.position) - points
    distance = np.linalg.norm(towards, axis=1)
    lit = (towards * normals).sum(axis=1) > 0.0
    if light.range_m is not None:
        lit &= distance < light.range_m
    if light.kind == "spot":
        lit &= -towards @ np.array(light.direction) > distance * math.cos(light.outer_cone_rad)
    return lit


def _random_points(mesh, n: int, rng) -> tuple[np.ndarray, np.ndarray]:
    triangle = rng.integers(len(mesh.indices), size=n)
    a, b, c = np.moveaxis(mesh.positions[mesh.indices[triangle]].astype(np.float64), 1, 0)
    u, v = np.sort(rng.random((2, n)), axis=0)
    cross = np.cross(b - a, c - a)
    normals = cross / np.linalg.norm(cross, axis=1, keepdims=True)
    return a + (b - a) * u[:, None] + (c - a) * (v - u)[:, None], normals


@pytest.mark.parametrize("n_patches", [1 << 13, 48])
@pytest.mark.parametrize("name", ["cornell", "cylinder"])
@pytest.mark.parametrize("kind", ["point", "spot", "directional"])
def test_lights_that_meet_anywhere_overlap(name, kind, n_patches, monkeypatch):
    monkeypatch.setattr(light_reach, "_N_PATCHES", n_patches)
    scene = lit(name)
    mesh = merge(scene, laid_out(scene, 64))
    rng = np.random.default_rng(3)
    lights = [_random_light(rng, kind, mesh.positions.max(axis=0)) for _ in range(24)]
    points, normals = _random_points(mesh, 4000, rng)
    offered = np.array([_offers(light, points, normals) for light in lights])
    patches = cut_patches(mesh)
    reached = np.array([reaches(light, patches) for light in lights])
    meet = (offered[:, None] & offered[None]).any(axis=2)
    said = (reached[:, None] & reached[None]).any(axis=2)
    assert meet[~np.eye(24, dtype=bool)].any()
    assert not (meet & ~said).any()
    channels = plan_shadow_mask(mesh, tuple(lights)).channels
    for a, b in np.argwhere(np.triu(meet, 1)):
        assert channels[a] is None or channels[a] != channels[b]


def test_patches_cover_the_mapped_surface_once():
    scene = lit("cornell")
    mesh = merge(scene, laid_out(scene, 64))
    corners = mesh.positions[mesh.indices].astype(np.float64)
    cross = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    patches = cut_patches(mesh)
    assert patches.area_m2.sum() == pytest.approx(np.linalg.norm(cross, axis=1).sum() / 2, rel=1e-5)
    assert len(patches.low) < 1 << 17


def test_surfaces_without_texels_take_no_light():
    scene = quad_scene(_FLOOR, quad((-5, 3, -5), (10, 0, 0), (0, 0, 10)), mapped=1)
    patches = cut_patches(merge(scene, laid_out(scene, 64)))
    assert patches.high[:, 1].max() == 0.0


def test_a_light_below_a_floor_does_not_reach_its_top():
    patches = cut_patches(_mesh(_FLOOR))
    lamp = Light("point", (1, 1, 1), position=(1.0, -0.01, 0.3))
    assert not reaches(lamp, patches).any()
    assert reaches(replace(lamp, radius_m=0.02), patches).all()
    assert not reaches(Light("directional", (1, 1, 1), direction=(0, 1, 0)), patches).any()
    assert not reaches(Light("directional", (1, 1, 1), direction=(1, 0, 0)), patches).any()


def test_a_lamp_between_two_steps_reaches_the_lower_one(monkeypatch):
    monkeypatch.setattr(light_reach, "_N_PATCHES", 1)
    monkeypatch.setattr(light_reach, "_JUMPS_ACROSS", 1)
    patches = cut_patches(_mesh(_FLOOR, quad((-5, 1, -5), (0, 0, 10), (2, 0, 0))))
    assert len(patches.low) == 1  # of both steps
    assert reaches(Light("point", (1, 1, 1), position=(0.0, 0.1, 0.0)), patches).all()
    assert not reaches(Light("point", (1, 1, 1), position=(0.0, -0.1, 0.0)), patches).any()


def test_patches_of_many_small_pieces_stay_small(monkeypatch):
    """Crates all over a large floor: a lamp beside one must not be said to reach another."""
    monkeypatch.setattr(light_reach, "_N_PATCHES", 100)
    crates = [
        quad((x, 0.0, z), (0.1, 0, 0), (0, 0.1, 0)) for x in range(-12, 12, 3) for z in range(-12, 12, 3)
    ]
    patches = cut_patches(_mesh(quad((-12, 0, -12), (0, 0, 24), (24, 0, 0)), *crates))
    of_crates = patches.high[:, 1] > 0.0
    assert np.ptp([patches.low[of_crates], patches.high[of_crates]], axis=0).max() < 0.2


def test_range_and_cone_are_resolved_to_a_small_part_of_the_floor():
    patches = cut_patches(_mesh(_FLOOR))
    lamp = Light("point", (1, 1, 1), position=(0.0, 0.5, 0.0), range_m=1.0)
    disc = math.pi * (1.0 - 0.25)
    assert 1.0 < patches.area_m2[reaches(lamp, patches)].sum() / disc < 1.2
    spot = Light("spot", (1, 1, 1), position=(0, 2, 0), direction=(0, -1, 0), outer_cone_rad=math.radians(30))
    disc = math.pi * (2.0 * math.tan(math.radians(30))) ** 2
    assert 1.0 < patches.area_m2[reaches(spot, patches)].sum() / disc < 1.2


def test_a_profile_that_sends_light_downward_alone_is_a_cone():
    patches = cut_patches(_mesh(_FLOOR))
    candela = np.zeros((181, 5), np.float32)
    candela[:30] = 100.0  # nothing from 30° on
    lamp = Light("spot", (1, 1, 1), position=(0, 2, 0), direction=(0, -1, 0), profile=IesProfile(candela))
    disc = math.pi * (2.0 * math.tan(math.radians(30))) ** 2
    assert 1.0 < patches.area_m2[reaches(lamp, patches)].sum() / disc < 1.2
    candela[:] = 100.0
    assert reaches(lamp, patches).all()


def test_strength_grows_with_power_and_with_what_it_falls_on():
    patches = cut_patches(_mesh(_FLOOR))
    lamp = Light("point", (1, 1, 1), position=(0.0, 1.0, 0.0))
    all_of_it = reaches(lamp, patches)
    double = replace(lamp, intensity=(2, 2, 2))
    assert strength(double, patches, all_of_it) == pytest.approx(2 * strength(lamp, patches, all_of_it))
    near = replace(lamp, range_m=1.2)
    assert strength(near, patches, reaches(near, patches)) < strength(lamp, patches, all_of_it)
    sun = Light("directional", (3, 3, 3), direction=(0, -1, 0))
    assert strength(sun, patches, all_of_it) == pytest.approx(300.0, rel=1e-5)


def test_lamps_on_both_sides_of_a_floor_share_channels():
    """Four above and four below overlap among themselves alone."""
    ceiling_below = quad((-5, -0.2, -5), (10, 0, 0), (0, 0, 10))
    mesh = _mesh(_FLOOR, ceiling_below)
    lamps = tuple(
        Light("point", (1, 1, 1), position=(float(x), y, 0.0), mode="mixed")
        for y in (1.0, -1.2)
        for x in range(-2, 2)
    )
    plan = plan_shadow_mask(mesh, lamps)
    assert plan.fallback == ()
    assert sorted(plan.channels[:4]) == [0, 1, 2, 3]
    assert sorted(plan.channels[4:]) == [0, 1, 2, 3]
