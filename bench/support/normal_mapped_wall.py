"""A wall whose relief exists only in its normal map, lit from the side by sun, lamp and bounce."""

from __future__ import annotations

import numpy as np

from irradia.cli.lighting import LightOptions, light_scene
from irradia.scene.builtin.builder import SceneBuilder
from irradia.scene.builtin.matte import matte
from irradia.scene.builtin.mesh import Array
from irradia.scene.builtin.noise import cloud
from irradia.scene.builtin.shapes import floor, quad
from irradia.scene.gltf import document_to_scene
from irradia.scene.types import U8, Light, Material, Scene

WIDTH_M, HEIGHT_M = 2.0, 1.5
_TILE_M = 0.75
_TEXTURE_PX = 512
_RELIEF_M = 0.012


def wall_scene() -> Scene:
    """The wall stands in the plane z = 0 and faces +Z; node "wall" shows it."""
    scene = SceneBuilder("normal-mapped-wall")
    relief = scene.texture("relief", normal_map(stones(_TEXTURE_PX), _TILE_M / _TEXTURE_PX))
    stone = Material("stone", (0.6, 0.58, 0.55, 1.0), metallic=0.0, specular=0.0, normal_texture=relief)
    wall = quad((-WIDTH_M / 2, 0, 0), (WIDTH_M, 0, 0), (0, HEIGHT_M, 0))
    scene.object("wall", (wall, scene.material(stone, tile_m=_TILE_M)))
    ground = floor(4, 3).moved(z=1.5)
    scene.object("ground", (ground, scene.material(matte("ground", (0.45, 0.4, 0.3)))), lightmap_scale=0.25)
    side = quad((WIDTH_M / 2 + 0.02, 0, 0), (0, 0, 1.6), (0, HEIGHT_M, 0))
    scene.object("side", (side, scene.material(matte("side", (0.7, 0.25, 0.15)))), lightmap_scale=0.25)
    lamp = quad((-1.5, 0.6, 0.15), (0, 0, 0.7), (0, 0.5, 0)).inside_out()
    warm = matte("lamp", (0.0, 0.0, 0.0), emission=(9.0, 6.5, 4.0), double_sided=True)
    scene.object("lamp", (lamp, scene.material(warm)), lightmap_scale=0.0)
    scene.light(Light("directional", (2.6, 2.5, 2.3), direction=(-0.75, -0.45, -0.48), name="sun"))
    scene.environment_color((0.18, 0.24, 0.34))
    return light_scene(document_to_scene(scene.build()), LightOptions())


def stones(size_px: int) -> Array:
    """(size, size) heights in metres: courses of rounded blocks with a rough face, periodic."""
    row, column = np.mgrid[0:size_px, 0:size_px] / size_px
    course = np.floor(row * 5)
    across = (column * 3 + 0.5 * (course % 2)) % 1.0
    to_joint = np.minimum(np.minimum(across, 1 - across) * 5 / 3, np.minimum(row * 5 % 1, 1 - row * 5 % 1))
    rounded = 1.0 - np.exp(-((to_joint / 0.12) ** 2))
    return _RELIEF_M * (rounded + 0.35 * cloud(size_px, "stones", slope=1.9, lowest=3.0))


def normal_map(height_m: Array, texel_m: float) -> U8:
    """(H, W, 3) as glTF stores normals: red along u, green up the image, blue out."""
    slope_u = (np.roll(height_m, -1, axis=1) - np.roll(height_m, 1, axis=1)) / (2.0 * texel_m)
    slope_down = (np.roll(height_m, -1, axis=0) - np.roll(height_m, 1, axis=0)) / (2.0 * texel_m)
    normal = np.stack([-slope_u, slope_down, np.ones_like(height_m)], axis=-1)
    normal /= np.linalg.norm(normal, axis=-1, keepdims=True)
    return np.round((0.5 * normal + 0.5) * 255.0).astype(np.uint8)
