"""Meshes that exist only on a lightmap page, for tests of what happens there."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from numpy.typing import NDArray

from irradia.scene.layout import LightmapLayout
from irradia.scene.merge import MergedMesh


def _page_mesh(
    corners_px: NDArray, size_px: int, *, chart: NDArray | None = None, n_pages: int = 1, page: int = 0
) -> tuple[MergedMesh, LightmapLayout]:
    """Triangles (T, 3, 2) given in texels of a square page; nothing is shared between them."""
    corners = np.asarray(corners_px, np.float64).reshape(-1, 3, 2)
    n = len(corners)
    vertices = np.zeros((3 * n, 3), np.float32)
    vertices[:, :2] = corners.reshape(-1, 2)
    mesh = MergedMesh(
        positions=vertices,
        normals=np.tile(np.float32([0, 0, 1]), (3 * n, 1)),
        texcoords=np.zeros((3 * n, 2, 2), np.float32),
        colors=np.ones((3 * n, 4), np.float32),
        lightmap_uv=(corners.reshape(-1, 2) / size_px).astype(np.float32),
        indices=np.arange(3 * n, dtype=np.uint32).reshape(n, 3),
        material=np.zeros(n, np.uint32),
        instance=np.zeros(n, np.uint32),
        page=np.full(n, page, np.int32),
        chart=np.zeros(n, np.uint32) if chart is None else np.asarray(chart, np.uint32),
    )
    layout = LightmapLayout(
        n_pages=n_pages,
        width_px=size_px,
        height_px=size_px,
        unwraps=(),
        page=np.full(1, page, np.int32),
        scale=np.ones((1, 2), np.float32),
        offset=np.zeros((1, 2), np.float32),
        texels_per_metre=1.0,
    )
    return mesh, layout


@pytest.fixture
def page_mesh() -> Callable[..., tuple[MergedMesh, LightmapLayout]]:
    """Builds a mesh and layout from triangles given in texels of a page."""
    return _page_mesh
