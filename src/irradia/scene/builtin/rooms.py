"""Two rooms joined by a door: a lamp lights the one, and the other has only what comes through the door.

Walls are 10 cm thick all round, solid, and closed: no light comes from outside. The bright room has twenty
times the light of the dim one, so what is stored too coarsely leaks through the wall between them.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from irradia.scene.builtin.builder import SceneBuilder
from irradia.scene.builtin.matte import matte
from irradia.scene.builtin.mesh import Mesh, join, look_at
from irradia.scene.builtin.shapes import box, centred_box, face
from irradia.scene.gltf.document import GltfDocument
from irradia.scene.types import Camera

WALL_M = 0.1
LENGTH_M, WIDTH_M, HEIGHT_M = 4.0, 3.5, 2.6
"""Of each room: along x, z and y. The bright one ends at x = 0, the dim one begins at x = WALL_M."""

DOOR_Z_M, DOOR_HEIGHT_M = (0.3, 1.2), 2.05
LAMP_RADIANCE = (26.0, 23.0, 18.0)

_Corners = Sequence[tuple[float, float, float]]


def build() -> GltfDocument:
    """Shell, furniture, one lamp; a camera in either room, the dim one's first."""
    scene = SceneBuilder("rooms")
    bright = _bright_room()
    dim = bright.mirrored()
    white = scene.material(matte("ceiling", (0.80, 0.80, 0.78)))
    oak = scene.material(matte("oak", (0.42, 0.29, 0.18)))
    cream = scene.material(matte("cream", (0.74, 0.71, 0.64)))
    clay = scene.material(matte("clay", (0.58, 0.26, 0.17)))
    sage = scene.material(matte("sage", (0.46, 0.56, 0.48)))
    blue = scene.material(matte("blue", (0.18, 0.27, 0.46)))
    scene.object(
        "shell",
        (join(bright.floor, dim.floor, _threshold()), oak),
        (join(bright.ceiling, dim.ceiling), white),
        (join(bright.sides, _door_frame()), cream),
        (bright.end, clay),
        (join(dim.sides, dim.end), sage),
        (_outside(), white),
    )
    scene.object("table", (_table(), oak))
    scene.object("bench", (box((-3.9, 0.0, -1.3), (-3.45, 0.45, 0.5)), blue))
    scene.object("shelf", (_shelf(), oak))
    scene.object("chest", (box((1.2, 0.0, -1.7), (2.2, 0.5, -1.2)), clay))
    housing, pane = _lamp()
    lamp = matte("lamp", (0.0, 0.0, 0.0), emission=LAMP_RADIANCE)
    scene.object("lamp", (housing, white), (pane, scene.material(lamp)))
    for name, eye, target in (
        ("dim room", (3.75, 1.55, -1.1), (0.3, 1.0, 0.5)),
        ("bright room", (-3.7, 1.6, -1.2), (-0.2, 0.9, 0.5)),
    ):
        scene.camera(Camera(look_at(eye, target), yfov_rad=1.0, name=name))
    scene.environment_color((0.0, 0.0, 0.0))
    return scene.build()


@dataclass(frozen=True)
class _Room:
    """The inside of a room, fronts inward; ``end`` is the wall far from the door, ``sides`` the others."""

    floor: Mesh
    ceiling: Mesh
    sides: Mesh
    end: Mesh

    def mirrored(self) -> _Room:
        """The same room on the other side of the wall."""
        across = np.diag([-1.0, 1.0, 1.0, 1.0])
        across[0, 3] = WALL_M
        parts = (self.floor, self.ceiling, self.sides, self.end)
        return _Room(*(part.transformed(across) for part in parts))


