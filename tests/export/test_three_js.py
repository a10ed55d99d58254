"""A baked scene in stock three.js, drawn in Chromium with the plugin that the documentation prints."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from irradia.core.colour import linear_from_srgb
from irradia.export.glb import write_baked_glb
from irradia.scene.builtin.builder import SceneBuilder
from irradia.scene.builtin.matte import matte
from irradia.scene.builtin.shapes import quad
from irradia.scene.gltf import document_to_scene
from irradia.scene.layout import LightmapLayout, Unwrap
from irradia.scene.types import Light, Material, Scene

SIZE_PX = 64
TEXTURE_SRGB = (200, 120, 60)
MAX_ERROR = 0.02


def four_tiles() -> Scene:
    """Square metres side by side along x, front up: grey, metallic-roughness default coat, textured, grey."""
    builder = SceneBuilder("tiles")
    grey = builder.material(matte("grey", (0.5, 0.4, 0.3)))
    coated = builder.material(Material("coated", base_color=(0.6, 0.6, 0.6, 1.0), metallic=0.0))
    pixels = np.full((4, 4, 3), TEXTURE_SRGB, np.uint8)
    texture = builder.texture("swatch", pixels)
    textured = builder.material(Material("textured", base_color_texture=texture, metallic=0.0, specular=0.0))
    for x, material in enumerate((grey, coated, textured, grey)):
        builder.object(f"tile {x}", (quad((x, 0, 1), (1, 0, 0), (0, 0, -1)), material))
    # Its light counts as baked: drawn again, it would double the brightness.
    builder.light(Light("point", (50.0, 50.0, 50.0), position=(2.0, 1.0, 0.5), name="lamp"))
    return document_to_scene(builder.build())


ALBEDO = np.array(
    [(0.5, 0.4, 0.3), (0.6,) * 3, linear_from_srgb(np.array(TEXTURE_SRGB) / 255), (0.5, 0.4, 0.3)]
)


def layout_of(scene: Scene) -> LightmapLayout:
    """A quarter page for each tile: tiles 0 and 1 on page 0, 2 and 3 on page 1; u along x, v along z."""
    unwraps = []
    for primitive in scene.primitives:
        uv = primitive.positions[:, [0, 2]] - np.floor(primitive.positions[:, [0, 2]].min(axis=0))
        source = np.arange(len(uv), dtype=np.uint32)
        chart = np.zeros(len(primitive.indices), np.uint32)
        unwraps.append(Unwrap(source, primitive.indices, uv.astype(np.float32), chart))
    return LightmapLayout(
        n_pages=2,
        width_px=2 * SIZE_PX,
        height_px=2 * SIZE_PX,
        unwraps=tuple(unwraps),
        page=np.array([0, 0, 1, 1], np.int32),
        scale=np.full((4, 2), 0.5, np.float32),
        offset=np.array([(0, 0), (0.5, 0.5), (0.5, 0), (0, 0.5)], np.float32),
        texels_per_metre=float(SIZE_PX),
    )


def irradiance_over_pi(x: np.ndarray, z: np.ndarray) -> np.ndarray:
    """The gradient that the made-up lightmap holds, by world position; up to 6, so that a scale is needed."""
    return np.stack([0.4 + 1.4 * x, 0.8 + 0.7 * z + 0 * x, 3.0 - 0.6 * x + 0.4 * z], axis=-1)


def pages_of(layout: LightmapLayout) -> np.ndarray:
    """Every tile's gradient carried on over the whole page around it, as dilation would."""
    pages = np.zeros((2, 2 * SIZE_PX, 2 * SIZE_PX, 3), np.float32)
    centre = (np.arange(2 * SIZE_PX) + 0.5) / (2 * SIZE_PX)
    for tile in range(4):
        u, v = np.meshgrid(centre, centre)
        uv = (np.stack([u, v], axis=-1) - layout.offset[tile]) / layout.scale[tile]
        near = np.all((uv > -0.2) & (uv < 1.2), axis=-1)
        pages[layout.page[tile]][near] = irradiance_over_pi(tile + uv[..., 0], uv[..., 1])[near]
    return np.maximum(pages, 0.0)


def looking_down(centre_x: float, half_height: float, width: int, height: int) -> dict[str, Any]:
    """An orthographic view of the tiles from above, x to the right and z down."""
    world_from_camera = np.array([[1, 0, 0, centre_x], [0, 0, 1, 3], [0, -1, 0, 0.5], [0, 0, 0, 1]])
    return {
        "width": width,
        "height": height,
        "halfHeightM": half_height,
        "worldFromCamera": world_from_camera.T.ravel().tolist(),
    }


def test_three_js_shows_albedo_times_irradiance_over_pi(draw_in_three_js, tmp_path: Path) -> None:
    scene = four_tiles()
    layout = layout_of(scene)
    write_baked_glb(tmp_path / "tiles.glb", scene, layout, pages_of(layout))
    view = looking_down(centre_x=2.0, half_height=0.5, width=4 * 48, height=48)
    pixels = draw_in_three_js(tmp_path / "tiles.glb", view)
    x, z = np.meshgrid((np.arange(192) + 0.5) / 48, (np.arange(48) + 0.5) / 48)
    expected = ALBEDO[x.astype(int)] * irradiance_over_pi(x, z)
    inner = (x % 1 > 0.1) & (x % 1 < 0.9) & (z > 0.1) & (z < 0.9)
    for tile in range(4):
        here = inner & (x.astype(int) == tile)
        ratio = pixels[here].mean(axis=0) / expected[here].mean(axis=0)
        assert np.all(np.abs(ratio - 1.0) < MAX_ERROR), (
            f"tile {tile} is {ratio} times as bright as it should be"
        )
        assert np.percentile(np.abs(pixels[here] / expected[here] - 1.0), 95) < MAX_ERROR


@pytest.mark.parametrize("factor", [0.01, 100.0])
def test_brightness_of_the_light_does_not_matter(draw_in_three_js, tmp_path: Path, factor: float) -> None:
    scene = four_tiles()
    layout = layout_of(scene)
    write_baked_glb(tmp_path / "tiles.glb", scene, layout, pages_of(layout) * np.float32(factor))
    view = looking_down(centre_x=0.5, half_height=0.4, width=16, height=16)
    pixels = draw_in_three_js(tmp_path / "tiles.glb", view)
    expected = ALBEDO[0] * irradiance_over_pi(np.array(0.5), np.array(0.5))
    np.testing.assert_allclose(pixels.mean(axis=(0, 1)), factor * expected, rtol=MAX_ERROR)


def test_documented_plugin_is_the_one_that_draws(web_check, repo_root: Path) -> None:
    """And it has at most 15 lines."""
    readme = (repo_root / "docs" / "IRRADIA_lighting" / "README.md").read_text("utf-8")
    block = readme.partition("```js\n")[2].partition("```")[0]
    assert len(block.splitlines()) <= 15
    documented = block.partition("new GLTFLoader()")[0]
    compiled = (repo_root / "web" / "dist" / "checks" / "moz-lightmap.js").read_text("utf-8")
    drawn = compiled.partition("export ")[2]
    assert drawn.split() == documented.split()
