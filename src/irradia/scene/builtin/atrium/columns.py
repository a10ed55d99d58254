"""Columns and piers: attic base, shaft with entasis, leafed capital, abacus."""

from __future__ import annotations

import numpy as np

from irradia.scene.builtin import profiles
from irradia.scene.builtin.atrium import plan
from irradia.scene.builtin.atrium.materials import Materials
from irradia.scene.builtin.builder import SceneBuilder
from irradia.scene.builtin.mesh import Array, Mesh, join
from irradia.scene.builtin.relief import leaf
from irradia.scene.builtin.shapes import bevelled_box, sphere
from irradia.scene.builtin.sweep import lathe, square_moulding


def add_columns(scene: SceneBuilder, materials: Materials) -> None:
    """Lower columns of marble, slender upper ones, and the four corner piers."""
    lower_height = plan.SPRING_Y - plan.ARCADE_Y
    lower = scene.mesh(
        "lower column",
        (shaft(0.235, 0.20, 0.36, 2.58, n_sides=20), materials.white_marble),
        (join(base(0.235, 0.36, 20), capital(0.20, 2.58, lower_height, 0.43, 16)), materials.limestone),
    )
    for k, (x, z, yaw) in enumerate(plan.column_spots(plan.BAY)):
        scene.node(f"lower column {k}", mesh=lower, translation=(x, plan.ARCADE_Y, z), yaw_deg=yaw)

    upper_height = plan.UPPER_SPRING_Y - plan.GALLERY_Y
    upper = scene.mesh(
        "upper column",
        (shaft(0.115, 0.10, 0.24, upper_height - 0.32, n_sides=10), materials.red_marble),
        (
            join(
                base(0.115, 0.24, 10, n=2), plain_capital(0.10, upper_height - 0.32, upper_height, 0.27, 10)
            ),
            materials.limestone,
        ),
    )
    for k, (x, z, yaw) in enumerate(plan.column_spots(plan.UPPER_BAY)):
        scene.node(f"upper column {k}", mesh=upper, translation=(x, plan.GALLERY_Y, z), yaw_deg=yaw)

    pier = scene.mesh("corner pier", (corner_pier(), materials.limestone))
    for k, (x, z) in enumerate(plan.corners(plan.HALF_X, plan.HALF_Z)):
        scene.node(f"corner pier {k}", mesh=pier, translation=(x, 0, z))


def base(radius: float, height: float, n_sides: int, n: int = 3) -> Mesh:
    """Plinth and attic base: torus, scotia, torus, between fillets."""
    plinth = 0.36 * height
    part = (height - plinth) / 10
    y = plinth
    wide = radius * 1.24
    profile = profiles.chain(
        profiles.torus(wide, y, 3.6 * part, n),
        (wide - 0.1 * radius, y + 3.6 * part),
        (wide - 0.1 * radius, y + 4.2 * part),
        profiles.scotia(wide - 0.12 * radius, radius * 1.08, y + 4.2 * part, 2.4 * part, 0.12 * radius, n),
        (radius * 1.12, y + 6.6 * part),
        (radius * 1.12, y + 7.0 * part),
        profiles.torus(radius * 1.08, y + 7.0 * part, 2.2 * part, n),
        (radius * 1.03, y + 9.2 * part),
        (radius * 1.03, y + 10 * part),
        (radius * 0.98, y + 10 * part),
    )
    half = wide + 1.9 * part
    return join(
        bevelled_box((-half, 0, -half), (half, plinth, half), 0.012),
        lathe(profile, n_sides),
    )


def shaft(bottom_radius: float, top_radius: float, low_y: float, high_y: float, n_sides: int) -> Mesh:
    """A tapering shaft: the lower third upright, then a slow curve inward; an astragal at its top."""
    t = np.linspace(0, 1, 6)
    radius = bottom_radius - (bottom_radius - top_radius) * np.clip((t - 0.25) / 0.75, 0, 1) ** 1.6
    curve = np.stack([radius, low_y + (high_y - 0.06 - low_y) * t], axis=1)
    ring = profiles.torus(top_radius + 0.004, high_y - 0.06, 0.045, 4)
    return lathe(profiles.chain(curve, ring, (top_radius, high_y - 0.015), (top_radius, high_y)), n_sides)


