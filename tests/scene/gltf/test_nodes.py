"""Nodes stand where matrices, TRS and their parents put them."""

from __future__ import annotations

import numpy as np
import pytest

from irradia.core.errors import InputError
from irradia.scene.gltf import document_to_scene
from irradia.scene.merge import merge

QUARTER_ABOUT_Z = [0, 0, np.sqrt(0.5), np.sqrt(0.5)]


def places(gltf):
    scene = document_to_scene(gltf.document())
    return {i.node_index: i.world_from_object for i in scene.instances}


def test_scale_then_rotation_then_translation(gltf):
    gltf.triangle(translation=[10, 0, 0], rotation=QUARTER_ABOUT_Z, scale=[2, 3, 4])
    world = places(gltf)[0]
    np.testing.assert_allclose(world @ [1, 0, 0, 1], [10, 2, 0, 1], atol=1e-12)
    np.testing.assert_allclose(world @ [0, 1, 0, 1], [7, 0, 0, 1], atol=1e-12)
    np.testing.assert_allclose(world @ [0, 0, 1, 1], [10, 0, 4, 1], atol=1e-12)


def test_matrices_are_stored_column_by_column(gltf):
    gltf.triangle(matrix=[1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 5, 6, 7, 1])
    np.testing.assert_array_equal(places(gltf)[0][:3, 3], [5, 6, 7])


def test_parents_apply_after_their_children(gltf):
    child = gltf.triangle(translation=[1, 0, 0])
    gltf.node(children=[child], rotation=QUARTER_ABOUT_Z)
    np.testing.assert_allclose(places(gltf)[child][:3, 3], [0, 1, 0], atol=1e-12)


def test_negative_scale_keeps_fronts_in_front(gltf):
    normals = [[0, 0, 1]] * 3
    gltf.node(
        mesh=gltf.mesh({"POSITION": [[0, 0, 0], [1, 0, 0], [0, 1, 0]], "NORMAL": normals}), scale=[-1, 1, 1]
    )
    mesh = merge(document_to_scene(gltf.document()))
    a, b, c = mesh.positions[mesh.indices[0]]
    np.testing.assert_allclose(np.cross(b - a, c - a), [0, 0, 1], atol=1e-6)
    np.testing.assert_allclose(mesh.normals, normals, atol=1e-6)


def test_scale_of_zero_hides_a_node(gltf):
    gltf.triangle()
    gltf.triangle(scale=[0, 0, 0])
    scene = document_to_scene(gltf.document())
    assert [i.node_index for i in scene.instances] == [0]
    assert scene.notes == ("1 instances scaled to a line or point left out, first at /nodes/1",)


def test_one_flat_axis_is_no_reason_to_hide(gltf):
    gltf.triangle(scale=[1, 1, 0])
    assert list(places(gltf)) == [0]


def test_only_the_default_scene_is_taken(gltf):
    gltf.triangle(name="a")
    gltf.triangle(name="b")
    gltf.json["scenes"] = [{"nodes": [0]}, {"nodes": [1]}]
    gltf.json["scene"] = 1
    assert list(places(gltf)) == [1]


def test_first_scene_is_taken_where_none_is_the_default(gltf):
    gltf.triangle()
    gltf.triangle()
    gltf.json["scenes"] = [{"nodes": [1]}]
    assert list(places(gltf)) == [1]


def test_without_scenes_all_roots_are_taken(gltf):
    gltf.triangle()
    gltf.triangle()
    assert list(places(gltf)) == [0, 1]


def test_very_deep_hierarchies_are_walked(gltf):
    node = gltf.triangle()
    for _ in range(5000):
        node = gltf.node(children=[node], translation=[1, 0, 0])
    assert places(gltf)[0][0, 3] == 5000


@pytest.mark.parametrize(
    ("children", "message"),
    [
        ({0: [1], 1: [0]}, "own ancestor"),
        ({0: [0]}, "own ancestor"),
        ({0: [2], 1: [2]}, "both node 0 and node 1"),
        ({0: [9]}, r"/nodes/0/children/0: expected an index below 3"),
        ({0: [-1]}, r"/nodes/0/children/0: expected an index below 3"),
        ({0: ["x"]}, r"/nodes/0/children/0"),
        ({0: 7}, r"/nodes/0/children: expected an array"),
    ],
)
def test_hierarchies_that_are_no_trees_are_input_errors(gltf, children, message):
    for index in range(3):
        gltf.triangle(**({"children": children[index]} if index in children else {}))
    with pytest.raises(InputError, match=message):
        places(gltf)


@pytest.mark.parametrize(
    ("key", "value"),
    [
        ("rotation", [0, 0, 1]),
        ("translation", [0, "x", 0]),
        ("scale", 2),
        ("matrix", [0] * 16),
        ("mesh", 5),
    ],
)
def test_malformed_nodes_name_the_key(gltf, key, value):
    gltf.triangle()
    gltf.json["nodes"][0][key] = value
    with pytest.raises(InputError, match=f"/nodes/0/{key}"):
        places(gltf)


def test_transform_beyond_all_numbers_is_an_input_error(gltf):
    child = gltf.triangle(scale=[1e200] * 3)
    gltf.node(children=[child], scale=[1e200] * 3)
    with (
        np.errstate(over="ignore", invalid="ignore"),
        pytest.raises(InputError, match=r"/nodes/0: .*not finite"),
    ):
        places(gltf)


@pytest.mark.parametrize(
    ("extras", "expected"), [({"irradia": {"lightmapScale": 2.5}}, 2.5), ({}, 1.0), ("x", 1.0)]
)
def test_lightmap_scale_comes_from_extras(gltf, extras, expected):
    gltf.triangle(extras=extras)
    assert document_to_scene(gltf.document()).instances[0].lightmap_scale == expected


def test_negative_lightmap_scale_is_an_input_error(gltf):
    gltf.triangle(extras={"irradia": {"lightmapScale": -1}})
    with pytest.raises(InputError, match="/nodes/0/extras/irradia/lightmapScale"):
        document_to_scene(gltf.document())


def test_gpu_instances_are_placed_below_their_node(gltf):
    gltf.use("EXT_mesh_gpu_instancing", required=True)
    attributes = {
        "TRANSLATION": gltf.accessor([[1, 0, 0], [2, 0, 0]]),
        "ROTATION": gltf.accessor([[0, 0, 0, 32767], [0, 0, 23170, 23170]], "i2", normalized=True),
        "SCALE": gltf.accessor([[1, 1, 1], [2, 2, 2]]),
    }
    gltf.triangle(translation=[0, 5, 0], extensions={"EXT_mesh_gpu_instancing": {"attributes": attributes}})
    instances = document_to_scene(gltf.document()).instances
    assert [i.gpu_instance for i in instances] == [0, 1]
    np.testing.assert_allclose(instances[0].world_from_object[:3, 3], [1, 5, 0])
    np.testing.assert_allclose(instances[1].world_from_object @ [1, 0, 0, 1], [2, 7, 0, 1], atol=1e-4)


def test_gpu_instance_attributes_of_different_lengths_are_an_input_error(gltf):
    attributes = {"TRANSLATION": gltf.accessor([[1, 0, 0]]), "SCALE": gltf.accessor([[1, 1, 1]] * 2)}
    gltf.triangle(extensions={"EXT_mesh_gpu_instancing": {"attributes": attributes}})
    with pytest.raises(InputError, match="/nodes/0/extensions/EXT_mesh_gpu_instancing/attributes"):
        document_to_scene(gltf.document())
