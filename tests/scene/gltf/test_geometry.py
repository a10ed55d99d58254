"""Primitives become triangles with unit normals, whatever the topology."""

from __future__ import annotations

import numpy as np
import pytest

from irradia.core.errors import InputError
from irradia.scene.gltf import document_to_scene

SQUARE = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0]], np.float32)
UP = np.tile(np.array([0, 0, 1], np.float32), (4, 1))


def only_primitive(gltf):
    scene = document_to_scene(gltf.document())
    assert len(scene.primitives) == 1
    return scene.primitives[0]


def facing(primitive):
    a, b, c = primitive.positions[primitive.indices].transpose(1, 0, 2)
    normals = np.cross(b - a, c - a)
    return normals / np.linalg.norm(normals, axis=1, keepdims=True)


@pytest.mark.parametrize(
    ("mode", "indices", "expected"),
    [
        (4, [0, 1, 2, 1, 3, 2], 2),
        (4, None, 1),
        (4, [0, 1, 2, 1, 3], 1),
        (5, [0, 1, 2, 3], 2),
        (5, None, 2),
        (6, [0, 1, 3, 2], 2),
    ],
)
def test_topologies_unroll_to_triangles_that_face_one_way(gltf, mode, indices, expected):
    gltf.node(mesh=gltf.mesh({"POSITION": SQUARE, "NORMAL": UP}, indices, mode=mode))
    primitive = only_primitive(gltf)
    assert len(primitive.indices) == expected
    np.testing.assert_allclose(facing(primitive), UP[:expected], atol=1e-6)


@pytest.mark.parametrize("dtype", ["u1", "u2", "u4"])
def test_indices_of_every_width_are_read(gltf, dtype):
    mesh = gltf.mesh({"POSITION": SQUARE, "NORMAL": UP})
    gltf.json["meshes"][mesh]["primitives"][0]["indices"] = gltf.accessor([0, 1, 2, 1, 3, 2], dtype)
    gltf.node(mesh=mesh)
    assert only_primitive(gltf).indices.tolist() == [[0, 1, 2], [1, 3, 2]]


def test_index_past_the_vertices_is_an_input_error(gltf):
    gltf.node(mesh=gltf.mesh({"POSITION": SQUARE}, [0, 1, 4]))
    with pytest.raises(
        InputError, match=r"/meshes/0/primitives/0/indices: expected indices below 4, found 4"
    ):
        document_to_scene(gltf.document())


def test_attributes_of_different_lengths_are_an_input_error(gltf):
    gltf.node(mesh=gltf.mesh({"POSITION": SQUARE, "NORMAL": UP[:3]}))
    with pytest.raises(InputError, match=r"/accessors/1: expected 4 elements for NORMAL"):
        document_to_scene(gltf.document())


def test_primitive_without_positions_is_an_input_error(gltf):
    gltf.node(mesh=gltf.mesh({"NORMAL": UP}))
    with pytest.raises(InputError, match=r"/meshes/0/primitives/0/attributes"):
        document_to_scene(gltf.document())


def test_vertices_that_are_not_finite_name_the_accessor(gltf):
    broken = SQUARE.copy()
    broken[2, 1] = np.nan
    gltf.node(mesh=gltf.mesh({"NORMAL": UP, "POSITION": broken}))
    with pytest.raises(InputError, match=r"/accessors/1: element 2 is not finite"):
        document_to_scene(gltf.document())


def test_triangles_without_area_are_dropped_and_counted(gltf):
    line = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0.5, 0, 0], [1, 1e-8, 0]], np.float32)
    corners = [0, 1, 2, 0, 0, 1, 0, 3, 1, 0, 1, 4]  # good; one corner twice; on a line; too slender
    gltf.node(mesh=gltf.mesh({"POSITION": line}, corners))
    scene = document_to_scene(gltf.document())
    assert scene.n_triangles == 1
    assert scene.notes == ("3 triangles without area dropped, first at /meshes/0/primitives/0",)


@pytest.mark.parametrize("size", [1e-12, 1.0, 1e12])
def test_small_and_large_triangles_are_kept(gltf, size):
    gltf.node(mesh=gltf.mesh({"POSITION": SQUARE * np.float32(size)}, [0, 1, 2]))
    assert len(only_primitive(gltf).indices) == 1


def test_scene_of_nothing_but_degenerate_triangles_is_empty(gltf):
    gltf.node(mesh=gltf.mesh({"POSITION": SQUARE * 0}))
    with pytest.raises(InputError, match="no triangles to bake"):
        document_to_scene(gltf.document())


@pytest.mark.parametrize("nodes", [[], [{"name": "empty"}]])
def test_empty_scene_is_an_input_error(gltf, nodes):
    gltf.json["nodes"] = nodes
    with pytest.raises(InputError, match="no triangles to bake"):
        document_to_scene(gltf.document())


