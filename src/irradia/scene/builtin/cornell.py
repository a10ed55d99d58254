"""The Cornell box, from the measurements that Cornell's Program of Computer Graphics published.

Geometry is theirs with millimetres read as metres / 1000, in their axes (x to the left seen from
the camera). Reflectances are their spectra of 400 to 700 nm integrated against the CIE 1931
observer under equal energy, taken to linear Rec.709 with the equal-energy white as white; the
lamp's colour likewise, with its spectrum's 0, 8, 15.6, 18.4 at 400, 500, 600, 700 nm.
"""

from __future__ import annotations

import math

import numpy as np

from irradia.scene.builtin.builder import SceneBuilder
from irradia.scene.builtin.matte import matte
from irradia.scene.builtin.mesh import Mesh, join, look_at
from irradia.scene.builtin.shapes import face, frame
from irradia.scene.gltf.document import GltfDocument
from irradia.scene.types import Camera, Material

WHITE = (0.738, 0.736, 0.737)
GREEN = (0.070, 0.388, 0.088)
RED = (0.524, 0.057, 0.049)
LAMP_RADIANCE = (18.45, 11.52, 3.16)

# Corners in millimetres, counter-clockwise seen from inside the room.
_FLOOR = [(552.8, 0, 0), (0, 0, 0), (0, 0, 559.2), (549.6, 0, 559.2)]
_CEILING = [(556, 548.8, 0), (556, 548.8, 559.2), (0, 548.8, 559.2), (0, 548.8, 0)]
_BACK_WALL = [(549.6, 0, 559.2), (0, 0, 559.2), (0, 548.8, 559.2), (556, 548.8, 559.2)]
_GREEN_WALL = [(0, 0, 559.2), (0, 0, 0), (0, 548.8, 0), (0, 548.8, 559.2)]
_RED_WALL = [(552.8, 0, 0), (549.6, 0, 559.2), (556, 548.8, 559.2), (556, 548.8, 0)]
_LAMP = [(343, 548.8, 227), (343, 548.8, 332), (213, 548.8, 332), (213, 548.8, 227)]
_SHORT_BLOCK = [(130, 65), (82, 225), (240, 272), (290, 114)]
_TALL_BLOCK = [(423, 247), (265, 296), (314, 456), (472, 406)]


def build() -> GltfDocument:
    """The box with both blocks, open toward the camera, without an environment."""
    scene = SceneBuilder("cornell")
    white = scene.material(matte("white", WHITE))
    # The lamp fills a hole in the ceiling: no coincident faces.
    ceiling = frame(np.array(_CEILING) / 1000, np.array(_LAMP) / 1000)
    room = join(_face(_FLOOR), _face(_BACK_WALL), ceiling)
    scene.object("room", (room, white))
    scene.object("green wall", (_face(_GREEN_WALL), scene.material(matte("green", GREEN))))
    scene.object("red wall", (_face(_RED_WALL), scene.material(matte("red", RED))))
    scene.object("short block", (_block(_SHORT_BLOCK, 165), white))
    scene.object("tall block", (_block(_TALL_BLOCK, 330), white))
    # Its back is dark and black, so only the emission of its front matters.
    lamp = Material(
        "lamp", base_color=(0.0, 0.0, 0.0, 1.0), metallic=0.0, specular=0.0, emission=LAMP_RADIANCE
    )
    scene.object("lamp", (_face(_LAMP), scene.material(lamp)))
    scene.camera(
        Camera(
            look_at((0.278, 0.273, -0.8), (0.278, 0.273, 0.0)),
            yfov_rad=2 * math.atan(0.025 / 2 / 0.035),
            aspect=1.0,
            name="camera",
        )
    )
    scene.environment_color((0.0, 0.0, 0.0))
    return scene.build()


def _face(corners_mm: list) -> Mesh:
    return face(np.array(corners_mm, np.float64) / 1000)


def _block(footprint_mm: list, height_mm: float) -> Mesh:
    """Top and four sides; it stands on the floor, where the original has no bottom."""
    low = [(x, 0, z) for x, z in footprint_mm]
    high = [(x, height_mm, z) for x, z in footprint_mm]
    sides = [[low[k], high[k], high[k - 1], low[k - 1]] for k in range(4)]
    return join(_face(high), *(_face(side) for side in sides))
