"""Which texel sees which triangle: the lightmapped triangles drawn conservatively on their pages."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from irradia.bake.texels import TexelSet
from irradia.scene.layout import LightmapLayout
from irradia.scene.merge import MergedMesh


def rasterise(mesh: MergedMesh, layout: LightmapLayout) -> TexelSet:
    """Lists every texel that a lightmapped triangle touches, with eight sub-samples each.

    A texel is touched when its open square and the triangle's interior meet; a triangle without area on
    the page touches the half-open squares that hold a point of it. No chart's light is mixed into
    another's: where two meet in one texel, the one with more sub-samples has it. Among triangles of a
    chart that overlap, the lowest number wins. The same input gives the same bytes.

    Args:
        mesh: The merged mesh; triangles with page −1 are left out.
        layout: For the shape of the pages.
    """
    from irradia.bake import raster_kernels as kernels

    width, height = layout.width_px, layout.height_px
    drawn = np.flatnonzero(mesh.page >= 0)
    fixed, swapped = _fixed_point(mesh, drawn, width, height)
    page = mesh.page[drawn]

    nowhere = np.zeros(len(drawn), np.int64)
    counts = kernels.touched_texels(fixed, page, width, height, nowhere, np.empty(0, np.int64))
    offsets = np.cumsum(counts) - counts
    pixels = np.empty(int(counts.sum()), np.int64)
    kernels.touched_texels(fixed, page, width, height, offsets, pixels)
    fragment_triangle = np.repeat(np.arange(len(drawn), dtype=np.uint32), counts)
    covered, starts, fragments = kernels.group_by_texel(
        pixels, fragment_triangle, layout.n_pages * height * width
    )
    triangle, barycentric, coverage, chart = kernels.resolve(
        fixed, swapped, mesh.chart[drawn], covered, starts, fragments, width, height
    )
    # In place: at 4096 × 4096 texels this array alone takes half a gigabyte.
    np.take(drawn.astype(np.uint32), triangle, out=triangle, mode="clip")
    return TexelSet(
        n_pages=layout.n_pages,
        height_px=height,
        width_px=width,
        pixel=covered,
        triangle=triangle,
        barycentric=barycentric,
        coverage=coverage,
        chart=chart,
    )


def warm_up() -> None:
    """Compiles the kernels, or loads them from Numba's cache, on a single triangle."""
    from irradia.bake import raster_kernels as kernels

    fixed = np.array([[[0, 0], [kernels.ONE, 0], [0, kernels.ONE]]], np.int64)
    page = np.zeros(1, np.int32)
    pixels = np.zeros(1, np.int64)
    kernels.touched_texels(fixed, page, 1, 1, np.zeros(1, np.int64), pixels)
    grouped = kernels.group_by_texel(pixels, np.zeros(1, np.uint32), 1)
    kernels.resolve(fixed, np.zeros(1, np.bool_), np.zeros(1, np.uint32), *grouped, 1, 1)


def _fixed_point(
    mesh: MergedMesh, drawn: NDArray[np.int64], width: int, height: int
) -> tuple[NDArray[np.int64], NDArray[np.bool_]]:
    """Triangles in page texels, snapped and wound to have no negative area; which were turned round."""
    from irradia.bake.raster_kernels import ONE

    size = np.array([width, height], np.float64) * ONE
    corners = np.rint(np.clip(mesh.lightmap_uv.astype(np.float64), 0.0, 1.0) * size).astype(np.int64)
    fixed = corners[mesh.indices[drawn]]
    first, second = fixed[:, 1] - fixed[:, 0], fixed[:, 2] - fixed[:, 0]
    swapped = first[:, 0] * second[:, 1] - first[:, 1] * second[:, 0] < 0
    fixed[swapped] = fixed[swapped][:, [0, 2, 1]]
    return np.ascontiguousarray(fixed), swapped
