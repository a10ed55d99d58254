"""Unit normals: the file's, or flat ones where it has none."""

from __future__ import annotations

import numpy as np

from irradia.scene.types import F32, F64, U32


def face_normals(positions: F32, indices: U32) -> F64:
    """(T, 3) cross products of the edges: the direction of the front, twice the area long."""
    a, b, c = (positions[indices[:, corner]].astype(np.float64) for corner in range(3))
    return np.cross(b - a, c - a)


def flat_normals(positions: F32, indices: U32) -> F32:
    """(3T, 3) unit normals for vertices that are split, three to each triangle."""
    return np.repeat(unit(face_normals(positions, indices)), 3, axis=0)


def mend_normals(normals: F32, positions: F32, indices: U32) -> F32:
    """Unit normals; those of length 0 become the area-weighted mean of the faces around."""
    length = np.linalg.norm(normals, axis=1)
    broken = length <= 1e-12
    if not broken.any():
        return (normals / length[:, None]).astype(np.float32)
    summed = np.zeros((len(positions), 3))
    np.add.at(summed, indices.ravel(), np.repeat(face_normals(positions, indices), 3, axis=0))
    return unit(np.where(broken[:, None], summed, normals))


def unit(vectors: F32 | F64) -> F32:
    """Vectors of length 1; +Y where there is no direction."""
    vectors = vectors.astype(np.float64)
    length = np.linalg.norm(vectors, axis=1, keepdims=True)
    return np.where(length > 0, vectors / np.where(length > 0, length, 1), (0.0, 1.0, 0.0)).astype(np.float32)