def test_points_and_lines_are_left_out_and_noted(gltf):
    gltf.triangle()
    gltf.node(mesh=gltf.mesh({"POSITION": SQUARE}, mode=0))
    gltf.node(mesh=gltf.mesh({"POSITION": SQUARE}, mode=3))
    scene = document_to_scene(gltf.document())
    assert scene.n_triangles == 1
    assert any("1 primitives of points" in note for note in scene.notes)
    assert any("1 primitives of line strips" in note for note in scene.notes)


def test_unknown_mode_is_an_input_error(gltf):
    gltf.node(mesh=gltf.mesh({"POSITION": SQUARE}, mode=7))
    with pytest.raises(InputError, match=r"/meshes/0/primitives/0/mode"):
        document_to_scene(gltf.document())


def test_missing_normals_become_flat_and_split_vertices_say_where_they_come_from(gltf):
    folded = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 1]], np.float32)
    texcoords = np.arange(8, dtype=np.float32).reshape(4, 2)
    gltf.node(mesh=gltf.mesh({"POSITION": folded, "TEXCOORD_0": texcoords}, [0, 1, 2, 1, 3, 2]))
    primitive = only_primitive(gltf)
    assert primitive.vertex_source.tolist() == [0, 1, 2, 1, 3, 2]
    np.testing.assert_array_equal(primitive.positions, folded[primitive.vertex_source])
    np.testing.assert_array_equal(primitive.texcoords[0], texcoords[primitive.vertex_source])
    np.testing.assert_allclose(primitive.normals, np.repeat(facing(primitive), 3, axis=0), atol=1e-6)


def test_given_normals_are_made_unit_without_splitting(gltf):
    gltf.node(mesh=gltf.mesh({"POSITION": SQUARE, "NORMAL": UP * 7}, [0, 1, 2, 1, 3, 2]))
    primitive = only_primitive(gltf)
    np.testing.assert_allclose(primitive.normals, UP)
    assert primitive.vertex_source.tolist() == [0, 1, 2, 3]


def test_normals_of_length_zero_are_taken_from_the_faces(gltf):
    normals = UP.copy()
    normals[1] = 0
    gltf.node(mesh=gltf.mesh({"POSITION": SQUARE, "NORMAL": normals}, [0, 1, 2, 1, 3, 2]))
    np.testing.assert_allclose(only_primitive(gltf).normals, UP, atol=1e-6)


def test_quantized_positions_and_normals_are_read_as_they_stand(gltf):
    gltf.use("KHR_mesh_quantization", required=True)
    positions = gltf.accessor([[0, 0, 0, 0], [100, 0, 0, 0], [0, 50, 0, 0]], "i2")
    gltf.json["accessors"][positions]["type"] = "VEC3"
    view = gltf.json["accessors"][positions]["bufferView"]
    gltf.json["bufferViews"][view]["byteStride"] = 8
    normals = gltf.accessor([[0, 0, 127]] * 3, "i1", normalized=True)
    texcoords = gltf.accessor([[0, 0], [65535, 0], [0, 65535]], "u2", normalized=True)
    attributes = {"POSITION": positions, "NORMAL": normals, "TEXCOORD_0": texcoords}
    gltf.node(mesh=gltf.mesh(attributes), scale=[0.01] * 3)
    primitive = only_primitive(gltf)
    np.testing.assert_array_equal(primitive.positions, [[0, 0, 0], [100, 0, 0], [0, 50, 0]])
    np.testing.assert_allclose(primitive.normals, UP[:3])
    np.testing.assert_allclose(primitive.texcoords[0], [[0, 0], [1, 0], [0, 1]])


@pytest.mark.parametrize("components", [3, 4])
def test_vertex_colours_have_four_channels(gltf, components):
    stored = np.array([[51, 102, 153, 204]] * 3)[:, :components]
    if components == 3:
        colors = gltf.accessor(stored / np.float32(255))
    else:
        colors = gltf.accessor(stored, "u1", normalized=True)
    gltf.node(mesh=gltf.mesh({"POSITION": SQUARE[:3], "COLOR_0": colors}))
    expected = [0.2, 0.4, 0.6, 0.8 if components == 4 else 1.0]
    np.testing.assert_allclose(only_primitive(gltf).colors, [expected] * 3, atol=1e-6)


def test_two_nodes_share_one_primitive(gltf):
    mesh = gltf.mesh()
    gltf.node(mesh=mesh)
    gltf.node(mesh=mesh, translation=[1, 0, 0])
    scene = document_to_scene(gltf.document())
    assert [i.primitive for i in scene.instances] == [0, 0]
    assert scene.n_triangles == 2


def test_every_primitive_of_a_mesh_is_placed(gltf):
    mesh = gltf.mesh()
    gltf.json["meshes"][mesh]["primitives"].append(gltf.primitive({"POSITION": SQUARE}, mode=5))
    gltf.node(mesh=mesh, name="both")
    scene = document_to_scene(gltf.document())
    assert [(p.mesh_index, p.primitive_index) for p in scene.primitives] == [(0, 0), (0, 1)]
    assert scene.n_triangles == 3
