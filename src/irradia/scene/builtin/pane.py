"""A dark room lit only through a tinted pane: E/π is the tint times the form factor of the pane.

Outside, the environment is 1 everywhere. Everything in the room is black, so no light comes back
and the answer stands on paper: the pane is a rectangle in the ceiling, parallel to the floor.
"""

from __future__ import annotations

from irradia.scene.builtin.builder import SceneBuilder
from irradia.scene.builtin.matte import matte
from irradia.scene.builtin.mesh import join, look_at
from irradia.scene.builtin.shapes import face, frame, quad
from irradia.scene.gltf.document import GltfDocument
from irradia.scene.types import Camera, Material

TINT = (0.9, 0.5, 0.2)
ROOM_M, HEIGHT_M = 4.0, 2.5
PANE_WIDTH_M, PANE_DEPTH_M = 1.5, 1.0


def build() -> GltfDocument:
    """The room stands on y = 0 around the origin; the pane fills a hole in the middle of its ceiling."""
    scene = SceneBuilder("pane")
    pane = quad((-PANE_WIDTH_M / 2, HEIGHT_M, PANE_DEPTH_M / 2), (PANE_WIDTH_M, 0, 0), (0, 0, -PANE_DEPTH_M))
    black = scene.material(matte("black", (0.0, 0.0, 0.0)))
    half = ROOM_M / 2
    low = [(-half, 0, half), (half, 0, half), (half, 0, -half), (-half, 0, -half)]
    high = [(x, HEIGHT_M, z) for x, _, z in low]
    walls = [face([low[k], low[k - 1], high[k - 1], high[k]]) for k in range(4)]
    # From below, counter-clockwise runs against the pane's own corners, which are seen from above.
    hole = [pane.positions[k] for k in (1, 3, 2, 0)]
    ceiling = frame(high[::-1], hole)
    scene.object("room", (join(face(low), *walls, ceiling), black))
    glass = Material(
        "glass",
        base_color=(*TINT, 1.0),
        metallic=0.0,
        roughness=0.0,
        specular=0.0,
        transmission=1.0,
        double_sided=True,
    )
    scene.object("pane", (pane, scene.material(glass)))
    scene.camera(Camera(look_at((0, 1.2, 1.8), (0, 0.8, 0)), yfov_rad=1.0, name="camera"))
    scene.environment_color((1.0, 1.0, 1.0))
    return scene.build()
