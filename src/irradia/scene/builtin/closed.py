"""A closed room without a light under a bright sky: exactly black inside."""

from __future__ import annotations

from irradia.scene.builtin.builder import SceneBuilder
from irradia.scene.builtin.matte import matte
from irradia.scene.builtin.mesh import look_at
from irradia.scene.builtin.shapes import centred_box
from irradia.scene.gltf.document import GltfDocument
from irradia.scene.types import Camera


def build() -> GltfDocument:
    """A white box, fronts inward, with a smaller one floating in it; the environment outside is 1."""
    scene = SceneBuilder("closed")
    white = scene.material(matte("white", (0.8, 0.8, 0.8)))
    scene.object("room", (centred_box((4, 3, 5)).inside_out(), white))
    scene.object("block", (centred_box((1, 1, 1)).turned(30), white))
    scene.camera(Camera(look_at((0, 0.5, 2.3), (0, 0, 0)), yfov_rad=1.0, name="camera"))
    scene.environment_color((1.0, 1.0, 1.0))
    return scene.build()
