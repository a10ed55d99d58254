"""A point light over a plane: E = I cos θ / d², with nothing else to receive or return light."""

from __future__ import annotations

from irradia.scene.builtin.builder import SceneBuilder
from irradia.scene.builtin.matte import matte
from irradia.scene.builtin.mesh import look_at
from irradia.scene.builtin.shapes import floor
from irradia.scene.gltf.document import GltfDocument
from irradia.scene.types import Camera, Light

INTENSITY_CD = (30.0, 20.0, 10.0)
HEIGHT_M = 1.5


def build() -> GltfDocument:
    """A plane of 4 × 4 m around the origin; the light hangs over its centre."""
    scene = SceneBuilder("plane-point")
    scene.object("plane", (floor(4, 4), scene.material(matte("white", (0.8, 0.8, 0.8)))))
    scene.light(Light("point", INTENSITY_CD, position=(0.0, HEIGHT_M, 0.0), name="lamp"))
    scene.camera(Camera(look_at((0, 3, 4), (0, 0, 0)), yfov_rad=0.9, name="camera"))
    scene.environment_color((0.0, 0.0, 0.0))
    return scene.build()
