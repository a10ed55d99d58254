"""A torus, compressed by public tools, is still that torus.

Made from one 576-triangle torus (radii 1 and 0.4 m, u and v around it, colour = (u, v, 0)) with
gltf-transform 4.5.1 (``draco``, ``meshopt``) and gltfpack 1.2 (``-cc -kn -kv``, and ``-cz -kv`` with
float attributes, which write KHR_meshopt_compression and its newer streams).
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from irradia.core.errors import InputError
from irradia.scene.gltf import document_to_scene, read_document
from irradia.scene.gltf.document import GltfDocument
from irradia.scene.merge import merge

DATA = Path(__file__).parent / "data"
FILES = ["torus.draco.glb", "torus.meshopt.glb", "torus.gltfpack-cc.glb", "torus.gltfpack-cz.glb"]


@pytest.fixture(scope="module", params=FILES)
def torus(request):
    scene = document_to_scene(read_document(DATA / request.param))
    return scene, merge(scene)


def test_all_triangles_are_there(torus):
    scene, _ = torus
    assert scene.n_triangles == 576
    assert scene.notes == ()


def test_vertices_lie_on_the_torus(torus):
    _, mesh = torus
    x, y, z = mesh.positions.astype(float).T
    np.testing.assert_allclose(np.hypot(np.hypot(x, z) - 1.0, y), 0.4, atol=2e-3)


def test_normals_stand_on_the_torus(torus):
    _, mesh = torus
    p = mesh.positions.astype(float)
    centre = p * [1, 0, 1] / np.hypot(p[:, 0], p[:, 2])[:, None]
    expected = (p - centre) / 0.4
    assert (np.sum(mesh.normals * expected, axis=1) > 0.999).all()


def test_triangles_face_outwards(torus):
    _, mesh = torus
    a, b, c = mesh.positions[mesh.indices].astype(float).transpose(1, 0, 2)
    assert (np.sum(np.cross(b - a, c - a) * mesh.normals[mesh.indices[:, 0]], axis=1) > 0).all()


def test_colours_and_texcoords_go_round_with_the_position(torus):
    scene, mesh = torus
    (primitive,) = scene.primitives
    assert primitive.colors is not None
    x, _, z = mesh.positions.astype(float).T
    turn = np.arctan2(z, x) / (2 * np.pi) % 1.0
    texcoord = primitive.texcoords[0][:, 0]
    # gltfpack scales texcoords, and puts the scale into the textures, which the torus doesn't have.
    for u in (primitive.colors[:, 0], texcoord / texcoord.max()):
        difference = np.abs(turn - u)
        assert np.minimum(difference, 1 - difference).max() < 0.01


def damaged(name: str, where: slice) -> GltfDocument:
    document = read_document(DATA / name)
    data = bytearray(document.buffers[0])
    data[where] = bytes(len(data[where]))
    return GltfDocument(document.json, (bytes(data), *document.buffers[1:]), name="damaged")


@pytest.mark.parametrize("name", FILES)
def test_damaged_payload_is_an_input_error(name):
    with pytest.raises(InputError, match=r"damaged|/meshes/0"):
        document_to_scene(damaged(name, slice(0, 600)))


def test_draco_attribute_that_is_not_in_the_data_is_an_input_error():
    document = read_document(DATA / "torus.draco.glb")
    primitive = document.json["meshes"][0]["primitives"][0]
    primitive["extensions"]["KHR_draco_mesh_compression"]["attributes"]["NORMAL"] = 55
    with pytest.raises(InputError, match=r"no attribute 55 for NORMAL"):
        document_to_scene(document)
