"""MSFT_lod: every level is read, where the finest one stands."""

from __future__ import annotations

import numpy as np
import pytest

from irradia.core.errors import InputError
from irradia.scene.gltf import document_to_scene


def lod(*levels: int) -> dict:
    return {"MSFT_lod": {"ids": list(levels)}}


def levels_of(gltf) -> dict[int, tuple[int | None, int]]:
    scene = document_to_scene(gltf.document())
    return {i.node_index: (i.lod_group, i.lod_level) for i in scene.instances}


@pytest.fixture
def tree(gltf):
    """Nodes 0, 1 and 2 are levels; node 3 is none; the scene lists 0 and 3."""
    gltf.use("MSFT_lod", required=True)
    gltf.triangle(name="fine", extensions=lod(1, 2))
    gltf.triangle(name="middle")
    gltf.triangle(name="coarse")
    gltf.triangle(name="rock")
    gltf.json["scenes"] = [{"nodes": [0, 3]}]
    return gltf


def test_levels_that_the_scene_does_not_list_are_read_too(tree):
    assert levels_of(tree) == {0: (0, 0), 1: (0, 1), 2: (0, 2), 3: (None, 0)}


def test_levels_listed_twice_are_read_once(tree):
    tree.json["scenes"][0]["nodes"] = [0, 1, 2, 3]
    assert levels_of(tree) == {0: (0, 0), 1: (0, 1), 2: (0, 2), 3: (None, 0)}


def test_objects_that_the_scene_does_not_show_have_no_levels_in_it(tree):
    tree.json["scenes"][0]["nodes"] = [3]
    assert levels_of(tree) == {3: (None, 0)}


@pytest.mark.parametrize("scenes", [True, False])
def test_lower_levels_stand_beside_the_finest_by_their_own_transform(gltf, scenes):
    fine = gltf.triangle(translation=[1, 0, 0], extensions=lod(1))
    coarse = gltf.triangle(translation=[0, 1, 0])
    parent = gltf.node(children=[fine], translation=[0, 0, 5])
    if scenes:
        gltf.json["scenes"] = [{"nodes": [parent]}]
    scene = document_to_scene(gltf.document())
    places = {i.node_index: i.world_from_object[:3, 3].tolist() for i in scene.instances}
    assert places == {fine: [1, 0, 5], coarse: [0, 1, 5]}


def test_level_that_is_a_child_already_stays_where_it_is(gltf):
    coarse = gltf.triangle(translation=[0, 1, 0])
    gltf.triangle(translation=[1, 0, 0], children=[coarse], extensions=lod(coarse))
    scene = document_to_scene(gltf.document())
    places = {i.lod_level: i.world_from_object[:3, 3].tolist() for i in scene.instances}
    assert places == {0: [1, 0, 0], 1: [1, 1, 0]}


def test_all_below_a_level_belongs_to_it(gltf):
    leaves = [gltf.triangle(), gltf.triangle()]
    gltf.node(children=[leaves[0]], extensions=lod(3))
    gltf.node(children=[leaves[1]])
    assert levels_of(gltf) == {leaves[0]: (0, 0), leaves[1]: (0, 1)}


def test_objects_inside_a_level_are_part_of_it_in_their_finest(gltf):
    chair = gltf.triangle(extensions=lod(1))
    gltf.triangle(name="coarse chair")
    gltf.node(name="house", children=[chair], extensions=lod(3))
    gltf.triangle(name="coarse house")
    gltf.json["scenes"] = [{"nodes": [2]}]
    levels = levels_of(gltf)
    assert set(levels) == {0, 3}
    assert levels[0][0] == levels[3][0]
    assert (levels[0][1], levels[3][1]) == (0, 1)


def test_lights_and_cameras_come_from_the_finest_level_alone(tree):
    tree.json["extensions"] = {"KHR_lights_punctual": {"lights": [{"type": "point", "name": "bulb"}]}}
    tree.json["cameras"] = [{"type": "perspective", "perspective": {"yfov": 1.0, "znear": 0.1}}]
    for node in tree.json["nodes"][:3]:
        node.setdefault("extensions", {})["KHR_lights_punctual"] = {"light": 0}
        node["camera"] = 0
    scene = document_to_scene(tree.document())
    assert (len(scene.lights), len(scene.cameras)) == (1, 1)


def test_empty_list_of_levels_makes_no_object(gltf):
    gltf.triangle(extensions=lod())
    assert levels_of(gltf) == {0: (None, 0)}


def test_user_is_told_of_levels(tree):
    assert any("levels of detail" in note for note in document_to_scene(tree.document()).notes)


@pytest.mark.parametrize(
    ("levels", "where"),
    [
        ([9], r"/nodes/0/extensions/MSFT_lod/ids/0: expected an index below 4"),
        (["x"], r"/nodes/0/extensions/MSFT_lod/ids/0"),
        ([0], r"/nodes/0/extensions/MSFT_lod/ids/0: node 0 is a level"),
        ([1, 1], r"/nodes/0/extensions/MSFT_lod/ids/1: node 1 is a level"),
        (7, r"/nodes/0/extensions/MSFT_lod/ids: expected an array"),
    ],
)
def test_wrong_levels_are_input_errors(tree, levels, where):
    tree.json["nodes"][0]["extensions"]["MSFT_lod"]["ids"] = levels
    with pytest.raises(InputError, match=where):
        levels_of(tree)


def test_level_of_two_objects_is_an_input_error(tree):
    tree.json["nodes"][3]["extensions"] = lod(2)
    with pytest.raises(InputError, match="/nodes/3/extensions/MSFT_lod/ids/0: node 2"):
        levels_of(tree)


def test_level_that_is_its_finest_ones_ancestor_is_an_input_error(gltf):
    fine = gltf.triangle(extensions=lod(1))
    gltf.node(children=[fine])
    gltf.json["scenes"] = [{"nodes": [fine]}]
    with pytest.raises(InputError, match="own ancestor"):
        levels_of(gltf)


def test_places_are_finite_numbers(tree):
    scene = document_to_scene(tree.document())
    assert all(np.isfinite(i.world_from_object).all() for i in scene.instances)
