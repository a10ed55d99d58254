"""Places islands on a page without turning them, in whole texels: xatlas's packer."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from irradia.scene.types import F32, F64, U32


@dataclass(frozen=True)
class Islands:
    """Flat shapes to place: triangles over uv in texels, numbered by the island they belong to.

    Attributes:
        uv: (V, 2) texels.
        indices: (T, 3), each with an area.
        island: (T,) from 0 without gaps.
    """

    uv: F32
    indices: U32
    island: U32


@dataclass(frozen=True)
class Placement:
    """Where the islands went: position = uv · scale + offset, in texels of the page, per island (C, 2).

    Islands are stretched to whole texels and their outermost points lie on texel centres. So texels
    at the borders of surfaces that join hold light of the same points, and filtering at a border
    needs no texel outside.
    """

    scale: F64
    offset: F64

    def apply(self, uv: NDArray, island: NDArray[np.int64]) -> F64:
        """Page position in texels of points (V, 2) on their islands (V,)."""
        return uv * self.scale[island] + self.offset[island]


def rectangle(width_px: int, height_px: int) -> Islands:
    """An island that will lie on exactly that many texels; its outermost points are texel centres."""
    # A hair less, since the packer rounds up.
    w, h = max(width_px - 1.01, 0.5), max(height_px - 1.01, 0.5)
    return Islands(
        uv=np.array([[0, 0], [w, 0], [w, h], [0, h]], np.float32),
        indices=np.array([[0, 1, 2], [0, 2, 3]], np.uint32),
        island=np.zeros(2, np.uint32),
    )


def pack(groups: Sequence[Islands], padding_px: int) -> tuple[int, int, list[Placement]]:
    """Packs all islands of all groups as tightly as it can.

    Args:
        groups: Islands move freely, those of one group apart from each other too.
        padding_px: Free texels that stay between any two islands.

    Returns:
        Width and height that they take, and a placement for each group.
    """
    import xatlas

    options = xatlas.PackOptions()
    options.texels_per_unit = 1.0
    options.padding = (padding_px + 1) // 2  # xatlas leaves it round each of two neighbours
    options.bilinear = False
    options.rotate_charts = False
    options.rotate_charts_to_axis = False
    atlas = xatlas.Atlas()
    # xatlas takes a mesh at an address that it knows for a copy of that one: keep all of them alive.
    alive = [
        (
            np.ascontiguousarray(group.uv, np.float32),
            np.ascontiguousarray(group.indices, np.uint32),
            np.ascontiguousarray(group.island, np.uint32).reshape(-1, 1),
        )
        for group in groups
    ]
    for arrays in alive:
        atlas.add_uv_mesh(*arrays)
    atlas.generate(xatlas.ChartOptions(), options)
    size = np.array([atlas.width, atlas.height], np.float64)
    placements = []
    for number, group in enumerate(groups):
        _, indices, uv = atlas.get_mesh(number)
        placements.append(_placement(group, uv[indices] * size))
    return int(atlas.width), int(atlas.height), placements


def _placement(group: Islands, placed: F64) -> Placement:
    """Compares each island's bounds before and after; ``placed`` is (T, 3, 2)."""
    low, high = _bounds(group, group.uv[group.indices].astype(np.float64))
    new_low, new_high = _bounds(group, placed)
    scale = (new_high - new_low) / np.maximum(high - low, 1e-30)
    return Placement(scale=scale, offset=new_low - low * scale)


def _bounds(group: Islands, corners: F64) -> tuple[F64, F64]:
    """Lowest and highest corner of each island, (C, 2) each."""
    order = np.argsort(group.island, kind="stable")
    first = np.searchsorted(group.island[order], np.arange(int(group.island.max()) + 1))
    low = np.minimum.reduceat(corners.min(axis=1)[order], first)
    return low, np.maximum.reduceat(corners.max(axis=1)[order], first)
