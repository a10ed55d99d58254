"""Tangents follow the texture, wherever the mesh stands and however it is mapped."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from irradia.scene.builtin.shapes import quad, sphere
from irradia.scene.layout import LightmapLayout, Unwrap
from irradia.scene.merge import merge
from irradia.scene.tangents import bitangents, world_tangents
from irradia.scene.types import Instance, Material, Primitive, Scene, TextureRef

MIRROR = np.diag([-1.0, 1.0, 1.0, 1.0])
# u' = −v: it grows where the wall goes up.
TURNED = Material(normal_texture=TextureRef(0, uv_from_texcoord=((0.0, -1.0, 0.0), (1.0, 0.0, 0.0))))


def scene_of(mesh, *, uv=None, world=None, material=None, tangents=None) -> Scene:
    """One instance of one primitive."""
    primitive = Primitive(
        mesh.positions.astype(np.float32),
        mesh.normals.astype(np.float32),
        (np.asarray(mesh.uv if uv is None else uv, np.float32),),
        None,
        mesh.indices.astype(np.uint32),
        0,
        0,
        0,
        np.arange(len(mesh.positions), dtype=np.uint32),
        tangents=tangents,
    )
    world = np.eye(4) if world is None else world
    return Scene("one", (primitive,), (Instance(0, world, 0),), (material or Material(),), ())


def wall():
    """Faces +Z; u grows along +X, v falls along +Y."""
    return quad((0, 0, 0), (2, 0, 0), (0, 1, 0))


def frames(scene):
    """Tangents, bitangents and normals at corners."""
    mesh = merge(scene)
    tangents = world_tangents(scene, mesh)
    normals = mesh.normals[mesh.indices]
    return tangents, bitangents(normals, tangents), normals


def test_tangent_goes_with_u_and_bitangent_against_v():
    tangents, across, _ = frames(scene_of(wall()))
    np.testing.assert_allclose(tangents, np.broadcast_to([1, 0, 0, 1], (2, 3, 4)), atol=1e-6)
    np.testing.assert_allclose(across, np.broadcast_to([0, 1, 0], (2, 3, 3)), atol=1e-6)


def test_mirrored_texture_turns_tangent_and_sign():
    mesh = wall()
    tangents, across, _ = frames(scene_of(mesh, uv=mesh.uv * [-1, 1]))
    np.testing.assert_allclose(tangents, np.broadcast_to([-1, 0, 0, -1], (2, 3, 4)), atol=1e-6)
    np.testing.assert_allclose(across, np.broadcast_to([0, 1, 0], (2, 3, 3)), atol=1e-6)


def test_mirrored_instance_keeps_the_image_the_right_way_up():
    tangents, across, normals = frames(scene_of(wall(), world=MIRROR))
    np.testing.assert_allclose(tangents, np.broadcast_to([-1, 0, 0, -1], (2, 3, 4)), atol=1e-6)
    np.testing.assert_allclose(across, np.broadcast_to([0, 1, 0], (2, 3, 3)), atol=1e-6)
    np.testing.assert_allclose(normals, np.broadcast_to([0, 0, 1], (2, 3, 3)), atol=1e-6)


def test_transform_of_the_normal_texture_turns_its_tangents():
    tangents, _, _ = frames(scene_of(wall(), material=TURNED))
    np.testing.assert_allclose(tangents[..., :3], np.broadcast_to([0, 1, 0], (2, 3, 3)), atol=1e-6)


def test_on_a_sphere_bitangents_point_north_and_vertices_have_one_tangent():
    scene = scene_of(sphere(1.0, 24, 12))
    tangents, across, normals = frames(scene)
    np.testing.assert_allclose(np.linalg.norm(tangents[..., :3], axis=-1), 1.0, atol=1e-5)
    np.testing.assert_allclose((tangents[..., :3] * normals).sum(-1), 0.0, atol=1e-5)
    away_from_poles = np.abs(normals[..., 1]) < 0.9
    assert (across[away_from_poles][:, 1] > 0.4).all()
    vertices = merge(scene).indices[away_from_poles]
    of_vertex = np.zeros((vertices.max() + 1, 4))
    of_vertex[vertices] = tangents[away_from_poles]
    np.testing.assert_allclose(tangents[away_from_poles], of_vertex[vertices], atol=1e-6)


@pytest.mark.parametrize("uv", [0.0, 0.3])
def test_without_a_mapping_any_direction_across_the_normal_serves(uv):
    mesh = wall()
    tangents, _, normals = frames(scene_of(mesh, uv=np.full_like(mesh.uv, uv)))
    np.testing.assert_allclose(np.linalg.norm(tangents[..., :3], axis=-1), 1.0, atol=1e-6)
    np.testing.assert_allclose((tangents[..., :3] * normals).sum(-1), 0.0, atol=1e-6)


@pytest.mark.parametrize(("world", "sign"), [(np.eye(4), 1.0), (MIRROR, -1.0)])
def test_tangents_of_the_file_win(world, sign):
    given = np.tile(np.float32([0.6, 0.8, 0.0, 1.0]), (4, 1))
    tangents, across, _ = frames(scene_of(wall(), tangents=given, world=world))
    np.testing.assert_allclose(tangents, np.broadcast_to([0.6 * sign, 0.8, 0, sign], (2, 3, 4)), atol=1e-6)
    np.testing.assert_allclose(across, np.broadcast_to([-0.8 * sign, 0.6, 0], (2, 3, 3)), atol=1e-6)


def test_splits_of_the_unwrap_carry_the_files_tangents_along():
    given = np.float32([[1, 0, 0, 1], [0, 1, 0, 1], [-1, 0, 0, 1], [0, -1, 0, 1]])
    scene = scene_of(wall(), tangents=given)
    source = np.array([3, 0, 1, 2, 1, 2], np.uint32)
    unwrap = Unwrap(
        source,
        np.array([[1, 2, 3], [0, 5, 4]], np.uint32),
        np.zeros((6, 2), np.float32),
        np.zeros(2, np.uint32),
    )
    place = np.ones((1, 2), np.float32)
    layout = LightmapLayout(1, 8, 8, (unwrap,), np.zeros(1, np.int32), place, place, 1.0)
    mesh = merge(scene, layout)
    np.testing.assert_allclose(world_tangents(scene, mesh, layout), given[source][mesh.indices], atol=1e-6)


def test_a_tangent_of_length_zero_is_derived_instead():
    given = np.zeros((4, 4), np.float32)
    tangents, _, _ = frames(scene_of(wall(), tangents=given, material=TURNED))
    np.testing.assert_allclose(tangents[..., :3], np.broadcast_to([0, 1, 0], (2, 3, 3)), atol=1e-6)


def test_two_instances_have_tangents_of_their_own():
    scene = scene_of(wall())
    turned = np.array([[0, -1.0, 0, 0], [1, 0, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]])
    scene = replace(scene, instances=(*scene.instances, Instance(0, turned, 1)))
    tangents, _, _ = frames(scene)
    np.testing.assert_allclose(tangents[:2, :, :3], np.broadcast_to([1, 0, 0], (2, 3, 3)), atol=1e-6)
    np.testing.assert_allclose(tangents[2:, :, :3], np.broadcast_to([0, 1, 0], (2, 3, 3)), atol=1e-6)
