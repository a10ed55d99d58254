"""The arcades' walls over the columns, the great arch, and the courses of moulding that tie them."""

from __future__ import annotations

import math

import numpy as np

from irradia.scene.builtin import profiles
from irradia.scene.builtin.arch import arch_panel, jambs, soffit
from irradia.scene.builtin.atrium import plan
from irradia.scene.builtin.atrium.materials import Materials
from irradia.scene.builtin.atrium.ornament import Z_FROM_Y
from irradia.scene.builtin.builder import SceneBuilder
from irradia.scene.builtin.mesh import Array, Mesh, join
from irradia.scene.builtin.shapes import bevelled_box, box, disc
from irradia.scene.builtin.sweep import lathe, moulding, square_moulding, sweep_arc

_HALF_WALL = plan.LOWER_WALL / 2
_SMALL_ARCHIVOLT = [(0.0, 0.0), (0.024, 0.0), (0.024, 0.055), (0.045, 0.085), (0.045, 0.12), (0.0, 0.12)]
"""The gallery's bands round its arches: as :func:`archivolt`, with fewer members."""


def add_arcades(scene: SceneBuilder, materials: Materials) -> None:
    """Both storeys on three sides, the great arch on the fourth, string course and cornice."""
    lower = scene.mesh("lower arch", *lower_bay(materials))
    for k, (x, z, yaw) in enumerate(plan.arcade_spots(plan.BAY)):
        scene.node(f"lower arch {k}", mesh=lower, translation=(x, 0, z), yaw_deg=yaw)
    upper = scene.mesh("upper arch", *upper_bay(materials))
    for k, (x, z, yaw) in enumerate(plan.arcade_spots(plan.UPPER_BAY)):
        scene.node(f"upper arch {k}", mesh=upper, translation=(x, 0, z), yaw_deg=yaw)
    medallion = scene.mesh("medallion", *spandrel_medallion(materials))
    for k, (x, z, yaw) in enumerate(plan.column_spots(plan.BAY)):
        x, z = x + _HALF_WALL * math.sin(math.radians(yaw)), z + _HALF_WALL * math.cos(math.radians(yaw))
        scene.node(f"medallion {k}", mesh=medallion, translation=(x, 4.36, z), yaw_deg=yaw)
    for k, z in enumerate((-3.62, 3.62)):
        place = (plan.HALF_X - plan.EAST_WALL / 2, 7.35, z)
        scene.node(f"great medallion {k}", mesh=medallion, translation=place, yaw_deg=-90, scale=1.7)
    east = scene.mesh("great arch", *great_arch(materials))
    scene.node("great arch", mesh=east, translation=(plan.HALF_X, 0, 0), yaw_deg=-90)
    scene.object("string course", (string_course(), materials.limestone))
    scene.object("cornice", (cornice(), materials.limestone))
    scene.object("dentils", (dentils(), materials.limestone))


def lower_bay(materials: Materials) -> list[tuple[Mesh, int]]:
    """A bay of the ground floor: wall of ashlar, moulded archivolt, keystone; front +Z."""
    half = plan.LOWER_WALL / 2
    radius, spring = plan.ARCH_RADIUS, plan.SPRING_Y
    panel = arch_panel(plan.BAY / 2, spring, plan.STRING_Y + 0.05, radius, spring, 20)
    stone = join(
        sweep_arc(archivolt(0.20, 0.07), radius, 20).moved(0, spring, half),
        keystone(radius, 0.30, half).moved(y=spring),
        soffit(radius, spring, plan.LOWER_WALL, 20).moved(z=half),
    )
    return [
        (panel.moved(z=half), materials.ashlar),
        (panel.turned(180).moved(z=-half), materials.plaster),
        (stone, materials.limestone),
    ]


