"""Coloured cloth: throws over the balustrade, tied curtains in the arches, sails over the court."""

from __future__ import annotations

import numpy as np

from irradia.core.rng import Seed
from irradia.scene.builtin.atrium import plan
from irradia.scene.builtin.atrium.galleries import RAIL_M
from irradia.scene.builtin.atrium.materials import Materials
from irradia.scene.builtin.builder import SceneBuilder
from irradia.scene.builtin.mesh import Array, Mesh, join
from irradia.scene.builtin.relief import sheet
from irradia.scene.builtin.shapes import cylinder

THICKNESS_M = 0.012
_N_FOLDS = 6

# Colour, half-bay along x (0 is the court's middle) of each throw, north and south.
_NORTH_THROWS = (
    ("crimson", -5.6),
    ("saffron", -2.4),
    ("ultramarine", 0.8),
    ("crimson", 4.0),
    ("emerald", 7.2),
)
_SOUTH_THROWS = (("ultramarine", -7.2), ("emerald", -2.4), ("violet", 2.4), ("saffron", 5.6))
_CURTAINS = (("ultramarine", -3.2, -1), ("crimson", 0.0, 1), ("saffron", 3.2, -1), ("emerald", 6.4, 1))
_SAILS = (("saffron", -7.4, 1.8), ("crimson", -0.4, 1.8), ("ultramarine", 6.0, 1.8))


def add_cloth(scene: SceneBuilder, materials: Materials) -> None:
    """Everything woven; sheets are closed shells, so each side is lit for itself."""
    for throws, z, yaw in ((_NORTH_THROWS, -plan.HALF_Z, 0.0), (_SOUTH_THROWS, plan.HALF_Z, 180.0)):
        for colour, x in throws:
            throw = _throw(f"throw-{colour}-{x}-{yaw}")
            mesh = scene.mesh(f"{colour} throw", (throw, materials.cloth[colour]))
            scene.node(f"{colour} throw", mesh=mesh, translation=(x, plan.GALLERY_Y, z), yaw_deg=yaw)
    for colour, x, side in _CURTAINS:
        curtain = _curtain(side)
        rod = cylinder(0.02, 2 * plan.ARCH_RADIUS, 8).transformed([[0, 1, 0], [0, 0, 1], [1, 0, 0]])
        mesh = scene.mesh(
            f"{colour} curtain",
            (curtain, materials.cloth[colour]),
            (rod.moved(-plan.ARCH_RADIUS, 3.22, 0), materials.bronze),
        )
        scene.node(f"{colour} curtain", mesh=mesh, translation=(x, 0, -plan.HALF_Z))
    for colour, x, width in _SAILS:
        scene.object(f"{colour} sail", (_sail(width).moved(x=x), materials.cloth[colour]))


def _throw(name: str) -> Mesh:
    """Cloth laid over the rail at the origin: long toward the court (+Z), short behind."""
    rng = Seed(1).child(name).numpy()
    half_width, front, behind = 0.62, rng.uniform(1.9, 2.5), 0.55
    path, slack = _over_rail(front, behind)
    across = np.linspace(-1, 1, 17)
    phase = rng.uniform(0, 2 * np.pi)
    folds = 0.035 * np.sin(3.1 * np.pi * across + phase) + 0.018 * np.sin(7.3 * np.pi * across + 2 * phase)
    loose = np.clip(slack / 1.1, 0, 1)
    forward = np.where(path[:, 0] > 0, 1.0, -0.6)
    x = half_width * across[:, None] * (1 - 0.05 * loose[None])
    sag = 0.03 * loose[None] * np.cos(2.1 * np.pi * across + phase)[:, None]
    z = path[None, :, 0] + forward[None] * loose[None] * (0.05 + folds[:, None])
    points = np.stack([x, path[None, :, 1] - sag, z], axis=-1)
    length = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(path, axis=0), axis=1))])
    uv = np.stack(np.broadcast_arrays(half_width * across[:, None], -length[None]), axis=-1)
    # Front up and toward the court: along the rail, then from the court's hem over it.
    return sheet(points, THICKNESS_M, uv)


