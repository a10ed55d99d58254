"""The grand stair: one flight from the court to a landing in the hall, two back up to the gallery."""

from __future__ import annotations

import numpy as np

from irradia.scene.builtin import profiles
from irradia.scene.builtin.atrium import plan
from irradia.scene.builtin.atrium.galleries import FLIGHT_TOP_Z, RAIL_M, baluster, handrail_profile
from irradia.scene.builtin.atrium.materials import Materials
from irradia.scene.builtin.builder import SceneBuilder
from irradia.scene.builtin.mesh import Array, Mesh, drop_degenerate, join
from irradia.scene.builtin.shapes import face, quad, sphere
from irradia.scene.builtin.sweep import lathe, moulding, square_moulding

N_RISERS = 15
RISER_M = plan.LANDING_Y / N_RISERS
CHEEK_M = 0.35
"""Width of the walls that flank a flight and carry its balustrade."""

_COURT_GOING, _SIDE_GOING = 0.30, 0.29
_HALF_WIDTH = 1.5
_FRONT_X = plan.HALF_X + 0.40
"""Front edge of the landing, just behind the great arch's axis."""
_CHEEK_X = plan.HALF_X + plan.EAST_WALL / 2 - 0.02
_LANDING_HALF_Z = _HALF_WIDTH + CHEEK_M


def add_stairs(scene: SceneBuilder, materials: Materials) -> None:
    """Flights, landing, flanking walls with sloped balustrades, newel posts."""
    court = scene.mesh("court flight", *_court_flight(materials))
    scene.node("court flight", mesh=court, translation=(_FRONT_X, 0, 0))
    scene.object("landing", *_landing(materials))
    for name, mirror in (("north", 1.0), ("south", -1.0)):
        parts = [(_mirrored(mesh, mirror), material) for mesh, material in _side_flight(materials)]
        scene.object(f"{name} flight", *parts)


def _court_flight(materials: Materials) -> list[tuple[Mesh, int]]:
    """Climbs toward +X and ends on x = 0 at the landing's height."""
    run = (N_RISERS - 1) * _COURT_GOING
    steps = _steps(_COURT_GOING, 2 * _HALF_WIDTH).moved(x=-run)
    cheeks, rails = [], []
    for side in (-1, 1):
        z = side * (_HALF_WIDTH + CHEEK_M / 2)
        cheek, rail = _cheek(run + 0.25, RISER_M / _COURT_GOING, foot_y=0.0)
        cheeks += [cheek.moved(z=z), _newel().moved(-run - 0.25, 0, z)]
        rails.append(rail.moved(z=z))
    return [(steps, materials.white_marble), (join(*cheeks, *rails), materials.limestone)]


def _side_flight(materials: Materials) -> list[tuple[Mesh, int]]:
    """The northern one: climbs toward −Z along the hall's east wall, its cheek toward the court."""
    run = (N_RISERS - 1) * _SIDE_GOING
    low_x, high_x = _CHEEK_X + CHEEK_M, plan.INNER_X
    foot, slope = plan.LANDING_Y - plan.ARCADE_Y, RISER_M / _SIDE_GOING
    steps = _steps(_SIDE_GOING, high_x - low_x).moved(-run, plan.LANDING_Y, 0)
    cheek, rail = _cheek(run, slope, foot_y=-foot)
    # Modelled climbing toward +X to x = 0; then turned to climb toward −Z and to end at the gallery.
    middle_x = (low_x + high_x) / 2
    steps = steps.turned(90).moved(middle_x, 0, -FLIGHT_TOP_Z)
    wall = join(cheek, rail).moved(y=plan.LANDING_Y).turned(90)
    end = quad(
        (high_x, plan.ARCADE_Y, -FLIGHT_TOP_Z),
        (low_x - high_x, 0, 0),
        (0, plan.GALLERY_Y - RISER_M - plan.ARCADE_Y, 0),
    )
    wall = wall.moved(_CHEEK_X + CHEEK_M / 2, 0, -FLIGHT_TOP_Z)
    posts = [
        _newel(plan.LANDING_Y).moved(_CHEEK_X + 0.21, 0, -_LANDING_HALF_Z + 0.13),
        _newel(plan.GALLERY_Y).moved(_CHEEK_X + CHEEK_M / 2, 0, -FLIGHT_TOP_Z - 0.10),
    ]
    return [
        (steps, materials.white_marble),
        (join(wall, *posts), materials.limestone),
        (end, materials.plaster),
    ]