def _bright_room() -> _Room:
    """Neighbouring faces share whole edges: no vertex lies midway on another's edge."""
    z0, z1 = -WIDTH_M / 2, WIDTH_M / 2
    (door0, door1), door_top, top = DOOR_Z_M, DOOR_HEIGHT_M, HEIGHT_M
    plan = [(-LENGTH_M, z0), (-LENGTH_M, z1), (0.0, z1), (0.0, door1), (0.0, door0), (0.0, z0)]
    along = ((-LENGTH_M, 0.0), (0.0, 0.0), (0.0, top), (-LENGTH_M, top))
    long_walls = [_inward([(x, y, z) for x, y in along]) for z in (z0, z1)]
    left = [(0.0, z0), (0.0, door0), (door_top, door0), (top, door0), (top, z0)]
    right = [(0.0, z1), (0.0, door1), (door_top, door1), (top, door1), (top, z1)]
    above = [(door_top, door0), (door_top, door1), (top, door1), (top, door0)]
    door_wall = [_inward([(0.0, y, z) for y, z in part]) for part in (left, right, above)]
    return _Room(
        floor=_inward([(x, 0.0, z) for x, z in plan]),
        ceiling=_inward([(x, top, z) for x, z in plan]),
        sides=join(*long_walls, *door_wall),
        end=_inward([(-LENGTH_M, y, z) for y, z in ((0.0, z0), (0.0, z1), (top, z1), (top, z0))]),
    )


def _inward(corners: _Corners) -> Mesh:
    """A face of the bright room that looks into it; triangles fan out from the first corner."""
    return _facing(corners, (-LENGTH_M / 2, HEIGHT_M / 2, 0.0))


def _facing(corners: _Corners, viewer: tuple[float, float, float]) -> Mesh:
    """A face whose front a viewer sees."""
    mesh = face(corners)
    if mesh.normals[0] @ (np.array(viewer) - corners[0]) > 0:
        return mesh
    return face([corners[0], *corners[:0:-1]])


def _threshold() -> Mesh:
    (z0, z1), x1 = DOOR_Z_M, WALL_M
    return _facing([(0.0, 0.0, z0), (x1, 0.0, z0), (x1, 0.0, z1), (0.0, 0.0, z1)], _in_the_door())


def _door_frame() -> Mesh:
    """Both jambs and what lies above."""
    (z0, z1), top, x1 = DOOR_Z_M, DOOR_HEIGHT_M, WALL_M
    jambs = [[(0.0, 0.0, z), (x1, 0.0, z), (x1, top, z), (0.0, top, z)] for z in (z0, z1)]
    above = [(0.0, top, z0), (x1, top, z0), (x1, top, z1), (0.0, top, z1)]
    return join(*(_facing(corners, _in_the_door()) for corners in (*jambs, above)))


def _in_the_door() -> tuple[float, float, float]:
    return (WALL_M / 2, DOOR_HEIGHT_M / 2, sum(DOOR_Z_M) / 2)


def _outside() -> Mesh:
    """The building from outside."""
    low = (-LENGTH_M - WALL_M, -WALL_M, -WIDTH_M / 2 - WALL_M)
    high = (LENGTH_M + 2 * WALL_M, HEIGHT_M + WALL_M, WIDTH_M / 2 + WALL_M)
    return box(low, high)


def _table() -> Mesh:
    """A board on four legs, in the bright room."""
    x, z, half_x, half_z, height = -1.9, 0.2, 0.65, 0.4, 0.72
    legs = [
        centred_box((0.06, height, 0.06), (x + sx * (half_x - 0.08), height / 2, z + sz * (half_z - 0.08)))
        for sx in (-1, 1)
        for sz in (-1, 1)
    ]
    board = box((x - half_x, height, z - half_z), (x + half_x, height + 0.04, z + half_z))
    return join(board, *legs)


def _shelf() -> Mesh:
    """Two sides and five boards against the end wall of the dim room, open at the back."""
    x0, x1, z0, z1, thickness, height = 3.72, 4.05, -0.6, 0.5, 0.03, 1.9
    sides = [box((x0, 0.0, z), (x1, height, z + thickness)) for z in (z0 - thickness, z1)]
    heights = np.linspace(0.08, height - thickness, 5)
    boards = [box((x0, y, z0), (x1, y + thickness, z1)) for y in heights]
    return join(*sides, *boards)


def _lamp() -> tuple[Mesh, Mesh]:
    """A flat box under the bright room's ceiling, and its pane, which shines downward."""
    whole = centred_box((1.2, 0.06, 0.4), (-2.0, HEIGHT_M - 0.18, 0.1))
    downward = np.all(whole.normals[whole.indices, 1] < -0.5, axis=1)
    return whole.only(~downward), whole.only(downward)
