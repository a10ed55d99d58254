"""A file's tangents come along where they hold, and are left out where they can't."""

from __future__ import annotations

import numpy as np
import pytest

from irradia.scene.gltf import document_to_scene

SQUARE = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0]], np.float32)
NORMALS = np.tile(np.float32([0, 0, 1]), (4, 1))
TANGENTS = np.float32([[1, 0, 0, 1], [0, 1, 0, -1], [-1, 0, 0, 1], [0, -1, 0, -1]])
INDICES = [0, 1, 2, 1, 3, 2]


def only_primitive(gltf):
    return document_to_scene(gltf.document()).primitives[0]


def test_tangents_of_the_file_are_kept(gltf):
    gltf.node(mesh=gltf.mesh({"POSITION": SQUARE, "NORMAL": NORMALS, "TANGENT": TANGENTS}, INDICES))
    np.testing.assert_array_equal(only_primitive(gltf).tangents, TANGENTS)


@pytest.mark.parametrize(
    "attributes",
    [
        {"NORMAL": NORMALS},
        {"TANGENT": TANGENTS},
        {"NORMAL": NORMALS, "TANGENT": TANGENTS[:, :3].copy()},
        {"NORMAL": NORMALS, "TANGENT": TANGENTS * np.float32(np.nan)},
    ],
    ids=["none", "without normals", "of three components", "not finite"],
)
def test_tangents_that_do_not_count_are_left_out(gltf, attributes):
    gltf.node(mesh=gltf.mesh({"POSITION": SQUARE, **attributes}, INDICES))
    assert only_primitive(gltf).tangents is None


def test_a_morph_bends_tangents_away(gltf):
    attributes = {"POSITION": SQUARE, "NORMAL": NORMALS, "TANGENT": TANGENTS}
    mesh = gltf.mesh(attributes, INDICES, targets=[{"POSITION": gltf.accessor(0.5 * NORMALS)}])
    gltf.node(mesh=mesh, weights=[0.5])
    assert only_primitive(gltf).tangents is None
