"""Bushes of alpha-masked leaf cards over a plane: light must pass where the mask is empty."""

from __future__ import annotations

import numpy as np

from irradia.core.rng import Seed
from irradia.scene.builtin.builder import SceneBuilder
from irradia.scene.builtin.matte import matte
from irradia.scene.builtin.mesh import Array, Mesh, join, look_at
from irradia.scene.builtin.shapes import cylinder, floor, quad
from irradia.scene.gltf.document import GltfDocument
from irradia.scene.types import U8, Camera, Material

CARD_M, CARDS_PER_BUSH, N_BUSH_SHAPES = 0.7, 48, 3
TEXTURE_PX = 256


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
    shapes = [
        scene.mesh(f"bush {k}", (_bush(Seed(1).child(f"bush-{k}").numpy()), leaves), (trunk, bark))
        for k in range(N_BUSH_SHAPES)
    ]
    scene.object("ground", (floor(9, 9, n_x=3, n_z=3), scene.material(matte("ground", (0.45, 0.40, 0.33)))))
    for k in range(9):
        x, z = 2.4 * (k % 3 - 1), 2.4 * (k // 3 - 1)
        scene.node(f"bush {k}", mesh=shapes[k % N_BUSH_SHAPES], translation=(x, 0, z), yaw_deg=40.0 * k)
    scene.camera(Camera(look_at((4.5, 2.8, 6.5), (0, 0.8, 0)), yfov_rad=0.75, name="camera"))
    scene.sky(sun_elevation_deg=55, sun_azimuth_deg=60, turbidity=3, sun=True)
    return scene.build()


def leaf_texture() -> U8:
    """(256, 256, 4) sRGB: about twenty pointed leaves on a sprig, alpha 255 inside and 0 outside."""
    rows, columns = np.mgrid[0:TEXTURE_PX, 0:TEXTURE_PX]
    x, y = (columns + 0.5) / TEXTURE_PX * 2 - 1, 1 - (rows + 0.5) / TEXTURE_PX * 2
    rng = Seed(1).child("leaf-texture").numpy()
    colour = np.broadcast_to(np.array([60.0, 95.0, 35.0]), (TEXTURE_PX, TEXTURE_PX, 3)).copy()
    alpha = np.abs(x + 0.06 * np.sin(4 * y)) < 0.018
    for k in range(20):
        side = 1 if k % 2 else -1
        root_y, length = -0.9 + 0.088 * k, 0.85 * (1 - 0.028 * k)
        angle = np.radians(rng.uniform(20, 50))
        along, across = _leaf_frame(
            x + 0.06 * np.sin(4 * root_y), y - root_y, side * np.cos(angle), np.sin(angle)
        )
        s = along / length
        inside = (
            (s > 0)
            & (s < 1)
            & (np.abs(across) < 0.34 * length * np.sqrt(np.clip(s, 0, 1)) * np.clip(1 - s, 0, 1) ** 0.8)
        )
        vein = (np.abs(across) < 0.008) | (np.abs(np.sin(28 * s + 60 * np.abs(across))) < 0.12)
        tone = np.array([86.0, 128.0, 44.0]) * rng.uniform(0.75, 1.15)
        colour[inside] = tone
        colour[inside & vein] = tone * 0.82
        alpha |= inside
    pixels = np.concatenate([colour, np.where(alpha, 255.0, 0.0)[..., None]], axis=-1)
    return np.clip(np.round(pixels), 0, 255).astype(np.uint8)


def _leaf_frame(x: Array, y: Array, cos: float, sin: float) -> tuple[Array, Array]:
    """Coordinates along and across a leaf that grows in direction (cos, sin)."""
    return x * cos + y * sin, y * cos - x * sin


def _bush(rng: np.random.Generator) -> Mesh:
    """Cards on a flattened ball, leaning outward, uv (0, 0) to (1, 1) of the texture on each."""
    cards = []
    for _ in range(CARDS_PER_BUSH):
        direction = rng.normal(size=3)
        direction /= np.linalg.norm(direction)
        centre = direction * [0.75, 0.55, 0.75] * rng.uniform(0.35, 1.0) + [0, 1.45, 0]
        up = direction + rng.normal(scale=0.5, size=3) + [0, 0.4, 0]
        up *= CARD_M / np.linalg.norm(up)
        side = np.cross(up, rng.normal(size=3))
        side *= CARD_M / np.linalg.norm(side)
        cards.append(quad(centre - side / 2 - up / 2, side, up))
    return join(*cards)
