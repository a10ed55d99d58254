"""Leaf cards: a procedural texture with an alpha mask, and balls of cards that show it."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from irradia.core.rng import Seed
from irradia.scene.builtin.mesh import Array, Mesh, join
from irradia.scene.builtin.shapes import quad
from irradia.scene.types import U8

TEXTURE_PX = 256


def card_ball(
    rng: np.random.Generator, n_cards: int, centre: ArrayLike, radii: ArrayLike, card_m: float
) -> Mesh:
    """Cards scattered in an ellipsoid, leaning outward, each with uv from (0, 0) to its size."""
    cards = []
    for _ in range(n_cards):
        direction = rng.normal(size=3)
        direction /= np.linalg.norm(direction)
        middle = direction * np.asarray(radii) * rng.uniform(0.35, 1.0) + np.asarray(centre)
        up = direction + rng.normal(scale=0.5, size=3) + [0, 0.4, 0]
        up *= card_m / np.linalg.norm(up)
        side = np.cross(up, rng.normal(size=3))
        side *= card_m / np.linalg.norm(side)
        cards.append(quad(middle - side / 2 - up / 2, side, up))
    return join(*cards)


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
