"""Points spread evenly over a scene's surfaces: enough to frame it and to estimate its light."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from irradia.scene.merge import MergedMesh
from irradia.scene.types import F64


@dataclass(frozen=True)
class SurfaceSamples:
    """Points with equal shares of the area.

    Attributes:
        positions: (N, 3) metres.
        normals: (N, 3) unit geometric normals of the front.
    """

    positions: F64
    normals: F64


def triangle_areas(mesh: MergedMesh) -> F64:
    """(T,) square metres."""
    return 0.5 * np.linalg.norm(_doubled_area_normals(mesh), axis=1)


def sample_surface(mesh: MergedMesh, n_samples: int) -> SurfaceSamples:
    """Spreads points over all triangles by area; the same mesh gives the same points.

    One point per equal stretch of the running area, and a golden-ratio sequence inside triangles.
    A mesh without area gives no points.
    """
    doubled = _doubled_area_normals(mesh)
    areas = 0.5 * np.linalg.norm(doubled, axis=1)
    running = np.cumsum(areas)
    if len(running) == 0 or running[-1] <= 0.0:
        return SurfaceSamples(np.zeros((0, 3)), np.zeros((0, 3)))
    index = np.arange(n_samples)
    # A triangle without area owns no stretch, so it can't be chosen.
    chosen = np.searchsorted(running, (index + 0.5) / n_samples * running[-1], side="right")
    chosen = np.minimum(chosen, np.flatnonzero(areas)[-1])
    root = np.sqrt((0.5 + index * 0.7548776662466927) % 1.0)
    across = (0.5 + index * 0.5698402909980532) % 1.0
    weights = np.stack([1.0 - root, root * (1.0 - across), root * across], axis=1)
    corners = mesh.positions[mesh.indices[chosen]].astype(np.float64)
    return SurfaceSamples(
        np.einsum("nk,nkc->nc", weights, corners), doubled[chosen] / (2.0 * areas[chosen, None])
    )


def _doubled_area_normals(mesh: MergedMesh) -> F64:
    """(T, 3) geometric normals as long as twice the area."""
    a, b, c = (mesh.positions[mesh.indices[:, k]].astype(np.float64) for k in range(3))
    return np.cross(b - a, c - a)