def _landing(materials: Materials) -> list[tuple[Mesh, int]]:
    """A platform against the east wall, with its front beside the court flight."""
    y, x0, x1, half = plan.LANDING_Y, _FRONT_X, plan.INNER_X, _LANDING_HALF_Z
    top = quad((x0, y, half), (x1 - x0, 0, 0), (0, 0, -2 * half))
    front = quad((x0, plan.ARCADE_Y, -half), (0, 0, 2 * half), (0, y - plan.ARCADE_Y, 0))
    return [(top, materials.red_marble), (front, materials.limestone)]


def _steps(going: float, width: float) -> Mesh:
    """Risers and treads with rounded nosings, climbing toward +X from x = 0, centred on z = 0."""
    outline: list[tuple[float, float]] = [(0.0, 0.0)]
    for k in range(N_RISERS):
        x, top = k * going, (k + 1) * RISER_M
        outline += [
            (x, top - 0.045), (x - 0.022, top - 0.035), (x - 0.022, top - 0.010), (x - 0.012, top),
            (x + going, top),
        ]  # fmt: skip
    # Drawn along +Z a moulding faces −X, so the outline is given as (−x, y).
    outline[-1] = ((N_RISERS - 1) * going, outline[-1][1])  # the last tread is the floor above
    profile = np.array(outline) * [-1, 1]
    return moulding(profile, [(0, 0, -width / 2), (0, 0, width / 2)])


def _cheek(run: float, slope: float, foot_y: float) -> tuple[Mesh, Mesh]:
    """A flanking wall that climbs toward +X and ends on x = 0, and the balustrade on its slope.

    Heights are over the flight's foot; the wall goes down to ``foot_y``.
    """
    rise = N_RISERS * RISER_M
    margin = 0.16
    low, high = rise - slope * run + margin, rise + margin
    half = CHEEK_M / 2
    outline = [(-run, foot_y), (0.0, foot_y), (0.0, high), (-run, low)]
    sides = [
        face([(x, y, half) for x, y in outline]),
        face([(x, y, -half) for x, y in reversed(outline)]),
        quad((0.0, foot_y, half), (0, 0, -2 * half), (0, high - foot_y, 0)),
        quad((-run, foot_y, -half), (0, 0, 2 * half), (0, low - foot_y, 0)),
    ]
    coping = _sloped(
        [(half + 0.03, -0.04), (half + 0.03, 0.04), (half + 0.01, 0.06), (-half - 0.01, 0.06),
         (-half - 0.03, 0.04), (-half - 0.03, -0.04)], run, low, slope,
    )  # fmt: skip
    profile = handrail_profile(RAIL_M - 0.22)
    outline_rail = [(-0.075, profile[0, 1]), *profile, *(profile[::-1] * [-1, 1])]
    rail = _sloped(outline_rail, run, low, slope)
    n_posts = round(run / 0.36)
    # Long enough to sink into the slope below and the rail above.
    length = RAIL_M - 0.22 - 0.13 + 0.04
    posts = []
    for k in range(n_posts):
        x = -run + (k + 0.5) * run / n_posts
        posts.append(baluster(length).moved(x, low + slope * (x + run) + 0.01, 0))
    return join(*sides), join(coping, rail, *posts)


def _sloped(outline: list | Array, run: float, low: float, slope: float) -> Mesh:
    """An outline of (z, y) drawn up a slope toward +X, sheared so that uprights stay upright."""
    level = moulding(outline, [(-run, 0, 0), (0, 0, 0)])
    shear = np.eye(4)
    shear[1, 0], shear[1, 3] = slope, low + slope * run
    return level.transformed(shear)


def _newel(foot_y: float = 0.0) -> Mesh:
    """A square post with base, cap and ball."""
    height = 1.12
    profile = profiles.chain(
        (0.04, 0.0),
        (0.04, 0.16),
        profiles.cyma(0.04, 0.0, 0.16, 0.05, 4),
        (0.0, height - 0.16),
        profiles.cyma(0.0, 0.05, height - 0.16, 0.08, 5),
        (0.06, height - 0.06),
        (0.06, height - 0.01),
        (0.05, height),
        (-0.21, height),
    )
    neck = lathe(profiles.chain((0.09, height), profiles.scotia(0.09, 0.05, height, 0.07, 0.015, 4)), 16)
    ball = sphere(0.13, 16, 10).moved(y=height + 0.18)
    return join(drop_degenerate(square_moulding(profile, 0.21)), neck, ball).moved(y=foot_y)


def _mirrored(mesh: Mesh, sign: float) -> Mesh:
    return mesh.transformed(np.diag([1.0, 1.0, sign]))