def upper_bay(materials: Materials) -> list[tuple[Mesh, int]]:
    """Half a bay of the gallery: a small arch in plaster with a stone archivolt; front +Z."""
    half = plan.UPPER_WALL / 2
    radius, spring = plan.UPPER_RADIUS, plan.UPPER_SPRING_Y
    panel = arch_panel(plan.UPPER_BAY / 2, spring, plan.CEILING_Y, radius, spring, 14)
    stone = join(
        sweep_arc(_SMALL_ARCHIVOLT, radius, 14).moved(0, spring, half),
        keystone(radius, 0.19, half).moved(y=spring),
        soffit(radius, spring, plan.UPPER_WALL, 14).moved(z=half),
    )
    return [
        (panel.moved(z=half), materials.plaster),
        (panel.turned(180).moved(z=-half), materials.plaster),
        (stone, materials.limestone),
    ]


def great_arch(materials: Materials) -> list[tuple[Mesh, int]]:
    """The arch over both storeys that opens the court to the stair hall; front +Z."""
    half = plan.EAST_WALL / 2
    radius, spring = plan.GREAT_RADIUS, plan.GREAT_SPRING_Y
    panel = arch_panel(plan.HALF_Z, 0.0, plan.CEILING_Y, radius, spring, 48)
    bands = [
        square_moulding(_impost(), 0.26, half + 0.05).moved(side * (radius + 0.21), 0, 0) for side in (-1, 1)
    ]
    stone = join(
        sweep_arc(archivolt(0.44, 0.12), radius, 48).moved(0, spring, half),
        sweep_arc(archivolt(0.44, 0.12), radius, 48).moved(0, spring, half).turned(180),
        keystone(radius, 0.62, half, width=0.34).moved(y=spring),
        soffit(radius, spring, plan.EAST_WALL, 48).moved(z=half),
        jambs(radius, 0.0, spring, plan.EAST_WALL).moved(z=half),
        *bands,
    )
    return [
        (panel.moved(z=half), materials.ashlar),
        (panel.turned(180).moved(z=-half), materials.plaster),
        (stone, materials.limestone),
    ]


def archivolt(width: float, depth: float) -> Array:
    """Profile of the band round an arch, from the soffit's edge outward: (proud of the wall, radial)."""
    w, d = width, depth
    return profiles.chain(
        (0.0, 0.0),
        (0.45 * d, 0.0),
        (0.45 * d, 0.34 * w),
        (0.62 * d, 0.36 * w),
        (0.62 * d, 0.66 * w),
        profiles.cyma(0.64 * d, d, 0.68 * w, 0.20 * w, 4),
        (d, 0.94 * w),
        (0.0, w),
    )


def keystone(radius: float, height: float, wall_half: float, width: float = 0.18) -> Mesh:
    """A wedge at the crown of an arch, proud of the wall and a little below the soffit."""
    block = bevelled_box(
        (-width / 2, radius - 0.05 * height, wall_half - 0.06),
        (width / 2, radius + height, wall_half + 0.10 + 0.12 * height),
        0.015,
    )
    taper = 0.75 + 0.35 * (block.positions[:, 1:2] - radius) / height
    return Mesh(
        np.concatenate([block.positions[:, :1] * taper, block.positions[:, 1:]], axis=1),
        block.normals,
        block.uv,
        block.indices,
    )


def spandrel_medallion(materials: Materials) -> list[tuple[Mesh, int]]:
    """A roundel of green marble in a moulded ring, on a wall at z = 0; front +Z."""
    ring = profiles.chain(
        (0.335, -0.02), (0.335, 0.02), profiles.ovolo(0.335, 0.335, 0.02, 0.001, 1), (0.32, 0.045),
        (0.285, 0.05), (0.25, 0.035), (0.235, 0.012),
    )  # fmt: skip
    return [
        (lathe(ring, 16).transformed(Z_FROM_Y), materials.limestone),
        (disc(0.24, 0.012, 16).transformed(Z_FROM_Y), materials.green_marble),
    ]


