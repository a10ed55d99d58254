"""Who sees whom: levels of detail, and objects that only receive light."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from irradia.scene.environment import environment_from_color
from irradia.scene.merge import CAMERA_LOD, LEVEL_BITS, merge, seen_by_camera
from irradia.scene.types import Material

from .flat_scenes import (
    BLACK,
    Sheet,
    form_factor,
    hit_above,
    hit_below,
    irradiance_over_pi,
    matte,
    mi_point,
    stacked,
    world_of,
)

pytestmark = pytest.mark.usefixtures("cpu_device")

GREY = matte(0.5)
LAMP = replace(BLACK, emission=(1.0, 2.0, 3.0))


def level(group: int, number: int) -> dict:
    return {"lod_group": group, "lod_level": number}


def lod_of(group: int, number: int) -> int:
    return (group + 1) << LEVEL_BITS | number


@pytest.fixture
def two_objects():
    """From the top: B1, A1, B0, A0, floor; two triangles each, in this order from 0."""
    return world_of(
        stacked(
            [
                Sheet(GREY, y=4.0, instance=level(1, 1)),
                Sheet(GREY, y=3.0, instance=level(0, 1)),
                Sheet(GREY, y=2.0, instance=level(1, 0)),
                Sheet(GREY, y=1.0, instance=level(0, 0)),
                Sheet(GREY, y=0.0),
            ]
        )
    )


@pytest.mark.parametrize(
    ("lod", "from_above", "from_below"),
    [
        (None, 2.0, 0.0),
        (0, 2.0, 0.0),
        (lod_of(0, 0), 2.0, 0.0),
        (lod_of(0, 1), 3.0, 0.0),
        (lod_of(1, 1), 4.0, 0.0),
        (lod_of(1, 2), 1.0, 0.0),
        (lod_of(2, 1), 2.0, 0.0),
    ],
)
def test_own_level_is_seen_and_the_finest_of_all_other_objects(two_objects, lod, from_above, from_below):
    assert hit_below(two_objects, lod=lod)[1] == pytest.approx(from_above, abs=1e-5)
    assert hit_above(two_objects, lod=lod)[1] == pytest.approx(from_below, abs=1e-5)


def test_hidden_levels_neither_block_nor_count_as_backs(two_objects):
    from irradia.transport.backend import mi

    up, yes = mi.Vector3f(0, 1, 0), mi.Bool(True)
    above_b0 = mi_point(0.1, 2.5, 0.0)
    for lod, arrives in ((None, 1.0), (mi.UInt32(lod_of(0, 1)), 0.0), (mi.UInt32(lod_of(2, 0)), 1.0)):
        light = two_objects.transmittance(above_b0, up, mi.Float(1e30), yes, lod)
        assert np.array(light).ravel()[0] == arrives
        assert np.array(two_objects.meets_back(above_b0, up, yes, lod))[0] == (arrives == 0.0)
        short = two_objects.geometry.occluded(above_b0, up, mi.Float(0.4), yes, lod)
        assert not np.array(short)[0]


def test_light_is_filtered_by_the_levels_that_are_seen_alone():
    from irradia.transport.backend import mi

    glass = Material(base_color=(0.5, 0.25, 1.0, 1.0), metallic=0.0, specular=0.0, transmission=1.0)
    sheets = [
        Sheet(glass, y=1.0, instance=level(0, 0)),
        Sheet(glass, y=2.0, instance=level(0, 1)),
        Sheet(glass, y=3.0),
    ]
    world = world_of(stacked(sheets))
    light = world.transmittance(mi_point(0.1, 0, 0), mi.Vector3f(0, 1, 0), mi.Float(1e30), mi.Bool(True))
    np.testing.assert_allclose(np.array(light).ravel(), [0.25, 0.0625, 1.0], rtol=1e-5)


def test_levels_in_the_same_place_are_told_apart():
    """As where levels share part of a mesh: each is met in its own triangles."""
    same = [Sheet(GREY, instance=level(0, k)) for k in range(3)]
    world = world_of(stacked([*same, Sheet(GREY, up=False, instance=level(0, 1))]))
    assert hit_below(world)[0] in (0, 1)
    assert hit_below(world, lod=lod_of(0, 1))[0] in (2, 3)
    assert hit_above(world, lod=lod_of(0, 1))[0] in (6, 7)
    assert hit_below(world, lod=lod_of(0, 2))[0] in (4, 5)
    assert hit_above(world, lod=lod_of(0, 2))[0] in (4, 5)


def test_objects_of_a_single_level_cost_nothing():
    scene = stacked([Sheet(GREY, instance=level(0, 0)), Sheet(GREY, y=1.0)])
    mesh = merge(scene)
    assert mesh.lod is None
    assert mesh.casts is None
    assert not world_of(scene).geometry.has_lods


def test_lamp_of_a_coarse_level_lights_its_own_level_alone():
    """The fine lamp hangs at 1 m, the coarse one at 2 m."""
    sheets = [
        Sheet(BLACK, y=0.0),
        Sheet(BLACK, y=0.0, instance=level(0, 1)),
        Sheet(LAMP, y=1.0, up=False, instance=level(0, 0)),
        Sheet(LAMP, y=2.0, up=False, instance=level(0, 1)),
    ]
    world = world_of(stacked(sheets))
    for triangle, height in ((0, 1.0), (2, 2.0)):
        expected = form_factor(1.0, 1.0, height) * np.array(LAMP.emission)
        np.testing.assert_allclose(irradiance_over_pi(world, triangle), expected, rtol=1e-2)


@pytest.mark.parametrize("fine_blocks", [True, False])
def test_bounces_from_others_see_the_finest_level_again(fine_blocks):
    """A lamp shines up past the coarse level at a ceiling; for the ceiling, the fine one is in the way."""
    sheets = [
        Sheet(matte(0.9), y=10.0, width=40.0, depth=40.0, up=False),
        Sheet(BLACK, y=5.0, width=50.0, depth=50.0, instance=level(0, 0 if fine_blocks else 2)),
        Sheet(GREY, y=0.0, instance=level(0, 1)),
        Sheet(LAMP, y=-5.0, width=10.0, depth=10.0),
    ]
    assert irradiance_over_pi(world_of(stacked(sheets)), 4).any() != fine_blocks


def test_receive_only_objects_are_passed_by_rays():
    ghost = {"casts": False}
    world = world_of(stacked([Sheet(GREY), Sheet(GREY, y=1.0, instance=ghost)]))
    assert hit_below(world)[1] == pytest.approx(0.0, abs=1e-5)
    assert hit_below(world)[0] in (0, 1)


def test_triangles_keep_their_numbers_behind_a_receive_only_object():
    world = world_of(stacked([Sheet(GREY, y=1.0, instance={"casts": False}), Sheet(GREY)]))
    assert hit_below(world)[0] in (2, 3)


def test_receive_only_lamp_lights_nothing():
    world = world_of(stacked([Sheet(BLACK), Sheet(LAMP, y=1.0, up=False, instance={"casts": False})]))
    assert not irradiance_over_pi(world, 0).any()


@pytest.fixture
def in_pictures():
    """From the top: a coarse level, a receive-only lamp, a receive-only sheet, and the floor."""
    from irradia.transport.world import World

    ghost = {"casts": False}
    scene = stacked(
        [
            Sheet(GREY, y=3.0, instance=level(0, 1)),
            Sheet(LAMP, y=2.0, up=False, instance=ghost),
            Sheet(GREY, y=1.0, instance=ghost),
            Sheet(GREY, y=0.0),
        ],
        environment=environment_from_color((1.0, 1.0, 1.0)),
    )
    return World(scene, seen_by_camera(merge(scene)))


def test_pictures_show_receive_only_objects(in_pictures):
    assert hit_below(in_pictures, lod=CAMERA_LOD)[1] == pytest.approx(2.0, abs=1e-5)
    assert hit_below(in_pictures, y=1.5, lod=CAMERA_LOD)[1] == pytest.approx(1.0, abs=1e-5)
    assert hit_below(in_pictures)[1] == pytest.approx(0.0, abs=1e-5)


def test_pictures_show_what_is_lit_as_if_receive_only_objects_were_not_there(in_pictures):
    for triangle in (4, 6):
        np.testing.assert_allclose(irradiance_over_pi(in_pictures, triangle), 1.0, rtol=1e-5)


def test_receive_only_objects_are_lit_themselves():
    sky = environment_from_color((1.0, 2.0, 3.0))
    world = world_of(stacked([Sheet(GREY, instance={"casts": False})], environment=sky))
    np.testing.assert_allclose(irradiance_over_pi(world, 0), [1.0, 2.0, 3.0], rtol=1e-5)
