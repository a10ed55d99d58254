"""A closed room in which every surface reflects ρ and emits 1: E/π is 1 / (1 − ρ) everywhere."""

from __future__ import annotations

from irradia.scene.builtin.builder import SceneBuilder
from irradia.scene.builtin.matte import matte
from irradia.scene.builtin.mesh import look_at
from irradia.scene.builtin.shapes import centred_box
from irradia.scene.gltf.document import GltfDocument
from irradia.scene.types import Camera


def build(name: str, reflectance: float) -> GltfDocument:
    """A box of 4 × 3 × 5 m, fronts inward."""
    scene = SceneBuilder(name)
    wall = matte("wall", (reflectance, reflectance, reflectance), emission=(1.0, 1.0, 1.0))
    scene.object("room", (centred_box((4, 3, 5)).inside_out(), scene.material(wall)))
    scene.camera(Camera(look_at((0, 0, 2), (0, 0, 0)), yfov_rad=1.0, name="camera"))
    scene.environment_color((0.0, 0.0, 0.0))
    return scene.build()
