"""Reflectance of texels whose texture is denser than the map."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from irradia.core.colour import linear_from_srgb
from irradia.scene.layout import LightmapLayout, Unwrap
from irradia.scene.merge import merge
from irradia.scene.types import Image, Material, Scene, TextureRef

from .flat_scenes import Sheet, stacked

pytestmark = pytest.mark.usefixtures("cpu_device")

PAGE_PX = 4


def _painted(pixels: np.ndarray, **fields) -> Scene:
    """A unit sheet that shows the whole image."""
    paint = Material(
        "paint", metallic=0.0, specular=0.0, base_color_texture=TextureRef(0, nearest=True), **fields
    )
    return replace(stacked([Sheet(paint)]), images=(Image("image", pixels),))


def _on_a_page(scene: Scene):
    """The scene with its sheet over all of a 4 × 4 page."""
    from irradia.transport.world import World

    sheet = scene.primitives[0]
    unwrap = Unwrap(sheet.vertex_source, sheet.indices, sheet.texcoords[0], np.zeros(2, np.uint32))
    layout = LightmapLayout(
        n_pages=1,
        width_px=PAGE_PX,
        height_px=PAGE_PX,
        unwraps=(unwrap,),
        page=np.zeros(1, np.int32),
        scale=np.ones((1, 2), np.float32),
        offset=np.zeros((1, 2), np.float32),
        texels_per_metre=4.0,
    )
    return World(scene, merge(scene, layout), (PAGE_PX, PAGE_PX))


def _places(n: int = 200):
    from irradia.transport.backend import mi

    u = np.random.default_rng(8).random((2, n)).astype(np.float32)
    bary = np.where(u.sum(axis=0) > 1, 1 - u, u)
    return mi.UInt32(np.arange(n) % 2), mi.Point2f(*bary), mi.Bool(True)


def _filtered(world, parts: int = 1) -> np.ndarray:
    from irradia.transport.texel_appearance import TexelAppearance

    return np.array(TexelAppearance(world, parts).at(*_places()).reflectance)


def _checks(size: int) -> np.ndarray:
    """(size, size, 4) black and white squares of one pixel."""
    x, y = np.meshgrid(np.arange(size), np.arange(size))
    pixels = np.full((size, size, 4), 255, np.uint8)
    pixels[..., :3] = ((x + y) % 2 * 255)[..., None]
    return pixels


def test_dense_pattern_reflects_its_mean_everywhere():
    world = _on_a_page(_painted(_checks(64)))
    points = np.array(world.appearance(*_places()).reflectance)
    assert {round(float(v), 3) for v in points.ravel()} == {0.0, 0.98}
    np.testing.assert_allclose(_filtered(world), 0.5, atol=3e-3)


def test_each_lookup_stands_for_its_part_of_a_texel():
    """At 8 × 8 pixels a texel, a quarter of a texel is 4 × 4: pixels of the second level."""
    pixels = np.full((32, 32, 4), 255, np.uint8)
    pixels[..., :3] = np.arange(32, dtype=np.uint8)[:, None, None] // 4 * 30
    expected = linear_from_srgb(np.unique(pixels[..., 0]) / np.float32(255))
    found = _filtered(_on_a_page(_painted(pixels)), parts=4)
    assert np.abs(found.ravel()[:, None] - expected).min(axis=1).max() < 3e-3
    assert len(np.unique(np.round(found.ravel(), 3))) == 8


def test_coarse_texture_is_looked_up_as_it_is():
    pixels = np.random.default_rng(9).integers(0, 256, (3, 3, 4), np.uint8)
    world = _on_a_page(_painted(pixels))
    np.testing.assert_array_equal(_filtered(world), np.array(world.appearance(*_places()).reflectance))


def test_masks_are_looked_up_in_points():
    pixels = _checks(64)
    pixels[..., 3] = pixels[..., 0]
    world = _on_a_page(_painted(pixels, alpha_mode="mask"))
    np.testing.assert_array_equal(_filtered(world), np.array(world.appearance(*_places()).reflectance))


@pytest.mark.parametrize("shape", [(8, 8), (7, 5), (1, 6), (9, 1), (1, 1)])
@pytest.mark.parametrize("srgb", [True, False])
def test_every_level_has_the_images_mean(shape, srgb):
    from irradia.transport.textures import mip_chain

    pixels = np.random.default_rng(3).integers(0, 256, (*shape, 4), np.uint8)
    chain = mip_chain(pixels, srgb=srgb)
    assert chain[0] is pixels
    assert chain[-1].shape == (1, 1, 4)
    for level in chain:
        values = level / np.float32(255)
        light = linear_from_srgb(values[..., :3]) if srgb else values[..., :3]
        expected = pixels / np.float32(255)
        wanted = linear_from_srgb(expected[..., :3]) if srgb else expected[..., :3]
        np.testing.assert_allclose(light.mean(axis=(0, 1)), wanted.mean(axis=(0, 1)), atol=6e-3)
        np.testing.assert_allclose(values[..., 3].mean(), expected[..., 3].mean(), atol=4e-3)
