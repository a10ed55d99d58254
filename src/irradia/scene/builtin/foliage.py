"""Bushes of alpha-masked leaf cards over a plane: light must pass where the mask is empty."""

from __future__ import annotations

from irradia.core.rng import Seed
from irradia.scene.builtin.builder import SceneBuilder
from irradia.scene.builtin.cards import card_ball, leaf_texture
from irradia.scene.builtin.matte import matte
from irradia.scene.builtin.mesh import look_at
from irradia.scene.builtin.shapes import cylinder, floor
from irradia.scene.gltf.document import GltfDocument
from irradia.scene.types import Camera, Material

CARD_M, CARDS_PER_BUSH, N_BUSH_SHAPES = 0.7, 48, 3


def build() -> GltfDocument:
    """Nine bushes (three shapes) on trunks, double-sided cards, each showing the texture once."""
    scene = SceneBuilder("foliage")
    leaves = scene.material(
        Material(
            "leaves",
            base_color_texture=scene.texture("leaves", leaf_texture()),
            metallic=0.0,
            specular=0.0,
            alpha_mode="mask",
            double_sided=True,
        ),
        tile_m=CARD_M,
    )
    bark = scene.material(matte("bark", (0.25, 0.17, 0.11)))
    trunk = cylinder(0.06, 1.2, 10)
    shapes = []
    for k in range(N_BUSH_SHAPES):
        rng = Seed(1).child(f"bush-{k}").numpy()
        crown = card_ball(rng, CARDS_PER_BUSH, (0, 1.45, 0), (0.75, 0.55, 0.75), CARD_M)
        shapes.append(scene.mesh(f"bush {k}", (crown, leaves), (trunk, bark)))
    scene.object("ground", (floor(9, 9, n_x=3, n_z=3), scene.material(matte("ground", (0.45, 0.40, 0.33)))))
    for k in range(9):
        x, z = 2.4 * (k % 3 - 1), 2.4 * (k // 3 - 1)
        scene.node(f"bush {k}", mesh=shapes[k % N_BUSH_SHAPES], translation=(x, 0, z), yaw_deg=40.0 * k)
    scene.camera(Camera(look_at((4.5, 2.8, 6.5), (0, 0.8, 0)), yfov_rad=0.75, name="camera"))
    scene.sky(sun_elevation_deg=55, sun_azimuth_deg=60, turbidity=3, sun=True)
    return scene.build()
