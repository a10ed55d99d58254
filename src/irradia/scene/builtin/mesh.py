"""Triangle meshes as arrays, and the few operations that modelling with them needs."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Mesh:
    """Triangles with vertex normals; counter-clockwise seen from the front.

    Attributes:
        positions: (V, 3) in metres.
        normals: (V, 3) unit.
        uv: (V, 2) in metres along the surface; the builder divides by the texture's size.
        indices: (T, 3).
    """

    positions: Array
    normals: Array
    uv: Array
    indices: NDArray[np.uint32]

    @property
    def n_triangles(self) -> int:
        """Number of triangles."""
        return len(self.indices)

    def moved(self, x: float = 0.0, y: float = 0.0, z: float = 0.0) -> Mesh:
        """Shifted copy."""
        return replace(self, positions=self.positions + np.array([x, y, z]))

    def transformed(self, target_from_object: ArrayLike) -> Mesh:
        """Copy under a (4, 4) or (3, 3) matrix; mirroring turns the winding so that fronts stay fronts."""
        matrix = np.asarray(target_from_object, np.float64)
        linear = matrix[:3, :3]
        offset = matrix[:3, 3] if matrix.shape == (4, 4) else np.zeros(3)
        normals = self.normals @ np.linalg.inv(linear)
        mirrored = np.linalg.det(linear) < 0
        return Mesh(
            self.positions @ linear.T + offset,
            _normalized(normals),
            self.uv,
            self.indices[:, ::-1] if mirrored else self.indices,
        )

    def turned(self, yaw_deg: float) -> Mesh:
        """Copy rotated about +Y, counter-clockwise seen from above."""
        return self.transformed(rotation_y(yaw_deg))

    def inside_out(self) -> Mesh:
        """Copy whose fronts are the old backs."""
        return replace(self, normals=-self.normals, indices=self.indices[:, ::-1])

    def only(self, triangles: NDArray[np.bool_]) -> Mesh:
        """Copy with the chosen triangles, (T,), and the vertices that they use."""
        used, compact = np.unique(self.indices[triangles], return_inverse=True)
        return Mesh(
            self.positions[used],
            self.normals[used],
            self.uv[used],
            compact.reshape(-1, 3).astype(np.uint32),
        )

    def uv_moved(self, u: float, v: float) -> Mesh:
        """Copy with shifted texture coordinates (metres), so that neighbours don't repeat a pattern."""
        return replace(self, uv=self.uv + np.array([u, v]))


def join(*meshes: Mesh) -> Mesh:
    """One mesh with the triangles of all, vertices kept apart."""
    first = np.cumsum([0, *(len(m.positions) for m in meshes)])
    return Mesh(
        np.concatenate([m.positions for m in meshes]),
        np.concatenate([m.normals for m in meshes]),
        np.concatenate([m.uv for m in meshes]),
        np.concatenate([m.indices + np.uint32(f) for m, f in zip(meshes, first, strict=False)]),
    )


def grid_indices(n_rows: int, n_columns: int) -> NDArray[np.uint32]:
    """Triangles over (n_rows + 1) × (n_columns + 1) vertices in row order; front where row × column."""
    row, column = np.meshgrid(np.arange(n_rows), np.arange(n_columns), indexing="ij")
    corner = (row * (n_columns + 1) + column).ravel()
    right, down = corner + 1, corner + n_columns + 1
    lower = np.stack([corner, down, down + 1], axis=1)
    upper = np.stack([corner, down + 1, right], axis=1)
    return np.stack([lower, upper], axis=1).reshape(-1, 3).astype(np.uint32)


def grid(positions: ArrayLike, normals: ArrayLike, uv: ArrayLike) -> Mesh:
    """A mesh from (R, C, 3), (R, C, 3) and (R, C, 2); front where (along rows) × (along columns) points."""
    points = np.asarray(positions, np.float64)
    n_rows, n_columns = points.shape[0] - 1, points.shape[1] - 1
    return Mesh(
        points.reshape(-1, 3),
        _normalized(np.asarray(normals, np.float64).reshape(-1, 3)),
        np.asarray(uv, np.float64).reshape(-1, 2),
        grid_indices(n_rows, n_columns),
    )


def drop_degenerate(mesh: Mesh, smallest_area_m2: float = 1e-12) -> Mesh:
    """Copy without zero-area triangles (poles of a surface of revolution) and unused vertices."""
    a, b, c = (mesh.positions[mesh.indices[:, k]] for k in range(3))
    area = 0.5 * np.linalg.norm(np.cross(b - a, c - a), axis=1)
    return mesh.only(area > smallest_area_m2)


def rotation_y(yaw_deg: float) -> Array:
    """(3, 3) rotation about +Y that takes +Z toward +X."""
    cos, sin = np.cos(np.radians(yaw_deg)), np.sin(np.radians(yaw_deg))
    return np.array([[cos, 0.0, sin], [0.0, 1.0, 0.0], [-sin, 0.0, cos]])


def look_at(eye: ArrayLike, target: ArrayLike, up: ArrayLike = (0.0, 1.0, 0.0)) -> Array:
    """(4, 4) world_from_camera of a camera (or light) at ``eye`` whose −Z points at ``target``."""
    eye = np.asarray(eye, np.float64)
    backward = eye - np.asarray(target, np.float64)
    backward /= np.linalg.norm(backward)
    right = np.cross(np.asarray(up, np.float64), backward)
    right /= np.linalg.norm(right)
    matrix = np.eye(4)
    matrix[:3, 0], matrix[:3, 1], matrix[:3, 2] = right, np.cross(backward, right), backward
    matrix[:3, 3] = eye
    return matrix


def _normalized(vectors: Array) -> Array:
    return vectors / np.maximum(np.linalg.norm(vectors, axis=-1, keepdims=True), 1e-20)
