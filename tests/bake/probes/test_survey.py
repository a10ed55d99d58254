"""Validity, ways out of walls, sky and how far probes see."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from irradia.bake.probes.octahedral import octahedral_directions
from irradia.bake.probes.survey import DISTANCE_SIZE, Survey, survey
from irradia.core import silent_progress
from irradia.scene.builtin.shapes import box, floor, quad
from irradia.scene.merge import merge
from irradia.scene.types import Scene

from .places import scene_of, thick_block

pytestmark = pytest.mark.usefixtures("cpu_device")


def look(scene: Scene, positions, spacing_m=1.0) -> Survey:
    from irradia.transport.world import World

    positions = np.array(positions, np.float32)
    with silent_progress().stage("look") as stage:
        world = World(scene, merge(scene))
        return survey(world, positions, np.full(len(positions), spacing_m, np.float32), stage)


def test_probes_in_the_open_are_valid_and_stay():
    found = look(thick_block(), [(1.5, 0, 0), (0, 4, 0)])
    assert found.valid.all()
    assert not found.offsets.any()


def test_probe_deep_inside_is_invalid_and_stays():
    found = look(thick_block(), [(0, 0, 0)])
    assert not found.valid[0]
    assert found.validity[0] < 0.01
    assert not found.offsets.any()


def test_probe_just_under_a_surface_moves_out_the_short_way():
    found = look(thick_block(), [(0.9, 0.1, 0.0)])
    assert found.valid[0]
    np.testing.assert_allclose(found.offsets[0, 0], 0.1 + 0.2, atol=0.02)
    assert np.abs(found.offsets[0, 1:]).max() < 0.05


def test_no_probe_moves_further_than_half_its_spacing():
    positions = np.random.default_rng(4).uniform(-1, 1, (300, 3))
    found = look(thick_block(), positions, spacing_m=0.5)
    moved = np.linalg.norm(found.offsets, axis=1)
    assert moved.max() <= 0.45 * 0.5 + 1e-6
    assert (moved > 0).any()
    outside = np.abs(positions + found.offsets).max(axis=1) > 1.0
    np.testing.assert_array_equal(found.valid, outside)


def test_probe_stays_where_the_short_way_out_leads_into_the_next_solid():
    found = look(scene_of(box((-1, -1, -1), (1, 1, 1)), box((0.4, -1, -1), (3, 1, 1))), [(0.9, 0, 0)])
    assert not found.valid[0]
    assert not found.offsets.any()


def test_behind_a_leaf_is_not_in_a_wall():
    leaf = scene_of(quad((-1, -1, 0), (2, 0, 0), (0, 2, 0)))
    assert not look(leaf, [(0, 0, -0.1)], spacing_m=0.01).valid[0]
    both_sides = replace(leaf, materials=(replace(leaf.materials[0], double_sided=True),))
    assert look(both_sides, [(0, 0, -0.1)], spacing_m=0.01).valid[0]


def test_half_of_the_sky_is_seen_above_a_plane():
    found = look(scene_of(floor(2000, 2000)), [(0, 1, 0)])
    half = np.array([0.5 * np.sqrt(4 * np.pi), 0.488603 * np.pi, 0.0, 0.0])
    np.testing.assert_allclose(found.sky[0], half, atol=0.02)


def test_closed_room_sees_no_sky_and_open_air_all_of_it():
    room = scene_of(box((-1, -1, -1), (1, 1, 1)).inside_out())
    assert not look(room, [(0, 0, 0)]).sky.any()
    all_of_it = look(thick_block(), [(0, 900, 0)]).sky[0]
    np.testing.assert_allclose(all_of_it, (np.sqrt(4 * np.pi), 0, 0, 0), atol=0.02)


def test_distances_are_those_to_the_walls_up_to_the_reach():
    room = scene_of(box((-1, -1, -1), (1, 1, 1)).inside_out())
    found = look(room, [(0, 0, 0)])
    exact = 1.0 / np.abs(octahedral_directions(DISTANCE_SIZE)).max(axis=1)
    mean = found.distance[0, ..., 0].ravel()
    np.testing.assert_allclose(mean, exact, rtol=0.05)
    assert found.distance[0, ..., 1].max() < 0.1
    far = look(thick_block(), [(0, 900, 0)])
    np.testing.assert_allclose(far.distance[0, 0, 0, 0], far.reach[0], rtol=1e-5)
