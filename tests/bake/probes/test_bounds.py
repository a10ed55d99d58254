"""The space that probes fill."""

from __future__ import annotations

import numpy as np
import pytest

from irradia.bake.probes.bounds import probe_box
from irradia.scene.builtin.shapes import box, floor
from irradia.scene.merge import merge

from .places import WALL_M, scene_of, thick_block, two_rooms

pytestmark = pytest.mark.usefixtures("cpu_device")


def box_of(scene):
    from irradia.transport.world import World

    mesh = merge(scene)
    return probe_box(World(scene, mesh), mesh)


def test_street_around_a_house_is_left_out():
    inner, outer = box((-6, 0.1, -6), (6, 4, 6)).inside_out(), box((-6.3, 0, -6.3), (6.3, 4.3, 6.3))
    low, high = box_of(scene_of(floor(24, 24), inner, outer))
    np.testing.assert_allclose(low, (-6, 0, -6), atol=1.6)
    np.testing.assert_allclose(high, (6, 4.3, 6), atol=1.6)


def test_every_room_belongs_to_the_house_though_its_doors_are_shut():
    low, high = box_of(two_rooms())
    np.testing.assert_allclose(low, (-2 - WALL_M / 2, 0, -1), atol=1e-6)
    np.testing.assert_allclose(high, (2 + WALL_M / 2, 2, 1), atol=1e-6)


def test_open_scene_has_room_around_it_but_not_below():
    low, high = box_of(thick_block())
    np.testing.assert_allclose(low, (-1.2, -1.0, -1.2), atol=1e-6)
    np.testing.assert_allclose(high, (1.2, 1.2, 1.2), atol=1e-6)
