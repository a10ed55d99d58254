"""Animations, morphs and skins put vertices where glTF says."""

from __future__ import annotations

import numpy as np
import pytest

from irradia.core.errors import InputError
from irradia.scene.gltf import document_to_scene

TRIANGLE = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0]], np.float32)
QUARTER_ABOUT_Z = [0, 0, np.sqrt(0.5), np.sqrt(0.5)]
ZERO3 = [0, 0, 0]


def moved(x, y, z):
    return TRIANGLE + np.array([x, y, z], np.float32)


def animate(gltf, node, path, times, values, interpolation="LINEAR"):
    sampler = {
        "input": gltf.accessor(times),
        "output": gltf.accessor(values),
        "interpolation": interpolation,
    }
    channel = {"sampler": 0, "target": {"node": node, "path": path}}
    gltf.add("animations", {"samplers": [sampler], "channels": [channel]})


def world_at(gltf, time):
    return document_to_scene(gltf.document(), pose_time=time).instances[0].world_from_object


@pytest.mark.parametrize(
    ("interpolation", "time", "expected"),
    [
        ("LINEAR", 1.5, 3.0),
        ("LINEAR", 0.0, 2.0),
        ("LINEAR", 9.0, 8.0),
        ("LINEAR", 2.0, 4.0),
        ("LINEAR", 3.0, 6.0),
        ("STEP", 1.99, 2.0),
        ("STEP", 2.0, 4.0),
        ("STEP", 4.0, 8.0),
        ("STEP", 3.99, 4.0),
    ],
)
def test_translation_between_keys(gltf, interpolation, time, expected):
    node = gltf.triangle()
    animate(gltf, node, "translation", [1, 2, 4], [[2, 0, 0], [4, 0, 0], [8, 0, 0]], interpolation)
    assert world_at(gltf, time)[0, 3] == pytest.approx(expected)


def test_cubic_spline_follows_the_polynomial_that_its_tangents_describe(gltf):
    node = gltf.triangle()

    def value(t):
        return t**3 - 2 * t**2 + 1

    def slope(t):
        return 3 * t**2 - 4 * t

    keys = [[[slope(t), 0, 0], [value(t), 0, 0], [slope(t), 0, 0]] for t in (1.0, 3.0)]
    animate(gltf, node, "translation", [1, 3], np.reshape(keys, (-1, 3)), "CUBICSPLINE")
    for time in (1.0, 1.3, 2.0, 2.9, 3.0):
        assert world_at(gltf, time)[0, 3] == pytest.approx(value(time), abs=1e-5)


@pytest.mark.parametrize("sign", [1, -1])
def test_rotation_goes_the_short_way_at_constant_speed(gltf, sign):
    node = gltf.triangle()
    animate(gltf, node, "rotation", [0, 3], [[0, 0, 0, 1], np.multiply(sign, QUARTER_ABOUT_Z)])
    angle = np.radians(30)
    np.testing.assert_allclose(world_at(gltf, 1)[:2, 0], [np.cos(angle), np.sin(angle)], atol=1e-6)


def test_rotation_between_nearly_equal_keys_stays_a_rotation(gltf):
    node = gltf.triangle()
    animate(gltf, node, "rotation", [0, 1], [[0, 0, 0, 1], [0, 0, 1e-4, 1]])
    world = world_at(gltf, 0.5)
    np.testing.assert_allclose(world[:3, :3] @ world[:3, :3].T, np.eye(3), atol=1e-12)


def test_animation_leaves_what_it_does_not_move(gltf):
    node = gltf.triangle(translation=[1, 2, 3], scale=[2, 2, 2])
    animate(gltf, node, "scale", [0], [[4, 4, 4]])
    np.testing.assert_array_equal(world_at(gltf, 0), [[4, 0, 0, 1], [0, 4, 0, 2], [0, 0, 4, 3], [0, 0, 0, 1]])


def test_rest_pose_ignores_animations_and_says_so(gltf):
    node = gltf.triangle()
    animate(gltf, node, "translation", [0], [[9, 0, 0]])
    scene = document_to_scene(gltf.document())
    assert scene.instances[0].world_from_object[0, 3] == 0
    assert any("rest pose" in note for note in scene.notes)


def test_first_of_two_animations_of_one_property_wins(gltf):
    node = gltf.triangle()
    for x in (3, 5):
        animate(gltf, node, "translation", [0], [[x, 0, 0]])
    animate(gltf, node, "scale", [0], [[2, 2, 2]])
    world = world_at(gltf, 0)
    assert (world[0, 3], world[0, 0]) == (3, 2)


