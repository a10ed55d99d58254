"""Walls with round-arched openings, their soffits, and the vaults behind them.

Panels stand in the XY plane with their front toward +Z, the opening's axis on x = 0.
"""

from __future__ import annotations

import numpy as np

from irradia.scene.builtin.mesh import Array, Mesh, drop_degenerate, grid, join
from irradia.scene.builtin.shapes import quad


def arc(radius: float, spring_y: float, n_steps: int) -> Array:
    """(n_steps + 1, 3) points of a half circle from −X over the crown to +X, at z = 0."""
    angle = np.linspace(np.pi, 0.0, n_steps + 1)
    return np.stack([radius * np.cos(angle), spring_y + radius * np.sin(angle), 0 * angle], axis=-1)


def arch_panel(
    half_width: float, bottom_y: float, top_y: float, radius: float, spring_y: float, n_steps: int
) -> Mesh:
    """A wall between two heights less the opening under an arch; the opening goes on down to
    ``bottom_y``.
    """
    edge = arc(radius, spring_y, n_steps)
    above = edge * [1, 0, 1] + [0, top_y, 0]
    rows = np.stack([edge, above], axis=1)
    crown = grid(rows, np.broadcast_to([0.0, 0.0, 1.0], rows.shape), rows[..., :2] * [1, -1])
    height = top_y - bottom_y
    left = quad((-half_width, bottom_y, 0), (half_width - radius, 0, 0), (0, height, 0))
    right = quad((radius, bottom_y, 0), (half_width - radius, 0, 0), (0, height, 0))
    # Texture runs through over the three parts, as over one stone wall.
    return join(crown, *(_planar_uv(side) for side in (left, right)))


def soffit(radius: float, spring_y: float, depth: float, n_steps: int) -> Mesh:
    """The underside of an arch, from z = 0 back to z = −depth, facing its centre."""
    front = arc(radius, spring_y, n_steps)
    positions = np.stack([front, front - [0, 0, depth]], axis=1)
    normals = np.broadcast_to(([0, spring_y, 0] - front * [1, 1, 0])[:, None], positions.shape)
    along = np.pi * radius * np.linspace(0, 1, n_steps + 1)
    uv = np.stack(np.broadcast_arrays(along[:, None], np.array([0.0, depth])), axis=-1)
    return _facing_normals(grid(positions, normals, uv))


def jambs(radius: float, bottom_y: float, spring_y: float, depth: float) -> Mesh:
    """The two upright sides of an opening below its arch, from z = 0 back to −depth."""
    height = spring_y - bottom_y
    return join(
        quad((-radius, bottom_y, 0), (0, 0, -depth), (0, height, 0)),
        quad((radius, bottom_y, -depth), (0, 0, depth), (0, height, 0)),
    )


def arched_pane(radius: float, bottom_y: float, spring_y: float, n_steps: int) -> Mesh:
    """A flat pane that fills an arched opening at z = 0; uv in metres from its lower left corner."""
    edge = arc(radius, spring_y, n_steps)
    below = edge * [1, 0, 1] + [0, bottom_y, 0]
    rows = np.stack([below, edge], axis=1)
    uv = (rows[..., :2] + [radius, -bottom_y]) * [1, -1]
    return drop_degenerate(grid(rows, np.broadcast_to([0.0, 0.0, 1.0], rows.shape), uv))


def groin_vault(half_x: float, half_z: float, spring_y: float, rise: float, n_steps: int) -> Mesh:
    """The underside of two crossing barrels over a rectangle around the Y axis, hard at the groins."""
    along_z = [_vault_sector(half_x, half_z, rise, n_steps, sign) for sign in (1, -1)]
    turn = np.array([[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]])
    along_x = [_vault_sector(half_z, half_x, rise, n_steps, sign).transformed(turn) for sign in (1, -1)]
    return join(*along_z, *along_x).moved(y=spring_y)


def _vault_sector(half_span: float, half_depth: float, rise: float, n_steps: int, sign: int) -> Mesh:
    """A quarter of the barrel that spans x: between the groins and one end (±z) of the cell."""
    angle = np.linspace(-np.pi / 2, np.pi / 2, n_steps + 1)
    u, height = np.sin(angle), np.cos(angle)
    height[[0, -1]] = 0.0
    groin = np.stack([half_span * u, rise * height, sign * half_depth * np.abs(u)], axis=-1)
    end = groin * [1, 1, 0] + [0, 0, sign * half_depth]
    normals = -np.stack([rise * u, half_span * height, 0 * u], axis=-1)
    positions = np.stack([groin, end], axis=1)
    step = np.linalg.norm(np.diff(end, axis=0), axis=1)
    along = np.concatenate([[0.0], np.cumsum(step)])
    uv = np.stack([np.stack([along, along], axis=1), positions[..., 2]], axis=-1)
    normals = np.stack([normals, normals], axis=1)
    return drop_degenerate(_facing_normals(grid(positions, normals, uv)))


def _planar_uv(mesh: Mesh) -> Mesh:
    return Mesh(mesh.positions, mesh.normals, mesh.positions[:, :2] * [1, -1], mesh.indices)


def _facing_normals(mesh: Mesh) -> Mesh:
    """Turns each triangle so that its front is where its vertex normals point."""
    a, b, c = (mesh.positions[mesh.indices[:, k]] for k in range(3))
    normal = mesh.normals[mesh.indices].sum(axis=1)
    backward = np.einsum("tc,tc->t", np.cross(b - a, c - a), normal) < 0
    indices = np.where(backward[:, None], mesh.indices[:, ::-1], mesh.indices)
    return Mesh(mesh.positions, mesh.normals, mesh.uv, indices)
