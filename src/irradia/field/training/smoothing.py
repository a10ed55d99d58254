"""Less noise in samples, at the cost of detail: values become means over their nearest neighbours."""

from __future__ import annotations

from collections.abc import Generator

import numpy as np

from irradia.field.backend import F32
from irradia.field.training.events import Working

_CHUNK_ROWS = 1 << 15


def smoothed(
    positions: F32, normals: F32 | None, values: F32, k: int, normal_threshold: float
) -> Generator[Working, None, F32]:
    """Means over the k nearest samples, among them the sample itself.

    Neighbours whose normal is too different don't count, so that the two sides of a wall and the two
    faces of an edge stay apart.

    Args:
        positions: (N, 3) metres.
        normals: (N, 3) unit; None where values don't depend on one.
        values: (N, C).
        k: At least 1.
        normal_threshold: Neighbours count where the cosine between normals is above this.

    Yields:
        Progress.

    Returns:
        (N, C).
    """
    from scipy.spatial import KDTree

    n = len(positions)
    yield Working("Smooth samples", 0, n, "rows")
    tree = KDTree(positions)
    result = np.empty_like(values)
    for first in range(0, n, _CHUNK_ROWS):
        chunk = slice(first, min(first + _CHUNK_ROWS, n))
        nearest = np.reshape(tree.query(positions[chunk], min(k, n), workers=-1)[1], (-1, min(k, n)))
        weight = np.ones(nearest.shape, np.float32)
        if normals is not None:
            cosine = np.einsum("ik,ijk->ij", normals[chunk], normals[nearest])
            weight[cosine <= normal_threshold] = 0.0
        # Coincident samples may crowd a row out of its own neighbours; then it stays as it is.
        total = weight.sum(axis=1, keepdims=True)
        mean = np.einsum("ij,ijc->ic", weight, values[nearest]) / np.maximum(total, 1.0)
        result[chunk] = np.where(total > 0.0, mean, values[chunk])
        yield Working("Smooth samples", chunk.stop, n, "rows")
    return result
