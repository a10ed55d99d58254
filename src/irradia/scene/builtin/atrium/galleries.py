"""Floors, the gallery's balustrade and its timber ceiling."""

from __future__ import annotations

import numpy as np

from irradia.scene.builtin import profiles
from irradia.scene.builtin.atrium import plan
from irradia.scene.builtin.atrium.materials import Materials
from irradia.scene.builtin.builder import SceneBuilder
from irradia.scene.builtin.mesh import Array, Mesh, join
from irradia.scene.builtin.shapes import bevelled_box, box, quad
from irradia.scene.builtin.sweep import court_moulding, lathe, moulding

RAIL_M = 0.98
"""Height of the handrail's top over the floor."""
FLIGHT_TOP_Z = 5.91
"""Where the side flights of the stair arrive on the gallery."""
PAVING_M = 2.9


def add_galleries(scene: SceneBuilder, materials: Materials) -> None:
    """Court, arcade and gallery floors, the step between, balustrades, ceiling."""
    _add_floors(scene, materials)
    rail = scene.mesh("balustrade", (balustrade(plan.UPPER_BAY - 0.40, 4), materials.limestone))
    for k, (x, z, yaw) in enumerate(plan.arcade_spots(plan.UPPER_BAY)):
        scene.node(f"balustrade {k}", mesh=rail, translation=(x, plan.GALLERY_Y, z), yaw_deg=yaw)
    scene.object("ceiling boards", (_ceiling_boards(), materials.wood))
    scene.object("ceiling beams", (_beams(), materials.wood))


def _add_floors(scene: SceneBuilder, materials: Materials) -> None:
    half = 3.5 * PAVING_M
    # The paving's joints fall on the court's edges: seven and three stones, half of them each side.
    paving = _plane(-half, half, -plan.STEP_Z, plan.STEP_Z, 0.0).uv_moved(PAVING_M / 2, PAVING_M / 2)
    ends = [
        _plane(-plan.STEP_X, -half, -plan.STEP_Z, plan.STEP_Z, 0.0),
        _plane(half, plan.STEP_X, -plan.STEP_Z, plan.STEP_Z, 0.0),
    ]
    scene.object("court floor", (paving, materials.court_floor), (join(*ends), materials.green_marble))
    y = plan.ARCADE_Y
    nosing = [(0.0, 0.0), (0.0, 0.11), (0.02, 0.12), (0.02, y - 0.012), (0.008, y), (-0.30, y)]
    scene.object("step", (court_moulding(nosing, plan.STEP_X, plan.STEP_Z, 0.0), materials.limestone))
    edge_x, edge_z = plan.STEP_X + 0.30, plan.STEP_Z + 0.30
    arcade = join(
        _plane(-plan.INNER_X, plan.INNER_X, -plan.INNER_Z, -edge_z, y),
        _plane(-plan.INNER_X, plan.INNER_X, edge_z, plan.INNER_Z, y),
        _plane(-plan.INNER_X, -edge_x, -edge_z, edge_z, y),
        _plane(edge_x, plan.INNER_X, -edge_z, edge_z, y),
    )
    scene.object("arcade floor", (arcade, materials.tile))
    y, front_z = plan.GALLERY_Y, plan.HALF_Z - plan.LOWER_WALL / 2
    front_x = plan.HALF_X - plan.LOWER_WALL / 2
    hall_x = plan.HALF_X + 0.33
    gallery = join(
        _plane(-plan.INNER_X, hall_x, -plan.INNER_Z, -front_z, y),
        _plane(-plan.INNER_X, hall_x, front_z, plan.INNER_Z, y),
        _plane(-plan.INNER_X, -front_x, -front_z, front_z, y),
        _plane(hall_x, plan.INNER_X, -plan.INNER_Z, -FLIGHT_TOP_Z, y),
        _plane(hall_x, plan.INNER_X, FLIGHT_TOP_Z, plan.INNER_Z, y),
    )
    scene.object("gallery floor", (gallery, materials.tile))
    # The slab's edge beside the stair, between the pier and the flight's end.
    edge = quad((hall_x, y - 0.7, -plan.HALF_Z), (0, 0, plan.HALF_Z - FLIGHT_TOP_Z), (0, 0.7, 0))
    mirrored = edge.transformed(np.diag([1.0, 1.0, -1.0]))
    scene.object("gallery edge", (join(edge, mirrored), materials.limestone))


