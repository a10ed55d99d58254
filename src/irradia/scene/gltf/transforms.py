"""Matrices from glTF's translations, rotations and scales."""

from __future__ import annotations

import numpy as np

from irradia.scene.types import F64


def rotation_matrix(quaternions: F64) -> F64:
    """(…, 3, 3) from (…, 4) quaternions x, y, z, w; they need not be unit, 0 turns nothing."""
    length = np.linalg.norm(quaternions, axis=-1, keepdims=True)
    x, y, z, w = np.moveaxis(
        np.where(length > 0, quaternions / np.where(length > 0, length, 1), _NO_TURN), -1, 0
    )
    rows = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
        [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
        [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
    ]
    return np.stack([np.stack(row, axis=-1) for row in rows], axis=-2)


def trs_matrix(translation: F64, rotation: F64, scale: F64) -> F64:
    """(…, 4, 4) that scales, then rotates, then translates (…, 3), (…, 4), (…, 3)."""
    matrix = np.zeros((*translation.shape[:-1], 4, 4))
    matrix[..., :3, :3] = rotation_matrix(rotation) * scale[..., None, :]
    matrix[..., :3, 3] = translation
    matrix[..., 3, 3] = 1.0
    return matrix


_NO_TURN = np.array([0.0, 0.0, 0.0, 1.0])
