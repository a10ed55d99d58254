"""Normal textures bend normals as glTF says."""

from __future__ import annotations

import numpy as np
import pytest

from irradia.scene.builtin.shapes import quad
from irradia.scene.merge import merge
from irradia.scene.tangents import world_tangents
from irradia.scene.types import Image, Instance, Material, Primitive, Scene, TextureRef

pytestmark = pytest.mark.usefixtures("cpu_device")


def scene_of(pixel, *, scale=1.0, uv_sign=(1, 1)) -> Scene:
    """A wall that faces +Z, u along +X, with one colour for a normal map; and a plain one."""
    mesh = quad((0, 0, 0), (1, 0, 0), (0, 1, 0))
    primitives = [
        Primitive(
            (mesh.positions + np.array([0, 0, k])).astype(np.float32),
            mesh.normals.astype(np.float32),
            ((mesh.uv * uv_sign).astype(np.float32),),
            None,
            mesh.indices.astype(np.uint32),
            k,
            0,
            k,
            np.arange(4, dtype=np.uint32),
        )
        for k in (0, 1)
    ]
    materials = (Material(normal_texture=TextureRef(0), normal_scale=scale), Material())
    image = Image("normal", np.broadcast_to(np.array([*pixel, 255], np.uint8), (2, 2, 4)).copy())
    instances = tuple(Instance(k, np.eye(4), k) for k in (0, 1))
    return Scene("walls", tuple(primitives), instances, materials, (image,))


def mapped_normal(scene, triangle=0):
    from irradia.transport.backend import mi
    from irradia.transport.frames import TangentFrames
    from irradia.transport.normal_maps import NormalMaps
    from irradia.transport.world import World

    mesh = merge(scene)
    world = World(scene, mesh)
    maps = NormalMaps(scene, TangentFrames(world_tangents(scene, mesh)))
    where = mi.UInt32(triangle), mi.Point2f(0.3, 0.4), mi.Bool(True)
    point = maps.apply(world, world.point(*where), *where)
    return np.array(point.ns).ravel()


@pytest.mark.parametrize(
    ("pixel", "expected"),
    [
        ((255, 128, 128), (1, 0, 0)),
        ((128, 255, 128), (0, 1, 0)),
        ((128, 128, 255), (0, 0, 1)),
        ((0, 128, 128), (-1, 0, 0)),
    ],
)
def test_red_points_along_u_green_up_the_image_blue_out(pixel, expected):
    np.testing.assert_allclose(mapped_normal(scene_of(pixel)), expected, atol=0.01)


@pytest.mark.parametrize(("pixel", "expected"), [((255, 128, 128), (-1, 0, 0)), ((128, 255, 128), (0, 1, 0))])
def test_mirrored_texture_mirrors_red_and_leaves_green_up(pixel, expected):
    normal = mapped_normal(scene_of(pixel, uv_sign=(-1, 1)))
    np.testing.assert_allclose(normal, expected, atol=0.01)


def test_scale_bends_less():
    pixel = np.round((np.array([0.6, 0.0, 0.8]) * 0.5 + 0.5) * 255).astype(int)
    bent = np.array([0.25 * 0.6, 0.0, 0.8])
    np.testing.assert_allclose(
        mapped_normal(scene_of(pixel, scale=0.25)), bent / np.linalg.norm(bent), atol=0.01
    )


def test_surface_without_a_normal_texture_keeps_its_normal():
    assert mapped_normal(scene_of((255, 128, 128)), triangle=2).tolist() == [0, 0, 1]