def _over_rail(front: float, behind: float) -> tuple[Array, Array]:
    """(N, 2) of (z, y) from the court's hem over the string course and the rail, and down behind;
    and (N,) how far each point hangs below what last carries it.
    """
    gap, top, lip = 0.165, RAIL_M + 0.012, (0.63, 0.03)
    hanging = np.linspace([lip[0], top - front], lip, 7)
    t = np.linspace(0, 1, 6)[:, None]
    # From the string course's lip up to the rail the cloth sags a little.
    leaning = np.array(lip) * (1 - t) + np.array([gap, top - 0.10]) * t + [0.05, -0.06] * (t * (1 - t))
    angle = np.linspace(0, np.pi, 6)
    over = np.stack([gap * np.cos(angle), top - 0.10 + 0.10 * np.sin(angle)], axis=1)
    down = np.linspace([-gap, top - 0.10], [-gap, top - behind], 3)
    path = np.concatenate([hanging[:-1], leaning[:-1], over, down[1:]])
    slack = np.concatenate(
        [lip[1] - hanging[:-1, 1], 0.25 * np.sin(np.pi * t[:-1, 0]), 0 * angle, top - 0.10 - down[1:, 1]]
    )
    return path, slack


def _curtain(side: int) -> Mesh:
    """A curtain across an arch, gathered to one side (±1) by a tie, hanging in folds; front +Z."""
    top, tie, hem = 3.20, 1.35, plan.ARCADE_Y + 0.06
    heights = np.concatenate([np.linspace(hem, tie, 9)[:-1], np.linspace(tie, top, 12)])
    reach = np.clip((heights - tie) / (top - tie), 0, 1)
    below = np.clip((tie - heights) / (tie - hem), 0, 1)
    edge = plan.ARCH_RADIUS - 0.06
    outer = edge - 0.10 * np.sin(np.pi * reach) - 0.05 * (below + (reach <= 0))
    width = 0.34 + (2 * edge - 0.49) * reach**1.7 + 0.26 * np.sqrt(below)
    across = np.linspace(0, 1, 41)
    x = side * (outer[None] - width[None] * across[:, None])
    # Folds as deep as they are wide apart, or the offset faces of the shell would cross.
    depth = 0.25 * width / _N_FOLDS
    fold = (
        np.sin(2 * np.pi * _N_FOLDS * across)[:, None] + 0.35 * np.sin(2 * np.pi * 2 * across + 1.0)[:, None]
    )
    sag = -0.35 * reach[None] * (1 - reach[None]) * across[:, None]
    points = np.stack([x, heights[None] + sag, depth[None] * fold], axis=-1)
    uv = np.stack(np.broadcast_arrays(2.2 * across[:, None], -heights[None]), axis=-1)
    if side > 0:
        points, uv = points[::-1], uv[::-1]
    return sheet(points, THICKNESS_M / 2, uv)


def _sail(width: float) -> Mesh:
    """A strip slung across the court under the cornice, with the cords that hold it."""
    half_span, high, sag = plan.CORNICE_Z - 0.55, plan.CORNICE_Y - 0.10, 0.85
    along = np.linspace(-1, 1, 29)
    across = np.linspace(-1, 1, 13)
    y = high - sag * (1 - along**2)
    ripple = 0.05 * np.sin(2.5 * np.pi * across[:, None] + 1.3 * along[None]) * (1 - along[None] ** 2)
    hang = 0.10 * across[:, None] ** 2 * (1 - along[None] ** 2)
    narrow = 1 - 0.10 * (1 - along**2)
    x = width / 2 * across[:, None] * narrow[None]
    z = -half_span * np.broadcast_to(along[None], x.shape)
    points = np.stack([x, y[None] + ripple - hang, z], axis=-1)
    uv = np.stack([x, z], axis=-1)
    cords = []
    for end in (-1, 1):
        for edge in (-1, 1):
            start = np.array([edge * width / 2, high, end * half_span])
            cords.append(_cord(start, start + np.array([0.0, 0.12, end * 0.5])))
    return join(sheet(points, THICKNESS_M, uv), *cords)


def _cord(start: Array, end: Array) -> Mesh:
    """A thin rope between two points."""
    along = end - start
    length = float(np.linalg.norm(along))
    up = along / length
    side = np.cross([1.0, 0.0, 0.0], up)
    side /= np.linalg.norm(side)
    matrix = np.eye(4)
    matrix[:3, 0], matrix[:3, 1], matrix[:3, 2] = np.cross(up, side), up, side
    matrix[:3, 3] = start
    return cylinder(0.012, length, 6).transformed(matrix)
