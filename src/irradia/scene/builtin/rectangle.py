"""A rectangular lamp over a plane: E = π L F, with F the form factor of a parallel rectangle."""

from __future__ import annotations

from irradia.scene.builtin.builder import SceneBuilder
from irradia.scene.builtin.matte import matte
from irradia.scene.builtin.mesh import look_at
from irradia.scene.builtin.shapes import floor, quad
from irradia.scene.gltf.document import GltfDocument
from irradia.scene.types import Camera

RADIANCE = (5.0, 4.0, 3.0)
WIDTH_M, DEPTH_M, HEIGHT_M = 1.0, 0.6, 1.25


def build() -> GltfDocument:
    """A plane of 4 × 4 m; the lamp, WIDTH_M along x and DEPTH_M along z, is black but for its light."""
    scene = SceneBuilder("rectangle")
    scene.object("plane", (floor(4, 4), scene.material(matte("white", (0.8, 0.8, 0.8)))))
    lamp = quad((-WIDTH_M / 2, HEIGHT_M, -DEPTH_M / 2), (WIDTH_M, 0, 0), (0, 0, DEPTH_M))
    scene.object("lamp", (lamp, scene.material(matte("lamp", (0.0, 0.0, 0.0), emission=RADIANCE))))
    scene.camera(Camera(look_at((0, 3, 4), (0, 0, 0)), yfov_rad=0.9, name="camera"))
    scene.environment_color((0.0, 0.0, 0.0))
    return scene.build()
