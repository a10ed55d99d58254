"""Closed rooms are closed, and the Cornell box has its published measures."""

from __future__ import annotations

from collections import Counter
from types import SimpleNamespace

import numpy as np
import pytest

from irradia.scene.builtin.rooms import DOOR_HEIGHT_M, DOOR_Z_M, HEIGHT_M, LENGTH_M, WALL_M, WIDTH_M


def edge_counts(part) -> Counter:
    """How many triangles share each edge, vertices welded by position."""
    _, welded = np.unique(np.round(part.positions, 6), axis=0, return_inverse=True)
    triangles = welded.reshape(-1)[part.indices]
    return Counter(tuple(sorted(pair)) for k in range(3) for pair in triangles[:, [k, (k + 1) % 3]].tolist())


def signed_volume(part) -> float:
    a, b, c = (part.positions[part.indices[:, k]] for k in range(3))
    return float(np.einsum("tc,tc->", a, np.cross(b, c))) / 6


@pytest.mark.parametrize("name", ["furnace", "furnace-80", "closed"])
def test_room_is_closed_and_faces_inward(name, parts):
    room = next(p for p in parts(name) if p.node == "room")
    assert set(edge_counts(room).values()) == {2}
    assert signed_volume(room) == pytest.approx(-60.0, rel=1e-5)


@pytest.mark.parametrize(("name", "reflectance"), [("furnace", 0.5), ("furnace-80", 0.8)])
def test_furnace_is_purely_diffuse_and_emits_one(name, reflectance, document):
    (material,) = document(name).json["materials"]
    assert material["pbrMetallicRoughness"]["baseColorFactor"] == [reflectance] * 3 + [1.0]
    assert material["pbrMetallicRoughness"]["metallicFactor"] == 0.0
    assert material["extensions"]["KHR_materials_specular"]["specularFactor"] == 0.0
    assert material["emissiveFactor"] == [1.0, 1.0, 1.0]


def test_cornell_box_has_the_published_triangles_and_size(parts):
    assert sum(len(p.indices) for p in parts("cornell")) == 2 * (2 + 4 + 2 + 5 + 5 + 1)
    points = np.concatenate([p.positions for p in parts("cornell")])
    np.testing.assert_allclose(points.min(axis=0), (0, 0, 0), atol=1e-6)
    np.testing.assert_allclose(points.max(axis=0), (0.556, 0.5488, 0.5592), atol=1e-6)


@pytest.mark.parametrize("node", ["room", "green wall", "red wall", "lamp"])
def test_cornell_walls_face_the_middle_of_the_room(node, parts):
    for part in parts("cornell"):
        if part.node == node:
            toward_middle = np.array([0.278, 0.274, 0.28]) - part.positions
            assert np.einsum("vc,vc->v", part.normals, toward_middle).min() > 0


@pytest.mark.parametrize("node", ["short block", "tall block"])
def test_cornell_blocks_face_outward(node, parts):
    (block,) = (p for p in parts("cornell") if p.node == node)
    centre = block.positions.mean(axis=0)
    assert np.einsum("vc,vc->v", block.normals, block.positions - centre).min() > 0


def _shell(parts) -> list:
    return [part for part in parts("rooms") if part.node == "shell"]


def test_shell_of_the_two_rooms_is_closed_without_an_edge_of_three_faces(parts):
    assert set(edge_counts(_joined(_shell(parts))).values()) == {2}


def test_walls_between_and_around_the_two_rooms_are_solid(parts):
    """Volume outside less the hollow inside is that of the walls: 10 cm all round and between."""
    length, width, height = 2 * LENGTH_M + 3 * WALL_M, WIDTH_M + 2 * WALL_M, HEIGHT_M + 2 * WALL_M
    hollow = 2 * LENGTH_M * WIDTH_M * HEIGHT_M
    hollow += WALL_M * DOOR_HEIGHT_M * (DOOR_Z_M[1] - DOOR_Z_M[0])
    assert signed_volume(_joined(_shell(parts))) == pytest.approx(length * width * height - hollow, rel=1e-5)


@pytest.mark.parametrize("node", ["table", "bench", "shelf", "chest", "lamp"])
def test_furniture_of_the_two_rooms_is_solid_and_stands_inside(node, parts):
    whole = _joined([part for part in parts("rooms") if part.node == node])
    assert signed_volume(whole) > 0
    assert whole.positions[:, 1].min() > -1e-6
    assert whole.positions[:, 1].max() < HEIGHT_M
    assert np.abs(whole.positions[:, 2]).max() < WIDTH_M / 2


def _joined(several) -> SimpleNamespace:
    first = np.cumsum([0, *(len(part.positions) for part in several)])
    return SimpleNamespace(
        positions=np.concatenate([part.positions for part in several]),
        indices=np.concatenate([part.indices + f for part, f in zip(several, first, strict=False)]),
    )
