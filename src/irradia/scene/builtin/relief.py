"""Thin solids from a sheet of points: leaves of capitals, cloth. Closed, so that light can't leak through."""

from __future__ import annotations

import numpy as np

from irradia.scene.builtin.mesh import Array, Mesh, grid, join


def sheet(points: Array, thickness: float | Array, uv: Array) -> Mesh:
    """A closed shell around an (R, C, 3) sheet, smooth on both faces, with an edge all round.

    Args:
        points: Front where (along rows) × (along columns) points.
        thickness: Metres, one value or (R, C).
        uv: (R, C, 2) in metres.
    """
    normals = surface_normals(points)
    half = normals * np.broadcast_to(np.asarray(thickness) / 2, points.shape[:2])[..., None]
    front = grid(points + half, normals, uv)
    back = grid(points - half, normals, uv).inside_out()
    return join(front, back, _rim(points + half, points - half, uv))


def surface_normals(points: Array) -> Array:
    """(R, C, 3) unit normals of a sheet by central differences."""
    along_rows = np.gradient(points, axis=0)
    along_columns = np.gradient(points, axis=1)
    normals = np.cross(along_rows, along_columns)
    return normals / np.maximum(np.linalg.norm(normals, axis=-1, keepdims=True), 1e-20)


def leaf(spine: Array, width: float, thickness: float) -> Mesh:
    """A carved leaf that grows along a spine of (N, 2) (outward +Z, height) and hollows across."""
    n = len(spine)
    along = np.linspace(0, 1, n)
    across = np.linspace(-1, 1, 4)
    half_width = width / 2 * np.sin(np.pi * (0.22 + 0.72 * along)) ** 0.8
    x = across[:, None] * half_width[None]
    hollow = 0.22 * half_width[None] * np.abs(across[:, None]) ** 2
    z = np.broadcast_to(spine[None, :, 0], x.shape) - hollow
    y = np.broadcast_to(spine[None, :, 1], x.shape)
    points = np.stack([x, y, z], axis=-1)
    uv = np.stack([x + width / 2, -np.broadcast_to(along * np.ptp(spine[:, 1]), x.shape)], axis=-1)
    return sheet(points, thickness, uv)


def _rim(front: Array, back: Array, uv: Array) -> Mesh:
    """The strip between both faces along the sheet's four edges, each edge flat-shaded across."""
    strips = []
    for edge in (np.s_[:, 0], np.s_[-1, :], np.s_[::-1, -1], np.s_[0, ::-1]):
        rows = np.stack([back[edge], front[edge]], axis=1)
        # Along the edge × from back to front: away from the sheet.
        outward = np.cross(np.gradient(rows[:, 0], axis=0), rows[:, 1] - rows[:, 0])
        normals = np.stack([outward, outward], axis=1)
        strips.append(grid(rows, normals, np.stack([uv[edge], uv[edge] + 0.01], axis=1)))
    return join(*strips)
