"""Places islands on a page without turning them, in whole texels: xatlas's packer."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from irradia.scene.lightmap_uv.atlas import new_atlas
from irradia.scene.lightmap_uv.charts import triangle_areas
from irradia.scene.types import F32, F64, U32

# Islands that are narrow, or nearly rectangles, are packed as the rectangles that hold them: these lie
# on whole texels exactly, while the packer gives other shapes half a texel more on each side.
_NARROW_PX = 5.0
_BOXY_SHARE = 0.9  # of the rectangle that the island covers
_TINY_PX2 = 1e-3  # xatlas would drop islands of which no triangle is larger
_ROUND_DOWN_PX = 0.2  # sizes are rounded up to whole texels, but not for so little
INSET_PX = 1 / 64  # keeps rounding from touching the next texel
_UNASSIGNED = 0xFFFFFFFF


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

    Islands are stretched to whole texels. Rectangles fill theirs from border to border; other shapes
    have their outermost points on texel centres.
    """

    scale: F64
    offset: F64

    def apply(self, uv: NDArray, island: NDArray[np.int64]) -> F64:
        """Page position in texels of points (V, 2) on their islands (V,)."""
        return uv * self.scale[island] + self.offset[island]


def rectangle(width_px: int, height_px: int) -> Islands:
    """An island that will have exactly that many texels."""
    w, h = width_px, height_px
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
    # xatlas takes a mesh at an address that it knows for a copy of that one: keep all of them alive.
    packed = [_Packable.of(group) for group in groups]
    with new_atlas() as atlas:
        for one in packed:
            atlas.add_uv_mesh(one.uv, one.indices, one.island.reshape(-1, 1))
        atlas.generate(xatlas.ChartOptions(), options)
        size = np.array([atlas.width, atlas.height], np.float64)
        placements = []
        for number, one in enumerate(packed):
            _, indices, uv = atlas.get_mesh(number)
            _, chart = atlas.get_mesh_vertex_assignment(number)
            kept = (chart[indices] != _UNASSIGNED).all(axis=1)
            placements.append(one.placement(uv[indices] * size, kept))
        return int(atlas.width), int(atlas.height), placements


@dataclass(frozen=True)
class _Packable:
    """Islands as the packer gets them.

    Attributes:
        uv, indices, island: See :class:`Islands`.
        boxed: (C,) which islands are replaced by rectangles.
        size_px: (C, 2) whole texels of those.
        low, high: (C, 2) bounds of the true islands.
    """

    uv: F32
    indices: U32
    island: U32
    boxed: NDArray[np.bool_]
    size_px: F64
    low: F64
    high: F64

    @classmethod
    def of(cls, group: Islands) -> _Packable:
        """Replaces islands by rectangles where that packs better, or at all."""
        low, high = _bounds(group.island, group.uv[group.indices].astype(np.float64))
        extent = high - low
        areas = triangle_areas(group.uv, group.indices)
        largest = np.zeros(len(low))
        np.maximum.at(largest, group.island, areas)
        covered = np.bincount(group.island, areas, len(low)) / np.maximum(extent.prod(axis=1), 1e-30)
        boxed = (extent.min(axis=1) < _NARROW_PX) | (covered > _BOXY_SHARE) | (largest < _TINY_PX2)

        size_px = np.maximum(np.ceil(extent - _ROUND_DOWN_PX), 1.0)
        # The packer rounds extents up to whole texels and adds one: a hair less gives what we want.
        asked = np.maximum(size_px - 1.01, 0.5)[boxed]
        squares = low[boxed, None] + asked[:, None] * np.array([[0, 0], [1, 0], [1, 1], [0, 1]])
        number = np.flatnonzero(boxed)
        quads = np.array([[0, 1, 2], [0, 2, 3]]) + 4 * np.arange(len(number))[:, None, None] + len(group.uv)
        stays = ~boxed[group.island]
        return cls(
            uv=np.concatenate([group.uv, squares.reshape(-1, 2)]).astype(np.float32),
            indices=np.concatenate([group.indices[stays], quads.reshape(-1, 3)]).astype(np.uint32),
            island=np.concatenate([group.island[stays], np.repeat(number, 2)]).astype(np.uint32),
            boxed=boxed,
            size_px=size_px,
            low=low,
            high=high,
        )

    def placement(self, placed: F64, kept: NDArray[np.bool_]) -> Placement:
        """Compares bounds before and after packing.

        Args:
            placed: (T, 3, 2) where the triangles went.
            kept: (T,) which of them the packer took into account.
        """
        boxed = self.boxed[:, None]
        low, high = _bounds(self.island[kept], self.uv[self.indices[kept]].astype(np.float64))
        low, high = np.where(boxed, self.low, low), np.where(boxed, self.high, high)
        new_low, new_high = _bounds(self.island[kept], placed[kept])
        first = np.rint(new_low - 0.5)
        new_low = np.where(boxed, first + INSET_PX, new_low)
        new_high = np.where(boxed, first + self.size_px - INSET_PX, new_high)
        scale = (new_high - new_low) / np.maximum(high - low, 1e-30)
        return Placement(scale=scale, offset=new_low - low * scale)


def _bounds(island: U32, corners: F64) -> tuple[F64, F64]:
    """Lowest and highest corner of each island (C, 2) of triangles (T, 3, 2)."""
    order = np.argsort(island, kind="stable")
    first = np.searchsorted(island[order], np.arange(int(island.max()) + 1))
    low = np.minimum.reduceat(corners.min(axis=1)[order], first)
    return low, np.maximum.reduceat(corners.max(axis=1)[order], first)
