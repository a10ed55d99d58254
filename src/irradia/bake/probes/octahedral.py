"""The sphere on a square: where a probe keeps how far it sees in each direction.

The octahedral map (Cigolle et al. 2014, "A Survey of Efficient Representations for Independent Unit
Vectors"), with +Y at the square's centre because up is +Y here. Texel centres lie at +0.5, row 0 is
v = 0. Beyond an edge the map goes on mirrored about the edge's middle.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray


def octahedral_uv(directions: ArrayLike) -> NDArray[np.float64]:
    """Unit directions (…, 3) to uv in [0, 1], (…, 2): u along +X, v along +Z."""
    d = np.asarray(directions, np.float64)
    p = d / np.abs(d).sum(axis=-1, keepdims=True)
    plane, below = p[..., [0, 2]], p[..., 1:2] < 0.0
    folded = (1.0 - np.abs(plane[..., ::-1])) * np.where(plane >= 0.0, 1.0, -1.0)
    return 0.5 * np.where(below, folded, plane) + 0.5


def octahedral_directions(size: int) -> NDArray[np.float64]:
    """(size · size, 3) unit directions of the texel centres, row by row."""
    centre = (np.arange(size) + 0.5) / size * 2.0 - 1.0
    z, x = (axis.ravel() for axis in np.meshgrid(centre, centre, indexing="ij"))
    y = 1.0 - np.abs(x) - np.abs(z)
    below = y < 0.0
    folded_x = np.where(below, (1.0 - np.abs(z)) * np.where(x >= 0.0, 1.0, -1.0), x)
    folded_z = np.where(below, (1.0 - np.abs(x)) * np.where(z >= 0.0, 1.0, -1.0), z)
    d = np.stack([folded_x, y, folded_z], axis=-1)
    return d / np.linalg.norm(d, axis=-1, keepdims=True)


def bilinear_taps(uv: NDArray[np.float64], size: int) -> tuple[NDArray[np.intp], NDArray[np.float64]]:
    """Flat texel indices (…, 4) and weights (…, 4) that filter a map of size × size texels at ``uv``."""
    at = uv * size - 0.5
    base = np.floor(at).astype(np.intp)
    share = at - base
    taps, weights = [], []
    for dy in (0, 1):
        for dx in (0, 1):
            column, row = _wrap(base[..., 0] + dx, base[..., 1] + dy, size)
            taps.append(row * size + column)
            wx = share[..., 0] if dx else 1.0 - share[..., 0]
            wy = share[..., 1] if dy else 1.0 - share[..., 1]
            weights.append(wx * wy)
    return np.stack(taps, axis=-1), np.stack(weights, axis=-1)


def _wrap(
    column: NDArray[np.intp], row: NDArray[np.intp], size: int
) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Carries texels one step beyond an edge to where the octahedron continues."""
    outside = (column < 0) | (column >= size)
    row = np.where(outside, size - 1 - row, row)
    column = np.clip(column, 0, size - 1)
    outside = (row < 0) | (row >= size)
    column = np.where(outside, size - 1 - column, column)
    return column, np.clip(row, 0, size - 1)
