"""What enlivens the outer walls: doors, painted panels in moulded frames, and a band at the spring."""

from __future__ import annotations

import itertools

import numpy as np

from irradia.scene.builtin import profiles
from irradia.scene.builtin.arch import arched_pane
from irradia.scene.builtin.atrium import plan
from irradia.scene.builtin.atrium.materials import Materials
from irradia.scene.builtin.builder import SceneBuilder
from irradia.scene.builtin.mesh import Mesh, join
from irradia.scene.builtin.shapes import quad
from irradia.scene.builtin.sweep import moulding, square_moulding, sweep_arc

Z_FROM_Y = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]])
"""Stands a thing that lies on its back upright: +Y becomes +Z."""

_DOOR_BAYS = (-6.4, 0.0, 6.4)
_PANEL_BAYS = (-9.6, -3.2, 3.2, 9.6)
_SIDES = (("north", -plan.INNER_Z, 0.0), ("south", plan.INNER_Z, 180.0))


def add_ornament(scene: SceneBuilder, materials: Materials) -> None:
    """Doors and panels on the ground floor, panels on the gallery and under the east windows."""
    door = scene.mesh("door", *_door(materials))
    low = scene.mesh("lower panel", *_panel(1.9, 1.7, materials.fresco["ochre"], materials))
    for side, z, yaw in _SIDES:
        for x in _DOOR_BAYS:
            scene.node(f"{side} door {x:g}", mesh=door, translation=(x, 0, z), yaw_deg=yaw)
        for x in _PANEL_BAYS:
            scene.node(f"{side} panel {x:g}", mesh=low, translation=(x, 1.85, z), yaw_deg=yaw)
    scene.node("west door", mesh=door, translation=(-plan.INNER_X, 0, 0), yaw_deg=90)
    for k, z in enumerate((-plan.BAY, plan.BAY)):
        scene.node(f"west panel {k}", mesh=low, translation=(-plan.INNER_X, 1.85, z), yaw_deg=90)
    _add_gallery_panels(scene, materials)
    scene.object("spring band", (_spring_band(), materials.limestone))


def _add_gallery_panels(scene: SceneBuilder, materials: Materials) -> None:
    middle_y = plan.GALLERY_Y + 1.62
    high = {
        name: scene.mesh(f"gallery panel {name}", *_panel(2.3, 1.75, index, materials))
        for name, index in materials.fresco.items()
    }
    for k in range(7):
        name = ("red", "green")[k % 2]
        place = (plan.BAY * (k - 3), middle_y, -plan.INNER_Z)
        scene.node(f"north gallery panel {k}", mesh=high[name], translation=place)
    for k in range(3):
        name = ("red", "green")[k % 2]
        place = (-plan.INNER_X, middle_y, plan.BAY * (k - 1))
        scene.node(f"west gallery panel {k}", mesh=high[name], translation=place, yaw_deg=90)
    sill = scene.mesh("landing panel", *_panel(1.9, 0.95, materials.fresco["red"], materials))
    for k in range(3):
        place = (plan.INNER_X, plan.LANDING_Y + 0.98, 2.6 * (k - 1))
        scene.node(f"landing panel {k}", mesh=sill, translation=place, yaw_deg=-90)


def upright_band(band: list[tuple[float, float]], radius: float, low_y: float, high_y: float) -> Mesh:
    """The band round an arch, (proud, away), carried straight down both jambs."""
    outline = [(proud, radius + away) for proud, away in band]
    right = join(
        *(
            quad((x0, low_y, z0), (x1 - x0, 0, z1 - z0), (0, high_y - low_y, 0))
            for (z0, x0), (z1, x1) in itertools.pairwise(outline)
        )
    )
    return join(right, right.transformed(np.diag([-1.0, 1.0, 1.0])))


def _door(materials: Materials) -> list[tuple[Mesh, int]]:
    """A round-headed door of oak boards in a stone frame, on a wall at z = 0; front +Z."""
    radius, spring = 0.68, 2.25
    band = [(0.0, 0.0), (0.11, 0.0), (0.11, 0.09), (0.07, 0.12), (0.07, 0.19), (0.0, 0.19)]
    leaf = arched_pane(radius, plan.ARCADE_Y, spring, 16).moved(z=0.05)
    frame = join(
        sweep_arc(band, radius, 16).moved(y=spring), upright_band(band, radius, plan.ARCADE_Y, spring)
    )
    return [(leaf, materials.wood), (frame, materials.limestone)]


def _panel(width: float, height: float, paint: int, materials: Materials) -> list[tuple[Mesh, int]]:
    """A painted field in a moulded frame, centred on the origin, on a wall at z = 0; front +Z."""
    field = quad((-width / 2, -height / 2, 0.012), (width, 0, 0), (0, height, 0))
    profile = profiles.chain(
        (0.09, 0.0), (0.09, 0.02), profiles.cyma(0.085, 0.05, 0.02, 0.03, 4), (0.0, 0.05), (0.0, 0.012)
    )
    frame = square_moulding(profile, width / 2, height / 2).transformed(Z_FROM_Y)
    return [(field, paint), (frame, materials.limestone)]


def _spring_band() -> Mesh:
    """A moulding along the arcades' outer walls where the vaults begin."""
    profile = profiles.chain(
        (0.0, 0.0),
        (0.02, 0.0),
        (0.02, 0.05),
        profiles.cyma(0.02, 0.07, 0.05, 0.07, 5),
        (0.075, 0.16),
        (0.0, 0.16),
    )
    edge_x, edge_z, y = plan.INNER_X, plan.INNER_Z, plan.SPRING_Y - 0.16
    path = [(edge_x, y, edge_z), (-edge_x, y, edge_z), (-edge_x, y, -edge_z), (edge_x, y, -edge_z)]
    return moulding(profile, path)