def capital(radius: float, low_y: float, high_y: float, half_abacus: float, n_sides: int) -> Mesh:
    """A bell with eight leaves below and four above, which reach for the corners' scrolls; an abacus."""
    abacus = 0.15
    bell_height = high_y - low_y - abacus
    top = high_y - abacus
    t = np.linspace(0, 1, 7)
    bell = np.stack([radius + (half_abacus * 0.80 - radius) * t**2.6, low_y + bell_height * t], axis=1)
    leaves = []
    for row, (share, n, turn) in enumerate([(0.62, 8, 22.5), (0.95, 4, 45.0)]):
        foot = radius + 0.012 + 0.008 * row
        spine = _leaf_spine(foot, low_y + 0.01, share * bell_height, 0.075 + 0.05 * row)
        blade = leaf(spine, 0.135 - 0.02 * row, 0.016)
        leaves += [blade.turned(turn + 360 / n * k) for k in range(n)]
    reach = half_abacus * 0.80
    scroll = sphere(0.055, 7, 5)
    scrolls = [scroll.moved(x * reach, top - 0.05, z * reach) for x in (-1, 1) for z in (-1, 1)]
    return join(lathe(bell, n_sides), *leaves, *scrolls, _abacus(half_abacus, top, high_y))


def plain_capital(radius: float, low_y: float, high_y: float, half_abacus: float, n_sides: int) -> Mesh:
    """A cushion capital: necking, a swelling bell, an abacus."""
    abacus = 0.10
    top = high_y - abacus
    bell = profiles.cyma(radius + 0.012, half_abacus * 0.86, low_y + 0.05, top - low_y - 0.05, 5)
    profile = profiles.chain(profiles.torus(radius, low_y, 0.035, 3), (radius + 0.012, low_y + 0.05), bell)
    return join(lathe(profile, n_sides), _abacus(half_abacus, top, high_y))


def corner_pier() -> Mesh:
    """A square pier over both storeys with plinth, impost bands and cap."""
    half = plan.PIER / 2
    steps = profiles.chain(
        (0.07, 0.0),
        (0.07, 0.34),
        profiles.scotia(0.06, 0.0, 0.36, 0.12, 0.01, 4),
        (0.0, plan.SPRING_Y - 0.20),
        profiles.cyma(0.0, 0.07, plan.SPRING_Y - 0.20, 0.12, 5),
        (0.07, plan.SPRING_Y),
        (0.0, plan.SPRING_Y),
        (0.0, plan.GALLERY_Y),
        (-0.11, plan.GALLERY_Y),
    )
    above = profiles.chain(
        (0.0, plan.GALLERY_Y),
        (0.03, plan.GALLERY_Y),
        (0.03, plan.GALLERY_Y + 0.20),
        (0.0, plan.GALLERY_Y + 0.23),
        (0.0, plan.UPPER_SPRING_Y - 0.14),
        profiles.cyma(0.0, 0.05, plan.UPPER_SPRING_Y - 0.14, 0.09, 5),
        (0.05, plan.UPPER_SPRING_Y),
        (0.0, plan.UPPER_SPRING_Y),
        (0.0, plan.CEILING_Y),
    )
    return join(square_moulding(steps, half), square_moulding(above, half - 0.10))


def _abacus(half: float, low_y: float, high_y: float) -> Mesh:
    middle = low_y + 0.45 * (high_y - low_y)
    inner = half - 0.035
    return join(
        bevelled_box((-inner, low_y, -inner), (inner, middle + 0.005, inner), 0.012),
        bevelled_box((-half, middle, -half), (half, high_y, half), 0.014),
    )


def _leaf_spine(foot: float, y: float, height: float, curl: float) -> Array:
    """(N, 2) of (outward, height): up along the bell, then out and over."""
    t = np.linspace(0, 1, 4)
    out = foot + curl * t**3 + 0.02 * np.sin(np.pi * t)
    up = y + height * (t - 0.22 * np.clip((t - 0.72) / 0.28, 0, 1) ** 2)
    return np.stack([out, up], axis=1)
