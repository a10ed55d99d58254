"""Triangles from strips and fans, without those that have no area."""

from __future__ import annotations

import numpy as np

from irradia.core.errors import InputError
from irradia.scene.gltf.stored import TRIANGLES, StoredPrimitive
from irradia.scene.types import F32, U32

_TRIANGLE_STRIP, _TRIANGLE_FAN = 5, 6
_MODE_NAMES = {0: "points", 1: "lines", 2: "line loops", 3: "line strips"}

MIN_SLENDERNESS = 1e-6
"""Triangles whose height is at most this share of their longest edge count as without area."""


def foreign_topology(mode: int) -> str | None:
    """What a primitive of this mode draws, if not triangles."""
    return _MODE_NAMES.get(mode)


def unroll_triangles(stored: StoredPrimitive) -> U32:
    """(T, 3) indices of a primitive of triangles, a strip or a fan; incomplete triangles are left out.

    Raises:
        InputError: An index points past the vertices, or the mode doesn't exist.
    """
    indices = stored.indices
    if indices is None:
        indices = np.arange(stored.n_vertices, dtype=np.uint32)
    if len(indices) and int(indices.max()) >= stored.n_vertices:
        raise InputError(
            f"expected indices below {stored.n_vertices}, found {int(indices.max())}",
            where=f"{stored.pointer}/indices",
        )
    n_corners = len(indices)
    if stored.mode == TRIANGLES:
        return indices[: n_corners // 3 * 3].reshape(-1, 3)
    first = np.arange(max(n_corners - 2, 0))
    if stored.mode == _TRIANGLE_STRIP:
        odd = first % 2  # every second triangle swaps two corners to keep its winding
        return indices[np.column_stack([first, first + 1 + odd, first + 2 - odd])]
    if stored.mode == _TRIANGLE_FAN:
        return indices[np.column_stack([first + 1, first + 2, np.zeros_like(first)])]
    raise InputError(f"expected a mode from 0 to 6, found {stored.mode}", where=f"{stored.pointer}/mode")


def with_area(positions: F32, indices: U32) -> U32:
    """The triangles that cover something.

    A triangle goes if two of its corners are one vertex, or if it is so slender (see
    :data:`MIN_SLENDERNESS`) that float32 positions don't tell it from a line.
    """
    corners = positions[indices].astype(np.float64)
    edges = corners[:, [1, 2, 0]] - corners
    longest_squared = (edges**2).sum(axis=2).max(axis=1, initial=0.0)
    doubled_area = np.linalg.norm(np.cross(edges[:, 0], edges[:, 1]), axis=1)
    return indices[doubled_area > MIN_SLENDERNESS * longest_squared]