def baluster(height: float, n_sides: int = 6) -> Mesh:
    """A turned vase baluster between two square blocks."""
    block = 0.075
    low, high = block, height - block
    h = high - low
    profile = profiles.chain(
        (0.030, low),
        (0.043, low + 0.03 * h),
        (0.030, low + 0.09 * h),
        (0.056, low + 0.24 * h),
        (0.058, low + 0.36 * h),
        (0.030, low + 0.70 * h),
        (0.026, low + 0.85 * h),
        (0.042, low + 0.91 * h),
        (0.034, high),
    )
    foot = box((-0.055, 0, -0.055), (0.055, low, 0.055))
    head = box((-0.055, high, -0.055), (0.055, height, 0.055))
    return join(_without_face(foot, -1), lathe(profile, n_sides), _without_face(head, 1))


def handrail_profile(height: float) -> Array:
    """Half outline of the rail's moulding, bottom to top; its highest line is ``height``."""
    low = height - 0.13
    return profiles.chain(
        (0.075, low),
        profiles.cyma(0.075, 0.125, low, 0.05, 4),
        (0.14, low + 0.06),
        (0.14, low + 0.105),
        (0.125, height),
    )


def balustrade(length: float, n_balusters: int) -> Mesh:
    """A straight run along x, centred: plinth, turned balusters, moulded rail, a die at either end."""
    half = length / 2
    plinth, rail_low = 0.14, RAIL_M - 0.13
    post = baluster(rail_low - plinth).moved(y=plinth)
    pitch = length / n_balusters
    posts = [post.moved(x=(k - (n_balusters - 1) / 2) * pitch) for k in range(n_balusters)]
    foot = [
        (0.13, 0.0),
        (0.13, plinth - 0.02),
        (0.11, plinth),
        (-0.11, plinth),
        (-0.13, plinth - 0.02),
        (-0.13, 0.0),
    ]
    profile = handrail_profile(RAIL_M)
    rail = [*profile, *(profile[::-1] * [-1, 1])]
    rail = [(-0.075, rail_low), *rail]
    die = bevelled_box((-0.06, 0.0, -0.155), (0.06, RAIL_M + 0.015, 0.155), 0.01)
    dies = [die.moved(x=side * (half + 0.05)) for side in (-1, 1)]
    return join(*posts, _prismatic(foot, half), _prismatic(rail, half), *dies)


def _prismatic(outline: list, half: float) -> Mesh:
    """An outline of (z, y), front on its right, drawn along x."""
    return moulding(outline, [(-half, 0, 0), (half, 0, 0)])


def _without_face(block: Mesh, up: int) -> Mesh:
    """A box less its top (1) or bottom (-1), which lies against another stone."""
    return block.only(block.normals[block.indices[:, 0], 1] * up < 0.5)


def _ceiling_boards() -> Mesh:
    y, inner_x, inner_z = plan.CEILING_Y, plan.INNER_X, plan.INNER_Z
    edge_z, west, east = plan.HALF_Z - 0.2, -plan.HALF_X + 0.2, plan.HALF_X + 0.35
    return join(
        _under(-inner_x, inner_x, -inner_z, -edge_z, y),
        _under(-inner_x, inner_x, edge_z, inner_z, y),
        _under(-inner_x, west, -edge_z, edge_z, y),
        _under(east, inner_x, -edge_z, edge_z, y),
    )


def _beams() -> Mesh:
    """Joists across the galleries and the hall every 0.8 m."""
    y0, y1, half = plan.CEILING_Y - 0.22, plan.CEILING_Y + 0.01, 0.07
    beams = []
    near_z, near_x = plan.HALF_Z + plan.UPPER_WALL / 2, plan.HALF_X + plan.UPPER_WALL / 2
    for k in range(28):
        x = -plan.HALF_X + 0.4 + 0.8 * k
        for low, high in ((-plan.INNER_Z, -near_z), (near_z, plan.INNER_Z)):
            beams.append(box((x - half, y0, low), (x + half, y1, high)))
    for k in range(12):
        z = -plan.HALF_Z + 0.4 + 0.8 * k
        beams.append(box((-plan.INNER_X, y0, z - half), (-near_x, y1, z + half)))
    for k in range(21):
        z = -8.0 + 0.8 * k
        beams.append(box((plan.HALF_X + 0.35, y0, z - half), (plan.INNER_X, y1, z + half)))
    return join(*beams)


def _plane(x0: float, x1: float, z0: float, z1: float, y: float) -> Mesh:
    """A floor; its texture is laid out from the world's origin, so that parts of one floor match."""
    mesh = quad((x0, y, z1), (x1 - x0, 0, 0), (0, 0, z0 - z1))
    return Mesh(mesh.positions, mesh.normals, mesh.positions[:, [0, 2]], mesh.indices)


def _under(x0: float, x1: float, z0: float, z1: float, y: float) -> Mesh:
    return _plane(x0, x1, z0, z1, y).inside_out()