def test_keys_and_values_must_match(gltf):
    node = gltf.triangle()
    animate(gltf, node, "translation", [0, 1], [[0, 0, 0]] * 3)
    with pytest.raises(InputError, match="expected 2 values for 2 keys, found 3"):
        world_at(gltf, 0)


def test_key_times_must_grow(gltf):
    node = gltf.triangle()
    animate(gltf, node, "translation", [1, 1], [[0, 0, 0]] * 2)
    with pytest.raises(InputError, match=r"/animations/0/samplers/0/input"):
        world_at(gltf, 0)


# ---- Morph targets ---------------------------------------------------------------------------


def morphing(gltf, **node):
    primitive = gltf.primitive(
        {"POSITION": TRIANGLE, "NORMAL": [[0, 0, 1]] * 3, "TEXCOORD_0": TRIANGLE[:, :2]},
        targets=[
            {"POSITION": gltf.accessor([ZERO3, ZERO3, [0, 0, 1]]), "NORMAL": gltf.accessor([[0, 3, 3]] * 3)},
            {"POSITION": gltf.accessor([[0, 2, 0]] * 3), "TEXCOORD_0": gltf.accessor([[1, 0]] * 3)},
        ],
    )
    mesh = gltf.add("meshes", {"primitives": [primitive], "weights": [0, 0.5]})
    return gltf.node(mesh=mesh, **node)


def test_mesh_weights_are_the_default_pose(gltf):
    morphing(gltf)
    primitive = document_to_scene(gltf.document()).primitives[0]
    np.testing.assert_allclose(primitive.positions, moved(0, 1, 0))
    np.testing.assert_allclose(primitive.texcoords[0], TRIANGLE[:, :2] + [0.5, 0])


def test_node_weights_override_the_mesh(gltf):
    morphing(gltf, weights=[1, 0])
    primitive = document_to_scene(gltf.document()).primitives[0]
    np.testing.assert_allclose(primitive.positions[2], [0, 1, 1])
    np.testing.assert_allclose(primitive.normals, [[0, 0.6, 0.8]] * 3, atol=1e-6)


def test_animated_weights_override_both(gltf):
    node = morphing(gltf, weights=[1, 0])
    animate(gltf, node, "weights", [0, 2], [[0], [0], [0], [4]])
    scene = document_to_scene(gltf.document(), pose_time=1.0)
    np.testing.assert_allclose(scene.primitives[0].positions, moved(0, 4, 0))


def test_one_mesh_in_two_poses_is_two_primitives(gltf):
    first = morphing(gltf, weights=[1, 0])
    gltf.node(mesh=gltf.json["nodes"][first]["mesh"], weights=[0, 1])
    scene = document_to_scene(gltf.document())
    assert [i.primitive for i in scene.instances] == [0, 1]
    assert not np.allclose(scene.primitives[0].positions, scene.primitives[1].positions)


def test_flat_normals_belong_to_the_pose(gltf):
    tilt = gltf.accessor([ZERO3, ZERO3, [0, -1, 1]])
    mesh = gltf.mesh(targets=[{"POSITION": tilt}])
    gltf.node(mesh=mesh, weights=[1])
    normals = document_to_scene(gltf.document()).primitives[0].normals
    np.testing.assert_allclose(normals, [[0, -1, 0]] * 3, atol=1e-6)


def test_wrong_number_of_weights_is_an_input_error(gltf):
    morphing(gltf, weights=[1])
    with pytest.raises(InputError, match="expected 2 morph weights, found 1"):
        document_to_scene(gltf.document())


# ---- Skins -----------------------------------------------------------------------------------


def skinned(gltf, joints, weights, *, node=None, bind=None, normals=True, joint_nodes=None):
    """A triangle over two joints, the second a child of the first, 1 m above it."""
    upper = gltf.node(translation=[0, 1, 0])
    lower = gltf.node(children=[upper])
    skin = {"joints": joint_nodes or [lower, upper]}
    if bind is not None:
        skin["inverseBindMatrices"] = gltf.accessor([np.transpose(m).ravel() for m in bind])
    attributes = {
        "POSITION": TRIANGLE,
        "JOINTS_0": gltf.accessor(joints, "u1"),
        "WEIGHTS_0": gltf.accessor(weights),
    }
    if normals:
        attributes["NORMAL"] = [[0, 0, 1]] * 3
    mesh = gltf.mesh(attributes)
    gltf.node(mesh=mesh, skin=gltf.add("skins", skin), **(node or {}))
    return lower, upper


