"""The measures of the atrium, in metres: what stands where, so that the parts meet.

A court of 7 × 3 bays lies between arcades on two storeys. Its long axis is X; the grand stair
climbs through a great arch at the east end (+X) into a stair hall. Axes of walls and columns
stand on the rectangle ±HALF_X, ±HALF_Z.
"""

from __future__ import annotations

from collections.abc import Iterator

BAY = 3.2
HALF_X, HALF_Z = 3.5 * BAY, 1.5 * BAY
LOWER_WALL, UPPER_WALL, EAST_WALL = 0.55, 0.40, 0.70
"""Thickness of the arcades' walls, lower and upper storey, and of the great arch's."""
INNER_X, INNER_Z = 15.0, 8.6
"""Inner faces of the outer walls."""
OUTER_WALL = 0.40
PIER = 0.80
"""Side of the square piers at the court's corners."""

ARCADE_Y = 0.16
"""The arcade's floor, a step above the court's, which is 0."""
STEP_X, STEP_Z = HALF_X - 0.45, HALF_Z - 0.45
"""Edge of that step."""
SPRING_Y, ARCH_RADIUS = 3.30, 1.20
STRING_Y, GALLERY_Y = 4.80, 5.30
"""Foot of the string course, and the gallery's floor on its top."""
UPPER_BAY, UPPER_SPRING_Y, UPPER_RADIUS = BAY / 2, 7.60, 0.56
CEILING_Y, CORNICE_Y, ROOF_Y = 8.55, 8.42, 9.35

GREAT_RADIUS, GREAT_SPRING_Y = 3.30, 4.60
LANDING_Y = GALLERY_Y / 2

CORNICE_WEST, CORNICE_EAST = -HALF_X + UPPER_WALL / 2, HALF_X - EAST_WALL / 2
CORNICE_Z = HALF_Z - UPPER_WALL / 2
"""The court's faces under the cornice."""

Spot = tuple[float, float, float]
"""x, z and the yaw that turns a part's +Z toward the court."""


def arcade_spots(step_m: float) -> Iterator[Spot]:
    """Centres of the bays of width ``step_m`` along the north, south and west sides."""
    n_long, n_short = round(2 * HALF_X / step_m), round(2 * HALF_Z / step_m)
    for k in range(n_long):
        x = -HALF_X + (k + 0.5) * step_m
        yield x, -HALF_Z, 0.0
        yield -x, HALF_Z, 180.0
    for k in range(n_short):
        yield -HALF_X, HALF_Z - (k + 0.5) * step_m, 90.0


def column_spots(step_m: float) -> Iterator[Spot]:
    """Points between those bays, without the corners."""
    n_long, n_short = round(2 * HALF_X / step_m), round(2 * HALF_Z / step_m)
    for k in range(1, n_long):
        x = -HALF_X + k * step_m
        yield x, -HALF_Z, 0.0
        yield -x, HALF_Z, 180.0
    for k in range(1, n_short):
        yield -HALF_X, HALF_Z - k * step_m, 90.0


def corners(half_x: float, half_z: float) -> Iterator[tuple[float, float]]:
    """The four corners of a centred rectangle."""
    for x in (-half_x, half_x):
        for z in (-half_z, half_z):
            yield x, z
