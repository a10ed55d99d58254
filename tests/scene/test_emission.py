"""Each triangle emits what its own part of the texture shows."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from irradia.core.colour import linear_from_srgb
from irradia.scene.emission import triangle_emission
from irradia.scene.merge import merge
from irradia.scene.types import Image, Instance, Material, Primitive, Scene, TextureRef


def screen(pixels, uv, texture=None, **fields) -> Scene:
    """Triangles (T, 3, 2) of texture coordinates, all emitting through one image."""
    uv = np.asarray(uv, np.float32).reshape(-1, 3, 2)
    n = 3 * len(uv)
    positions = np.random.default_rng(1).uniform(size=(n, 3)).astype(np.float32)
    primitive = Primitive(
        positions=positions,
        normals=np.tile(np.float32([0, 1, 0]), (n, 1)),
        texcoords=(uv.reshape(-1, 2),),
        colors=None,
        indices=np.arange(n, dtype=np.uint32).reshape(-1, 3),
        material=0,
        mesh_index=0,
        primitive_index=0,
        vertex_source=np.arange(n, dtype=np.uint32),
    )
    material = Material(emission=(2.0, 1.0, 0.5), emission_texture=texture or TextureRef(0))
    image = Image("screen", np.dstack([pixels] * 3 + [np.full_like(pixels, 255)]).astype(np.uint8))
    instance = Instance(0, np.eye(4), 0, **fields)
    return Scene("screen", (primitive,), (instance,), (material,), (image,))


def means(scene: Scene) -> np.ndarray:
    """(T,) of the red channel over its factor, in the order of the file's triangles."""
    return triangle_emission(scene, merge(scene))[:, 0] / 2.0


def halves(size=64) -> np.ndarray:
    """Black on the left, white on the right."""
    return np.where(np.arange(size) < size // 2, 0, 255)[None].repeat(size, 0)


LEFT = [[0.0, 0.0], [0.4, 0.0], [0.0, 1.0]]
RIGHT = [[0.6, 0.0], [1.0, 0.0], [1.0, 1.0]]


def test_dark_and_bright_parts_of_one_image_are_told_apart():
    np.testing.assert_allclose(means(screen(halves(), [LEFT, RIGHT])), [0.0, 1.0], atol=1e-6)


def test_mean_is_that_of_the_area_which_the_triangle_covers():
    rng = np.random.default_rng(4)
    pixels = rng.integers(0, 256, (64, 64))
    corners = np.array([[0.1, 0.1], [0.9, 0.2], [0.4, 0.95]])
    u = rng.random((400_000, 2))
    u[u.sum(axis=1) > 1] = 1 - u[u.sum(axis=1) > 1]
    places = corners[0] + u @ (corners[1:] - corners[0])
    shown = pixels[(places[:, 1] * 64).astype(int), (places[:, 0] * 64).astype(int)]
    expected = linear_from_srgb(shown / 255.0).mean()
    assert means(screen(pixels, [corners]))[0] == pytest.approx(expected, rel=0.02)


def test_small_bright_spot_of_a_large_image_is_not_missed():
    pixels = np.zeros((2048, 2048), int)
    pixels[700, 900] = 255
    whole = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]]
    assert means(screen(pixels, [whole]))[0] == pytest.approx(2 / 2048**2, rel=0.3)


@pytest.mark.parametrize(
    ("wrap", "expected"), [("repeat", [0.0, 1.0]), ("clamp", [1.0, 1.0]), ("mirror", [1.0, 0.0])]
)
def test_coordinates_outside_the_image_wrap_as_the_sampler_says(wrap, expected):
    uv = np.add([LEFT, RIGHT], (1.0, 0.0))
    found = means(screen(halves(), uv, TextureRef(0, wrap_s=wrap)))
    np.testing.assert_allclose(found, expected, atol=1e-6)


def test_texture_transform_moves_the_footprint():
    moved = TextureRef(0, uv_from_texcoord=((1.0, 0.0, 0.6), (0.0, 1.0, 0.0)))
    np.testing.assert_allclose(means(screen(halves(), [LEFT], moved)), [1.0], atol=1e-6)


def test_image_sides_may_be_odd():
    pixels = np.full((5, 3), 255)
    assert means(screen(pixels, [LEFT]))[0] == pytest.approx(1.0)


def test_what_rays_do_not_meet_emits_nothing():
    assert means(screen(halves(), [RIGHT], casts=False))[0] == 0.0


def test_material_without_a_texture_emits_its_factor():
    scene = screen(halves(), [LEFT])
    plain = replace(scene.materials[0], emission_texture=None)
    found = triangle_emission(replace(scene, materials=(plain,)), merge(scene))
    np.testing.assert_allclose(found, [[2.0, 1.0, 0.5]])
