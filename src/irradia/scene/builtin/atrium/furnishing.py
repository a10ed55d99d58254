"""What stands and hangs in the atrium: the basin, potted laurels, lanterns."""

from __future__ import annotations

import numpy as np

from irradia.core.rng import Seed
from irradia.scene.builtin import profiles
from irradia.scene.builtin.atrium import plan
from irradia.scene.builtin.atrium.materials import Materials
from irradia.scene.builtin.builder import SceneBuilder
from irradia.scene.builtin.cards import card_ball
from irradia.scene.builtin.mesh import Mesh, join
from irradia.scene.builtin.shapes import centred_box, circle, cylinder, disc
from irradia.scene.builtin.sweep import lathe, moulding

BASIN_X = -2.9
_POTS = (
    (-6.3, -3.55),
    (-6.3, 3.55),
    (0.5, -3.55),
    (0.5, 3.55),
    (3.7, -3.55),
    (3.7, 3.55),
    (6.9, -2.6),
    (6.9, 2.6),
)
_LANTERN_BAYS = (-9.6, -3.2, 3.2, 9.6)


def add_furnishing(scene: SceneBuilder, materials: Materials) -> None:
    """Basin on the court's axis, pots round it, lanterns under every second vault."""
    scene.node("basin", mesh=scene.mesh("basin", *_basin(materials)), translation=(BASIN_X, 0, 0))
    shapes = [scene.mesh(f"laurel {k}", *_laurel(k, materials)) for k in range(2)]
    for k, (x, z) in enumerate(_POTS):
        scene.node(f"laurel {k}", mesh=shapes[k % 2], translation=(x, 0, z), yaw_deg=67.0 * k)
    lantern = scene.mesh("lantern", *_lantern(materials))
    aisle_z = (plan.HALF_Z + plan.LOWER_WALL / 2 + plan.INNER_Z) / 2
    for k, x in enumerate(_LANTERN_BAYS):
        for z in (-aisle_z, aisle_z):
            scene.node(f"lantern {k} {'n' if z < 0 else 's'}", mesh=lantern, translation=(x, 2.75, z))


def _basin(materials: Materials) -> list[tuple[Mesh, int]]:
    """An octagonal basin on a step, water, and a stem with a bowl and a finial."""
    step = _octagonal([(0.0, 0.0), (0.0, 0.13), (-0.02, 0.15), (-0.42, 0.15)], 1.75)
    wall = profiles.chain(
        (0.06, 0.0),
        (0.06, 0.08),
        profiles.cyma(0.06, 0.0, 0.08, 0.06, 4),
        (0.0, 0.40),
        profiles.cyma(0.0, 0.08, 0.40, 0.08, 5),
        (0.09, 0.50),
        (0.09, 0.54),
        (0.075, 0.555),
        (-0.155, 0.555),
        (-0.17, 0.54),
        (-0.17, 0.30),
    )
    stem = profiles.chain(
        (0.26, 0.38),
        profiles.torus(0.22, 0.44, 0.08, 4),
        profiles.scotia(0.20, 0.10, 0.54, 0.22, 0.03, 5),
        (0.12, 0.80),
        profiles.cyma(0.12, 0.09, 0.82, 0.25, 6),
        (0.13, 1.09),
        profiles.ovolo(0.14, 0.62, 1.10, 0.20, 8),
        (0.64, 1.33),
        (0.60, 1.35),
        profiles.chain((0.57, 1.33), (0.42, 1.25), (0.20, 1.215), (0.07, 1.21)),
        (0.06, 1.42),
        profiles.torus(0.05, 1.44, 0.06, 4),
        profiles.cyma(0.06, 0.004, 1.50, 0.22, 6),
        (0.0, 1.74),
    )
    water = disc(1.40 - 0.14, 0.44, 8).turned(22.5)
    return [
        (join(step, _octagonal(wall, 1.40).moved(y=0.15)), materials.limestone),
        (lathe(stem, 20), materials.white_marble),
        (water.moved(y=0.02), materials.water),
    ]


def _octagonal(profile: list | np.ndarray, radius: float) -> Mesh:
    """A moulding round an octagon whose flat sides face the axes."""
    corners = circle(8)[:-1] * radius
    return moulding(profile, corners, closed=True).turned(22.5)


def _laurel(k: int, materials: Materials) -> list[tuple[Mesh, int]]:
    """A clipped laurel of leaf cards on a stem, in a terracotta pot."""
    pot = profiles.chain(
        (0.19, 0.0),
        (0.20, 0.03),
        profiles.cyma(0.20, 0.29, 0.03, 0.36, 4),
        profiles.torus(0.285, 0.40, 0.08, 3),
        (0.27, 0.48),
        (0.24, 0.46),
        (0.23, 0.38),
    )
    crown = card_ball(Seed(1).child(f"laurel-{k}").numpy(), 70, (0, 1.38, 0), (0.36, 0.40, 0.36), 0.36)
    return [
        (lathe(pot, 16), materials.terracotta),
        (disc(0.235, 0.42, 16), materials.soil),
        (cylinder(0.028, 0.85, 8, capped=False).moved(y=0.40), materials.bark),
        (crown, materials.leaves),
    ]


def _lantern(materials: Materials) -> list[tuple[Mesh, int]]:
    """A six-sided lantern whose foot is at y = 0, on a chain up to the vault's crown."""
    glass = cylinder(0.095, 0.30, 6).moved(y=0.06)
    foot = lathe(
        profiles.chain((0.0, -0.05), (0.04, -0.04), (0.05, 0.0), (0.125, 0.02), (0.125, 0.05), (0.0, 0.055)),
        6,
    )
    cap = lathe(
        profiles.chain((0.0, 0.365), (0.13, 0.37), (0.14, 0.39), (0.05, 0.50), (0.03, 0.56), (0.0, 0.57)), 6
    )
    bars = [centred_box((0.014, 0.33, 0.014), (0.11, 0.21, 0)).turned(30 + 60 * k) for k in range(6)]
    chain = cylinder(0.012, 1.30, 6, capped=False).moved(y=0.56)
    return [(join(foot, cap, chain, *bars), materials.bronze), (glass, materials.lantern)]
