"""The shared models import whole."""

from __future__ import annotations

import numpy as np
import pytest

from irradia.scene.load import load_scene
from irradia.scene.merge import merge


@pytest.fixture(scope="module")
def helmet(shared_assets):
    return load_scene(str(shared_assets / "flight-helmet" / "FlightHelmet.gltf"))


@pytest.fixture(scope="module")
def camera(shared_assets):
    return load_scene(str(shared_assets / "antique-camera" / "AntiqueCamera.gltf"))


def test_helmet_has_all_its_triangles(helmet):
    assert helmet.n_triangles == 94_722
    assert helmet.notes == ()


def test_helmet_is_as_large_as_its_accessors_say(helmet):
    mesh = merge(helmet)
    accessors = helmet.document.json["accessors"]
    stated = [
        accessors[p["attributes"]["POSITION"]]
        for m in helmet.document.json["meshes"]
        for p in m["primitives"]
    ]
    np.testing.assert_allclose(
        mesh.positions.min(axis=0), np.min([a["min"] for a in stated], axis=0), atol=1e-5
    )
    np.testing.assert_allclose(
        mesh.positions.max(axis=0), np.max([a["max"] for a in stated], axis=0), atol=1e-5
    )


def test_helmet_materials_keep_their_textures(helmet):
    textured = [m for m in helmet.materials if m.base_color_texture is not None]
    assert len(textured) >= 4
    assert all(image.pixels.shape == (1024, 1024, 4) for image in helmet.images)


def test_antique_camera_has_all_triangles_but_those_without_area(camera):
    without_area = 19  # of them 8 exactly on a line, the rest within 1e-7 of their length
    assert camera.n_triangles == 20_066 - without_area
    assert camera.notes[-1].startswith(f"{without_area} triangles without area dropped")


@pytest.mark.parametrize("name", ["helmet", "camera"])
def test_normals_are_unit_and_fronts_face_along_them(request, name):
    mesh = merge(request.getfixturevalue(name))
    np.testing.assert_allclose(np.linalg.norm(mesh.normals, axis=1), 1.0, atol=1e-5)
    a, b, c = mesh.positions[mesh.indices].astype(float).transpose(1, 0, 2)
    agreeing = np.sum(np.cross(b - a, c - a) * mesh.normals[mesh.indices].sum(axis=1), axis=1) > 0
    assert agreeing.mean() > 0.999
