"""The outer walls with their windows, the roof, and the plain shell that the world outside sees."""

from __future__ import annotations

from irradia.scene.builtin import profiles
from irradia.scene.builtin.arch import arch_panel, arched_pane, jambs, soffit
from irradia.scene.builtin.atrium import plan
from irradia.scene.builtin.atrium.materials import Materials
from irradia.scene.builtin.atrium.ornament import upright_band
from irradia.scene.builtin.builder import SceneBuilder
from irradia.scene.builtin.mesh import Mesh, join
from irradia.scene.builtin.shapes import bevelled_box, floor, frame, quad
from irradia.scene.builtin.sweep import moulding, sweep_arc

_OUTER_X, _OUTER_Z = plan.INNER_X + plan.OUTER_WALL, plan.INNER_Z + plan.OUTER_WALL
_FOOT_Y = -0.4
"""How deep the shell goes: its underside lies well below the court's floor."""
_SHELL_LIGHTMAP_SCALE = 0.2
"""Texel density outside, where nobody looks."""

# Windows: radius, sill, spring; places along the wall. South: the gallery. East: over the landing.
_SOUTH, _SOUTH_PLACES = (0.55, 6.05, 7.45), (-6.4, -3.2, 0.0, 3.2, 6.4)
_EAST, _EAST_PLACES = (0.75, 4.55, 6.95), (-2.6, 0.0, 2.6)


def add_walls(scene: SceneBuilder, materials: Materials) -> None:
    """Inner faces, windows with stained glass, skirting, shell and roof."""
    low = plan.ARCADE_Y
    for z, yaw in ((-plan.INNER_Z, 0.0), (plan.INNER_Z, 180.0)):
        name = "north" if z < 0 else "south"
        lower = quad((-plan.INNER_X, low, 0), (2 * plan.INNER_X, 0, 0), (0, plan.GALLERY_Y - low, 0))
        scene.node(f"{name} wall below", mesh=scene.mesh(f"{name} wall below", (lower, materials.plaster)),
                   translation=(0, 0, z), yaw_deg=yaw)  # fmt: skip
    height = plan.CEILING_Y - plan.GALLERY_Y
    north = quad((-plan.INNER_X, plan.GALLERY_Y, -plan.INNER_Z), (2 * plan.INNER_X, 0, 0), (0, height, 0))
    west = quad((-plan.INNER_Z, low, -plan.INNER_X), (2 * plan.INNER_Z, 0, 0), (0, plan.CEILING_Y - low, 0))
    scene.object("north wall above", (north, materials.plaster))
    scene.object("west wall", (west.turned(90), materials.plaster))
    _add_south_windows(scene, materials)
    _add_east_windows(scene, materials)
    _add_skirting(scene, materials)
    _add_shell(scene, materials)


def _add_south_windows(scene: SceneBuilder, materials: Materials) -> None:
    """The upper south wall; seen from inside, +X of a panel is −X of the world (yaw 180)."""
    panels = _window_row(_SOUTH, _SOUTH_PLACES, plan.BAY / 2, plan.GALLERY_Y, plan.CEILING_Y, plan.INNER_X)
    scene.node(
        "south wall above",
        mesh=scene.mesh("south wall above", (panels, materials.plaster)),
        translation=(0, 0, plan.INNER_Z),
        yaw_deg=180,
    )
    window = scene.mesh("south window", *_window(_SOUTH, materials))
    for k, x in enumerate(_SOUTH_PLACES):
        scene.node(f"south window {k}", mesh=window, translation=(x, 0, plan.INNER_Z), yaw_deg=180)


def _add_east_windows(scene: SceneBuilder, materials: Materials) -> None:
    panels = _window_row(_EAST, _EAST_PLACES, 1.3, plan.ARCADE_Y, plan.CEILING_Y, plan.INNER_Z)
    scene.node(
        "east wall",
        mesh=scene.mesh("east wall", (panels, materials.plaster)),
        translation=(plan.INNER_X, 0, 0),
        yaw_deg=-90,
    )
    window = scene.mesh("east window", *_window(_EAST, materials))
    for k, z in enumerate(_EAST_PLACES):
        scene.node(f"east window {k}", mesh=window, translation=(plan.INNER_X, 0, z), yaw_deg=-90)


