"""A hall with 1,000 small lights: 500 points and 500 spots of KHR_lights_punctual, nothing else."""

from __future__ import annotations

import math

import numpy as np

from irradia.core.rng import Seed
from irradia.scene.builtin.builder import SceneBuilder
from irradia.scene.builtin.matte import matte
from irradia.scene.builtin.mesh import look_at
from irradia.scene.builtin.shapes import box, cylinder
from irradia.scene.gltf.document import GltfDocument
from irradia.scene.types import Camera, Light

ROWS, COLUMNS = 25, 40
HALL_M = (40.0, 6.0, 25.0)

_COLOURS = ((1.0, 0.72, 0.42), (1.0, 0.35, 0.22), (0.35, 0.62, 1.0), (0.45, 1.0, 0.55), (0.9, 0.4, 1.0))


def build() -> GltfDocument:
    """Lights one metre apart under the ceiling, jittered; every second one is a spot looking down."""
    scene = SceneBuilder("lights")
    width, height, depth = HALL_M
    plaster = scene.material(matte("plaster", (0.7, 0.69, 0.66)))
    room = box((-width / 2, 0, -depth / 2), (width / 2, height, depth / 2)).inside_out()
    scene.object("hall", (room, plaster))
    column = scene.mesh("column", (cylinder(0.3, height, 16, capped=False), plaster))
    for k in range(7 * 4):
        x, z = 5.0 * (k % 7 - 3), 5.0 * (k // 7 - 1.5)
        scene.node(f"column {k}", mesh=column, translation=(x, 0, z))
    rng = Seed(1).child("lights").numpy()
    for k in range(ROWS * COLUMNS):
        scene.light(_lamp(k, rng))
    scene.camera(Camera(look_at((-18, 2.0, 11), (4, 1.5, -4)), yfov_rad=0.9, name="camera"))
    scene.environment_color((0.0, 0.0, 0.0))
    return scene.build()


def _lamp(k: int, rng: np.random.Generator) -> Light:
    jitter = rng.uniform(-0.3, 0.3, 3)
    row, column = divmod(k, COLUMNS)
    position = np.array([column - COLUMNS / 2 + 0.5, HALL_M[1] - 0.8, row - ROWS / 2 + 0.5]) + jitter
    red, green, blue = _COLOURS[rng.integers(len(_COLOURS))]
    candela = float(rng.uniform(0.1, 0.5))
    return Light(
        "spot" if k % 2 else "point",
        (red * candela, green * candela, blue * candela),
        position=(float(position[0]), float(position[1]), float(position[2])),
        direction=(0.0, -1.0, 0.0),
        inner_cone_rad=math.radians(20),
        outer_cone_rad=math.radians(40),
        name=f"lamp {k}",
    )
