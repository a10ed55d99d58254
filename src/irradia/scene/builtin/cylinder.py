"""A 12-sided cylinder with smooth normals under a sharp sun: shading must not show its facets."""

from __future__ import annotations

import math

from irradia.scene.builtin import shapes
from irradia.scene.builtin.builder import SceneBuilder
from irradia.scene.builtin.matte import matte
from irradia.scene.builtin.mesh import look_at
from irradia.scene.gltf.document import GltfDocument
from irradia.scene.types import Camera, Light

N_SIDES, RADIUS_M, HEIGHT_M = 12, 0.5, 2.0
SUN_LUX, SUN_ELEVATION_DEG = 3.0, 35.0


def build() -> GltfDocument:
    """The cylinder stands on its base above a dark ground; the sun shines along −x, downward."""
    scene = SceneBuilder("cylinder")
    scene.object("ground", (shapes.floor(8, 8), scene.material(matte("ground", (0.0, 0.0, 0.0)))))
    body = shapes.cylinder(RADIUS_M, HEIGHT_M, N_SIDES).moved(y=0.02)
    scene.object("cylinder", (body, scene.material(matte("white", (0.8, 0.8, 0.8)))))
    elevation = math.radians(SUN_ELEVATION_DEG)
    scene.light(
        Light(
            "directional",
            (SUN_LUX, SUN_LUX, SUN_LUX),
            direction=(-math.cos(elevation), -math.sin(elevation), 0.0),
            name="sun",
        )
    )
    scene.camera(Camera(look_at((1.5, 2.2, 4.5), (0, 0.9, 0)), yfov_rad=0.7, name="camera"))
    scene.environment_color((0.0, 0.0, 0.0))
    return scene.build()