def _window_row(
    window: tuple[float, float, float],
    places: tuple[float, ...],
    half_bay: float,
    low_y: float,
    high_y: float,
    half_length: float,
) -> Mesh:
    """A wall at z = 0, front +Z, with a row of equal openings: bays above the sills, plain elsewhere."""
    radius, sill, spring = window
    bays = [arch_panel(half_bay, sill, high_y, radius, spring, 16).moved(x=x) for x in places]
    edge = half_bay * len(places)
    below = quad((-edge, low_y, 0), (2 * edge, 0, 0), (0, sill - low_y, 0))
    left = quad((-half_length, low_y, 0), (half_length - edge, 0, 0), (0, high_y - low_y, 0))
    right = quad((edge, low_y, 0), (half_length - edge, 0, 0), (0, high_y - low_y, 0))
    return join(*bays, below, left, right)


def _window(window: tuple[float, float, float], materials: Materials) -> list[tuple[Mesh, int]]:
    """Reveals, sill, a moulded frame inside, and the pane half-way through the wall; front +Z."""
    radius, sill, spring = window
    depth = plan.OUTER_WALL
    band = [(0.0, 0.0), (0.05, 0.0), (0.05, 0.07), (0.03, 0.09), (0.03, 0.14), (0.0, 0.14)]
    ledge = bevelled_box((-radius - 0.2, sill - 0.13, -0.01), (radius + 0.2, sill + 0.004, 0.10), 0.015)
    stone = join(
        soffit(radius, spring, depth, 16),
        jambs(radius, sill, spring, depth),
        quad((-radius, sill, 0), (2 * radius, 0, 0), (0, 0, -depth)),
        sweep_arc(band, radius, 16).moved(y=spring),
        upright_band(band, radius, sill, spring),
        ledge,
    )
    pane = arched_pane(radius, sill, spring, 16).moved(z=-depth / 2)
    return [(stone, materials.limestone), (pane, materials.glass)]


def _add_skirting(scene: SceneBuilder, materials: Materials) -> None:
    """A red marble skirting along the outer walls of both storeys."""
    skirting = profiles.chain(
        (0.03, 0.0), (0.03, 0.34), profiles.cyma(0.03, 0.004, 0.34, 0.06, 4), (0.0, 0.40)
    )
    edge_x, edge_z = plan.INNER_X, plan.INNER_Z
    path = [(edge_x, edge_z), (-edge_x, edge_z), (-edge_x, -edge_z), (edge_x, -edge_z)]
    lower = moulding(skirting, [(x, plan.ARCADE_Y, z) for x, z in path])
    upper = moulding(skirting, [(x, plan.GALLERY_Y, z) for x, z in path])
    scene.object("skirting", (join(lower, upper), materials.red_marble))


def _add_shell(scene: SceneBuilder, materials: Materials) -> None:
    """Outside faces with the windows' openings, and the roof; sparse in the lightmap."""
    height = plan.ROOF_Y
    south = _window_row(_SOUTH, _SOUTH_PLACES, plan.BAY / 2, _FOOT_Y, height, _OUTER_X).moved(z=_OUTER_Z)
    east = _window_row(_EAST, _EAST_PLACES, 1.3, _FOOT_Y, height, _OUTER_Z).moved(z=_OUTER_X).turned(90)
    north = quad((-_OUTER_X, _FOOT_Y, _OUTER_Z), (2 * _OUTER_X, 0, 0), (0, height - _FOOT_Y, 0)).turned(180)
    west = quad((-_OUTER_Z, _FOOT_Y, _OUTER_X), (2 * _OUTER_Z, 0, 0), (0, height - _FOOT_Y, 0)).turned(-90)
    outer = _rectangle(-_OUTER_X, _OUTER_X, _OUTER_Z, height)
    roof = frame(outer, _rectangle(plan.CORNICE_WEST, plan.CORNICE_EAST, plan.CORNICE_Z, height))
    underside = floor(2 * _OUTER_X, 2 * _OUTER_Z, y=_FOOT_Y).inside_out()
    shell = join(south, east, north, west, roof, underside)
    scene.object("shell", (shell, materials.plaster), lightmap_scale=_SHELL_LIGHTMAP_SCALE)


def _rectangle(west: float, east: float, half_z: float, y: float) -> list[tuple[float, float, float]]:
    """Corners counter-clockwise seen from above."""
    return [(west, y, half_z), (east, y, half_z), (east, y, -half_z), (west, y, -half_z)]