def string_course() -> Mesh:
    """The moulding between the storeys, from the great arch's wall round the court and back to it."""
    h = plan.GALLERY_Y - plan.STRING_Y
    profile = profiles.chain(
        (0.0, 0.0),
        (0.03, 0.0),
        (0.03, 0.28 * h),
        profiles.cyma(0.03, 0.11, 0.28 * h, 0.22 * h, 6),
        (0.13, 0.52 * h),
        (0.22, 0.54 * h),
        (0.22, 0.74 * h),
        profiles.cyma(0.23, 0.30, 0.76 * h, 0.18 * h, 6),
        (0.30, 0.965 * h),
        (0.0, h),
    )
    half_z = plan.HALF_Z - plan.LOWER_WALL / 2
    west, east = -plan.HALF_X + plan.LOWER_WALL / 2, plan.HALF_X - plan.EAST_WALL / 2
    path = [(east, half_z), (west, half_z), (west, -half_z), (east, -half_z)]
    return moulding(profile, [(x, plan.STRING_Y, z) for x, z in path])


def cornice() -> Mesh:
    """The crowning cornice round the whole court, up to the roof's edge."""
    h = plan.ROOF_Y - plan.CORNICE_Y
    profile = profiles.chain(
        (0.0, 0.0),
        (0.03, 0.0),
        (0.03, 0.14 * h),
        profiles.cyma(0.03, 0.10, 0.14 * h, 0.10 * h, 5),
        (0.11, 0.26 * h),
        (0.11, 0.46 * h),
        profiles.ovolo(0.12, 0.17, 0.46 * h, 0.06 * h, 4),
        (0.38, 0.54 * h),
        (0.38, 0.72 * h),
        profiles.cyma(0.40, 0.52, 0.74 * h, 0.20 * h, 8),
        (0.52, 0.97 * h),
        (0.0, h),
    )
    west, east, z, y = plan.CORNICE_WEST, plan.CORNICE_EAST, plan.CORNICE_Z, plan.CORNICE_Y
    return moulding(profile, [(west, y, -z), (east, y, -z), (east, y, z), (west, y, z)], closed=True)


def dentils() -> Mesh:
    """Small blocks under the cornice, hanging before its flat band."""
    h = plan.ROOF_Y - plan.CORNICE_Y
    low, high = plan.CORNICE_Y + 0.28 * h, plan.CORNICE_Y + 0.452 * h
    length_x, length_z = plan.CORNICE_EAST - plan.CORNICE_WEST, 2 * plan.CORNICE_Z
    middle_x = (plan.CORNICE_EAST + plan.CORNICE_WEST) / 2
    blocks = []
    for length, distance, yaw in ((length_x, length_z / 2, 0.0), (length_z, length_x / 2, 90.0)):
        n = round((length - 0.5) / 0.26)
        for k in range(n):
            x = (k - (n - 1) / 2) * 0.26
            block = _open_block(x, low, high, 0.105 - distance, 0.215 - distance)
            blocks += [block.turned(yaw), block.turned(yaw + 180)]
    return join(*blocks).moved(x=middle_x)


def _open_block(x: float, low: float, high: float, z0: float, z1: float) -> Mesh:
    """A dentil without its back, which sinks into the band."""
    block = box((x - 0.075, low, z0), (x + 0.075, high, z1))
    return block.only(block.positions[block.indices][..., 2].max(axis=1) > z0)


def _impost() -> Array:
    """Profile of the great arch's pilaster strips: plinth, shaft, impost moulding."""
    spring = plan.GREAT_SPRING_Y
    return profiles.chain(
        (0.08, 0.0),
        (0.08, 0.42),
        profiles.scotia(0.07, 0.0, 0.44, 0.12, 0.01, 4),
        (0.0, spring - 0.34),
        (0.03, spring - 0.34),
        (0.03, spring - 0.22),
        profiles.cyma(0.03, 0.12, spring - 0.22, 0.14, 6),
        (0.13, spring - 0.07),
        (0.13, spring),
        (0.0, spring),
    )
