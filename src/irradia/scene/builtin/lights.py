"""An exhibition hall at night under 1,000 small lamps of KHR_lights_punctual, nothing else.

Most places are lit by a few lamps nearby and are out of the others' sight: pendants over the aisles,
narrow spots on the pictures of walls and partitions, sconces round the columns, and rows of lanterns
on long tables.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from irradia.core.rng import Seed
from irradia.scene.builtin.builder import SceneBuilder
from irradia.scene.builtin.matte import matte
from irradia.scene.builtin.mesh import Mesh, look_at
from irradia.scene.builtin.shapes import box, cylinder
from irradia.scene.gltf.document import GltfDocument
from irradia.scene.types import Camera, Light, Rgb

N_LAMPS = 1000
HALL_M = (40.0, 6.0, 25.0)
COLUMN_RADIUS_M = 0.3
COLUMNS_XZ = tuple((5.0 * (k % 7 - 3), 5.0 * (k // 7 - 1.5)) for k in range(28))
PARTITIONS_XZ = (
    *((x, -5.0) for x in (-12.5, -2.5, 7.5)),
    *((x, 0.0) for x in (-15.0, -5.0, 5.0, 15.0)),
    *((x, 5.0) for x in (-7.5, 2.5, 12.5)),
)
PARTITION_M = (4.0, 2.6, 0.2)
TABLES_Z = (-10.0, -3.75, 3.75, 10.0)
TABLE_M = (36.0, 0.9, 0.8)

_GLOWS: tuple[Rgb, ...] = (
    (1.0, 0.72, 0.42),
    (1.0, 0.35, 0.22),
    (0.35, 0.62, 1.0),
    (0.45, 1.0, 0.55),
    (0.9, 0.4, 1.0),
)
_WARM_WHITE: Rgb = (1.0, 0.8, 0.58)


def build(name: str = "lights", n_lamps: int = N_LAMPS) -> GltfDocument:
    """The hall with ``n_lamps`` of its lamps, spread over all kinds, together as bright as all."""
    scene = SceneBuilder(name)
    width, height, depth = HALL_M
    plaster = scene.material(matte("plaster", (0.7, 0.69, 0.66)))
    linen = scene.material(matte("linen", (0.55, 0.5, 0.43)))
    room = box((-width / 2, 0, -depth / 2), (width / 2, height, depth / 2)).inside_out()
    scene.object("hall", (room, plaster))
    column = scene.mesh("column", (cylinder(COLUMN_RADIUS_M, height, 16, capped=False), plaster))
    for k, (x, z) in enumerate(COLUMNS_XZ):
        scene.node(f"column {k}", mesh=column, translation=(x, 0, z))
    partition = scene.mesh("partition", (_standing(PARTITION_M), linen))
    for k, (x, z) in enumerate(PARTITIONS_XZ):
        scene.node(f"partition {k}", mesh=partition, translation=(x, 0, z))
    table = scene.mesh("table", (_standing(TABLE_M), linen))
    for k, z in enumerate(TABLES_Z):
        scene.node(f"table {k}", mesh=table, translation=(0, 0, z))
    for light in hall_lamps(n_lamps):
        scene.light(light)
    scene.camera(Camera(look_at((-18, 2.0, 11), (4, 1.5, -4)), yfov_rad=0.9, name="camera"))
    scene.environment_color((0.0, 0.0, 0.0))
    return scene.build()


def hall_lamps(n_lamps: int = N_LAMPS) -> list[Light]:
    """``n_lamps`` of the lamps at even distances in their list, as much brighter as they are fewer."""
    rng = Seed(1).child("lights").numpy()
    lamps = [*_pendants(rng), *_picture_spots(rng), *_sconces(rng), *_lanterns(rng)]
    chosen = [lamps[k * len(lamps) // n_lamps] for k in range(n_lamps)]
    gain = len(lamps) / n_lamps
    return [
        replace(lamp, intensity=_scaled(lamp.intensity, gain), name=f"{lamp.name} {k}")
        for k, lamp in enumerate(chosen)
    ]


def _pendants(rng: np.random.Generator) -> Iterator[Light]:
    """400 bulbs hung in waves over the whole hall."""
    for k in range(400):
        row, column = divmod(k, 25)
        x, z = 1.55 * (column - 12), 1.5 * (row - 7.5)
        x, z = _clear_of_columns(x + rng.uniform(-0.3, 0.3), z + rng.uniform(-0.3, 0.3))
        y = 3.9 + 0.6 * math.sin(0.4 * x) * math.cos(0.5 * z) + rng.uniform(-0.1, 0.1)
        glow = _scaled(_GLOWS[rng.integers(len(_GLOWS))], rng.uniform(2.0, 8.0))
        yield Light("point", glow, position=(x, y, z), radius_m=0.04, name="pendant")


def _picture_spots(rng: np.random.Generator) -> Iterator[Light]:
    """300 narrow spots: 100 for either long wall, and five for either face of every partition."""
    width, _, depth = HALL_M
    for side in (-1.0, 1.0):
        for k in range(100):
            x = (k + 0.5) / 100 * (width - 2.0) - width / 2 + 1.0
            yield _spot((x, 5.4, side * (depth / 2 - 1.8)), (x, 1.6, side * depth / 2), rng)
    for x, z in PARTITIONS_XZ:
        for side in (-1.0, 1.0):
            for k in range(5):
                along = x + (k - 2) * 0.75
                yield _spot((along, 5.4, z + side * 1.6), (along, 1.5, z + side * 0.1), rng)


def _spot(position: Rgb, target: Rgb, rng: np.random.Generator) -> Light:
    direction = np.subtract(target, position)
    x, y, z = (float(value) for value in direction / np.linalg.norm(direction))
    return Light(
        "spot",
        _scaled(_WARM_WHITE, rng.uniform(20.0, 80.0)),
        position=position,
        direction=(x, y, z),
        inner_cone_rad=math.radians(8),
        outer_cone_rad=math.radians(rng.uniform(14.0, 24.0)),
        radius_m=0.03,
        name="picture spot",
    )


def _sconces(rng: np.random.Generator) -> Iterator[Light]:
    """112 sconces, four round each column."""
    reach = COLUMN_RADIUS_M + 0.12
    for x, z in COLUMNS_XZ:
        for k in range(4):
            angle = math.pi / 4 + k * math.pi / 2
            place = (x + reach * math.cos(angle), 2.3, z + reach * math.sin(angle))
            strength = rng.uniform(1.5, 4.0)
            yield Light("point", _scaled(_WARM_WHITE, strength), position=place, radius_m=0.03, name="sconce")


def _lanterns(rng: np.random.Generator) -> Iterator[Light]:
    """188 lanterns, 47 on each table."""
    for z in TABLES_Z:
        for k in range(47):
            place = (0.75 * (k - 23), TABLE_M[1] + 0.2, z + rng.uniform(-0.25, 0.25))
            glow = _scaled(_GLOWS[rng.integers(len(_GLOWS))], rng.uniform(0.3, 1.2))
            yield Light("point", glow, position=place, radius_m=0.03, name="lantern")


def _standing(size_m: tuple[float, float, float]) -> Mesh:
    """A box on the floor, centred."""
    width, height, depth = size_m
    return box((-width / 2, 0, -depth / 2), (width / 2, height, depth / 2))


def _clear_of_columns(x: float, z: float) -> tuple[float, float]:
    """The place itself, or half a metre off a column's surface."""
    for column_x, column_z in COLUMNS_XZ:
        if math.hypot(x - column_x, z - column_z) < COLUMN_RADIUS_M + 0.2:
            return column_x + COLUMN_RADIUS_M + 0.5, z
    return x, z


def _scaled(colour: Rgb, factor: float) -> Rgb:
    red, green, blue = colour
    return (float(red * factor), float(green * factor), float(blue * factor))
