"""Light for probes in walls: from the side they are on, never through the wall."""

from __future__ import annotations

import numpy as np
import pytest

from irradia.bake.probes.dilate import fill_invalid
from irradia.formats.probes import EMPTY, FILLED, VALID
from irradia.scene.builtin.shapes import box, quad
from irradia.scene.merge import merge

from .places import scene_of

pytestmark = pytest.mark.usefixtures("cpu_device")


def world_of(scene):
    from irradia.transport.world import World

    return World(scene, merge(scene))


def chain(n: int) -> np.ndarray:
    return np.array([(k, k + 1) for k in range(n - 1)])


def test_probe_in_a_wall_takes_the_light_of_the_nearer_side():
    world = world_of(scene_of(box((0, -5, -5), (1, 5, 5))))
    places = np.array([(-0.5, 0, 0), (0.1, 0, 0), (1.5, 0, 0)], np.float32)
    values = np.array([1.0, 0.0, 0.0], np.float32)[:, None]
    pairs = np.array([(0, 1), (1, 2)])
    filled, state = fill_invalid(world, places, values, np.array([True, False, True]), pairs)
    assert state.tolist() == [VALID, FILLED, VALID]
    np.testing.assert_allclose(filled[1], 0.81 / 0.82, rtol=1e-3)


def test_light_does_not_cross_a_second_wall():
    world = world_of(scene_of(box((0, -5, -5), (0.2, 5, 5)), box((0.5, -5, -5), (2.0, 5, 5))))
    places = np.array([(-0.5, 0, 0), (1.0, 0, 0), (2.5, 0, 0)], np.float32)
    values = np.array([7.0, 0.0, 2.0], np.float32)[:, None]
    pairs = np.array([(0, 1), (1, 2)])
    filled, _ = fill_invalid(world, places, values, np.array([True, False, True]), pairs)
    np.testing.assert_allclose(filled[1], 2.0)


def test_light_does_not_come_out_of_the_back_of_a_wall():
    """The giver is behind a single-sided wall, the taker before it: whatever is behind is no light of its."""
    world = world_of(scene_of(quad((0, -5, -5), (0, 10, 0), (0, 0, 10))))
    places = np.array([(0.5, 0, 0), (-0.5, 0, 0)], np.float32)
    values = np.array([0.0, 5.0], np.float32)[:, None]
    _, state = fill_invalid(world, places, values, np.array([False, True]), np.array([(0, 1)]))
    assert state.tolist() == [EMPTY, VALID]


def test_deep_probes_are_reached_step_by_step_and_valid_ones_are_untouched():
    world = world_of(scene_of(box((0, -5, -5), (4, 5, 5))))
    places = np.array([(x - 0.5, 0, 0) for x in range(4)], np.float32)
    values = np.array([[3.0], [9.0], [9.0], [9.0]], np.float32)
    valid = np.array([True, False, False, False])
    filled, state = fill_invalid(world, places, values, valid, chain(4))
    assert state.tolist() == [VALID, FILLED, FILLED, FILLED]
    np.testing.assert_allclose(filled, 3.0)


def test_what_nobody_can_light_is_empty_and_black():
    world = world_of(scene_of(box((0, -5, -5), (4, 5, 5))))
    places = np.array([(1, 0, 0), (2, 0, 0)], np.float32)
    values = np.full((2, 9, 3), 5.0, np.float32)
    filled, state = fill_invalid(world, places, values, np.zeros(2, bool), chain(2))
    assert state.tolist() == [EMPTY, EMPTY]
    assert not filled.any()