FIRST = [[0, 0, 0, 0]] * 3
SECOND = [[1, 0, 0, 0]] * 3
ALL = [[1, 0, 0, 0]] * 3


def test_skin_moves_vertices_into_the_world_and_ignores_its_own_node(gltf):
    skinned(gltf, SECOND, ALL, node={"translation": [100, 0, 0]})
    scene = document_to_scene(gltf.document())
    np.testing.assert_allclose(scene.primitives[0].positions, moved(0, 1, 0))
    np.testing.assert_array_equal(scene.instances[0].world_from_object, np.eye(4))


def test_inverse_bind_matrices_undo_the_rest_pose(gltf):
    undo = np.eye(4)
    undo[1, 3] = -1
    skinned(gltf, SECOND, ALL, bind=[np.eye(4), undo])
    np.testing.assert_allclose(document_to_scene(gltf.document()).primitives[0].positions, TRIANGLE)


def test_animated_joint_turns_its_vertices_and_normals(gltf):
    lower, _ = skinned(gltf, FIRST, ALL)
    animate(gltf, lower, "rotation", [0], [[np.sqrt(0.5), 0, 0, np.sqrt(0.5)]])
    primitive = document_to_scene(gltf.document(), pose_time=0.0).primitives[0]
    np.testing.assert_allclose(primitive.positions, [[0, 0, 0], [1, 0, 0], [0, 0, 1]], atol=1e-6)
    np.testing.assert_allclose(primitive.normals, [[0, -1, 0]] * 3, atol=1e-6)


def test_weights_blend_joints_and_need_not_sum_to_one(gltf):
    skinned(gltf, [[0, 1, 0, 0]] * 3, [[1, 3, 0, 0]] * 3)
    positions = document_to_scene(gltf.document()).primitives[0].positions
    np.testing.assert_allclose(positions, moved(0, 0.75, 0))


def test_vertices_without_weight_follow_the_first_joint(gltf):
    skinned(gltf, SECOND, [[0, 0, 0, 0]] * 3)
    np.testing.assert_allclose(document_to_scene(gltf.document()).primitives[0].positions, TRIANGLE)


def test_second_set_of_joints_counts_too(gltf):
    skinned(gltf, FIRST, ALL)
    attributes = gltf.json["meshes"][0]["primitives"][0]["attributes"]
    attributes["JOINTS_1"] = gltf.accessor(SECOND, "u2")
    attributes["WEIGHTS_1"] = gltf.accessor(ALL)
    positions = document_to_scene(gltf.document()).primitives[0].positions
    np.testing.assert_allclose(positions, moved(0, 0.5, 0))


def test_mirroring_joints_keep_fronts_in_front(gltf):
    lower, _ = skinned(gltf, FIRST, ALL)
    gltf.json["nodes"][lower]["scale"] = [-1, 1, 1]
    primitive = document_to_scene(gltf.document()).primitives[0]
    a, b, c = primitive.positions[primitive.indices[0]]
    np.testing.assert_allclose(np.cross(b - a, c - a), [0, 0, 1], atol=1e-6)
    np.testing.assert_allclose(primitive.normals, [[0, 0, 1]] * 3, atol=1e-6)


def test_split_vertices_of_a_skin_know_their_source(gltf):
    skinned(gltf, FIRST, ALL, normals=False)
    assert document_to_scene(gltf.document()).primitives[0].vertex_source.tolist() == [0, 1, 2]


@pytest.mark.parametrize(
    ("joints", "joint_nodes", "message"),
    [
        ([[2, 0, 0, 0]] * 3, None, "expected joints below 2, found 2"),
        (FIRST, [0, 77], r"/skins/0/joints/1"),
    ],
)
def test_joints_that_do_not_exist_are_input_errors(gltf, joints, joint_nodes, message):
    skinned(gltf, joints, ALL, joint_nodes=joint_nodes)
    with pytest.raises(InputError, match=message):
        document_to_scene(gltf.document())


def test_skin_without_weights_is_an_input_error(gltf):
    skinned(gltf, FIRST, ALL)
    del gltf.json["meshes"][0]["primitives"][0]["attributes"]["WEIGHTS_0"]
    with pytest.raises(InputError, match="no JOINTS_0 and WEIGHTS_0"):
        document_to_scene(gltf.document())


def test_too_few_inverse_bind_matrices_are_an_input_error(gltf):
    skinned(gltf, FIRST, ALL, bind=[np.eye(4)])
    with pytest.raises(InputError, match="expected 2 matrices, found 1"):
        document_to_scene(gltf.document())
