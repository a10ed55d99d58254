"""Which texel sees which triangle: the lightmapped triangles drawn conservatively on their pages."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from irradia.bake.parallel import kernel_threads
from irradia.bake.texels import TexelSet
from irradia.core.errors import InputError
from irradia.scene.layout import LightmapLayout
from irradia.scene.merge import MergedMesh
from irradia.scene.types import U32
from irradia.transport.subsample_set import SubsampleSet

_MAX_FRAGMENTS = (1 << 32) - 1  # of triangles in texels: they are numbered in 32 bits


@kernel_threads()
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
    drawn = np.flatnonzero(mesh.page >= 0).astype(np.uint32)
    fixed, chart = _fixed_point(mesh, drawn, width, height), mesh.chart[drawn]
    covered, starts, fragments = _fragments(fixed, mesh.page[drawn], layout)
    code, n_used, coverage, owner = kernels.resolve(fixed, chart, covered, starts, fragments, width, height)
    first, triangle = kernels.gather_used(starts, n_used, fragments)
    seen = drawn[triangle]
    return TexelSet(
        n_pages=layout.n_pages,
        height_px=height,
        width_px=width,
        pixel=covered,
        triangle=seen[first],
        samples=SubsampleSet(code, first, seen),
        coverage=coverage,
        chart=owner,
    )


def _fragments(
    fixed: NDArray[np.int64], page: NDArray[np.int32], layout: LightmapLayout
) -> tuple[U32, NDArray[np.int64], U32]:
    """The covered texels, and the triangles that touch each; see :func:`raster_kernels.group_by_texel`."""
    from irradia.bake import raster_kernels as kernels

    width, height = layout.width_px, layout.height_px
    nowhere = np.zeros(len(fixed), np.int64)
    counts = kernels.touched_texels(fixed, page, width, height, nowhere, np.empty(0, np.uint32))
    total = int(counts.sum())
    if total > _MAX_FRAGMENTS:
        raise InputError(
            f"triangles touch {total:,} texels between them, at most {_MAX_FRAGMENTS:,} can be listed",
            fix="lower the resolution; a lightmap this deep in triangles is a uv set that overlaps itself",
        )
    pixels = np.empty(total, np.uint32)
    kernels.touched_texels(fixed, page, width, height, np.cumsum(counts) - counts, pixels)
    triangle = np.repeat(np.arange(len(fixed), dtype=np.uint32), counts)
    return kernels.group_by_texel(pixels, triangle, layout.n_pages * height * width)


@kernel_threads()
def warm_up() -> None:
    """Compiles the kernels, or loads them from Numba's cache, on a single triangle."""
    from irradia.bake import raster_kernels as kernels

    fixed = np.array([[[0, 0], [kernels.ONE, 0], [0, kernels.ONE]]], np.int64)
    page = np.zeros(1, np.int32)
    pixels = np.zeros(1, np.uint32)
    kernels.touched_texels(fixed, page, 1, 1, np.zeros(1, np.int64), pixels)
    covered, starts, fragments = kernels.group_by_texel(pixels, np.zeros(1, np.uint32), 1)
    _, n_used, _, _ = kernels.resolve(fixed, np.zeros(1, np.uint32), covered, starts, fragments, 1, 1)
    kernels.gather_used(starts, n_used, fragments)


def _fixed_point(mesh: MergedMesh, drawn: U32, width: int, height: int) -> NDArray[np.int64]:
    """Triangles in page texels, snapped and wound to have no negative area."""
    from irradia.bake.raster_kernels import ONE

    size = np.array([width, height], np.float64) * ONE
    corners = np.rint(np.clip(mesh.lightmap_uv.astype(np.float64), 0.0, 1.0) * size).astype(np.int64)
    fixed = corners[mesh.indices[drawn]]
    first, second = fixed[:, 1] - fixed[:, 0], fixed[:, 2] - fixed[:, 0]
    turned = first[:, 0] * second[:, 1] - first[:, 1] * second[:, 0] < 0
    fixed[turned] = fixed[turned][:, [0, 2, 1]]
    return np.ascontiguousarray(fixed)
