"""Closes seams: makes filtered light agree on both sides of every cut in the lightmap.

For a point on a seam, bilinear filtering gives one value on each side. With x₀ the lightmap and
x = x₀ + σ y, σ the light's magnitude around each texel, the change y minimises

    Σ over points   w² · ((value on one side − value on the other) / (their magnitude))²
  + α Σ over neighbouring covered texels (yᵢ − yⱼ)²  +  β Σ over covered texels yᵢ²  +  γ Σ over others yᵢ²

so dark places count as much as bright ones. A difference between whole charts is spread over a few
texels instead of showing as a ramp of one; what differs from texel to texel is left to the uncovered
texels beside charts, which nobody sees by themselves, so that covered ones keep their detail. Based on
Iwanicki, "Lighting Technology of The Last of Us" (2013), which moves border texels alone and absolutely;
the smooth, relative change is ours.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from irradia.bake.seam_points import SeamPoints
from irradia.bake.texels import TexelSet
from irradia.scene.types import F32, U32

if TYPE_CHECKING:
    from scipy.sparse import csr_array

_SMOOTH, _STAY = 0.01, 0.001  # α and β; their ratio spreads a change over about three texels
_STAY_UNCOVERED = 0.0003  # γ
_RINGS = 4  # texels from the seam beyond which nothing changes
_TRUSTED_SHARE = 0.2  # of each side that must come from valid texels of its chart
_DARK = 0.01  # of the median magnitude: what counts as black
_ALIKE, _APART = 1 / 3, 0.6  # |a − b| / (a + b): up to here one surface, from here on a wall between
_TOLERANCE, _MOST_STEPS = 1e-4, 300


@dataclass(frozen=True)
class SeamSystem:
    """The equations of all seams of a lightmap: they serve every map that is laid out like it.

    Attributes:
        pixel: (n,) flat pixel of each texel that may change.
        scale: (n,) σ.
        footprint: (M, 8) flat pixels that filtering reads at each point, four on either side.
        weight: (M, 8) what it multiplies them with; the second side negative, the point's own weight in.
        jump_of_change: (M, n) J: how y changes the difference.
        matrix: (n, n) JᵀJ and the quadratic form of the change itself.
    """

    pixel: NDArray[np.int64]
    scale: F32
    footprint: U32
    weight: F32
    jump_of_change: csr_array
    matrix: csr_array


def seam_system(
    points: SeamPoints,
    texels: TexelSet,
    pages: F32,
    *,
    valid: NDArray[np.bool_] | None = None,
    region: U32 | None = None,
    relative: bool = True,
) -> SeamSystem:
    """Sets up the equations.

    Args:
        points: From :func:`find_seam_points`.
        texels: The covered texels.
        pages: (P, H, W, C) irradiance, linear, uncovered texels beside charts filled. Where its two
            sides differ by a factor of two, a point begins to count less, from four on not at all:
            something stands on the seam, and light must not pass under it.
        valid: (N,) texels whose light counts; the others are left as they are.
        region: (N,) finer than charts: a change spreads within one only.
        relative: Whether σ is the irradiance's magnitude, for maps in proportion to it, or 1.
    """
    from irradia.bake import seam_kernels as kernels

    valid = np.ones(len(texels.pixel), np.bool_) if valid is None else valid
    region = texels.chart if region is None else region
    texel_at = np.full(texels.n_pages * texels.height_px * texels.width_px, -1, np.int32)
    texel_at[texels.pixel] = np.arange(len(texels.pixel), dtype=np.int32)
    size = texels.width_px, texels.height_px

    # -- What filtering reads, and how much each point counts
    pixel, weight = kernels.footprints(points.page, points.position_px, *size)
    trust = kernels.side_trust(pixel, weight, points.chart, texel_at, texels.chart, valid)
    magnitude = _magnitude(pages, texels)
    alike, light = _compare_sides(magnitude[pixel], weight)
    row_weight = np.sqrt(points.weight) * alike / (light if relative else np.float32(1.0))
    kept = (trust >= _TRUSTED_SHARE) & (alike > 0)
    pixel, chart = pixel[kept], points.chart[kept]
    weight = (weight[kept] * row_weight[kept, None]).astype(np.float32)

    # -- Which texels may change, and what that does
    unknown, pixels, regions = kernels.choose_unknowns(
        pixel, weight, chart, texel_at, texels.chart, region, valid, *size, _RINGS
    )
    neighbour, degree = kernels.smoothness(unknown, pixels, regions, texel_at, region, valid, *size)
    scale = np.ones(len(pixels), np.float32)
    if relative:
        scale = _shared_scale(unknown[pixel], light[kept], neighbour, magnitude[pixels])
    jump_of_change = _jump_of_change(unknown[pixel], weight, scale)
    stay = np.where(texel_at[pixels] < 0, np.float32(_STAY_UNCOVERED), np.float32(_STAY))
    matrix = _normal_matrix(jump_of_change, neighbour, np.float32(_SMOOTH) * degree + stay)
    return SeamSystem(pixels, scale, pixel, weight, jump_of_change, matrix)


def close_seams(system: SeamSystem, pages: F32, *, lowest: float | None = 0.0) -> None:
    """Changes texels beside seams, in place, so that both sides agree.

    Args:
        system: From :func:`seam_system`; of the irradiance, also for maps that go with it.
        pages: (P, H, W, C), any number of channels, linear.
        lowest: No value gets below it; None for signed channels.
    """
    if len(system.pixel) == 0:
        return
    flat = pages.reshape(-1, pages.shape[-1])
    jump = np.zeros((len(system.weight), flat.shape[1]), np.float32)
    for k in range(system.footprint.shape[1]):
        jump += system.weight[:, k, None] * flat[system.footprint[:, k]]
    change = _conjugate_gradient(system.matrix, -(system.jump_of_change.T @ jump))
    closed = flat[system.pixel] + system.scale[:, None] * change
    flat[system.pixel] = closed if lowest is None else np.maximum(closed, np.float32(lowest))


def _magnitude(pages: F32, texels: TexelSet) -> F32:
    """(pages · H · W,) mean over channels, with a little added so that black can be divided by."""
    magnitude = np.abs(pages).mean(axis=-1, dtype=np.float32).ravel()
    lit = magnitude[texels.pixel]
    lit = lit[lit > 0]
    return magnitude + np.float32(_DARK * np.median(lit) if len(lit) else 1.0)


def _compare_sides(magnitude: F32, weight: F32) -> tuple[F32, F32]:
    """(M,) how alike a point's two sides are, from 0 to 1, and the mean of their magnitudes."""
    one = np.einsum("mk,mk->m", magnitude[:, :4], weight[:, :4])
    other = -np.einsum("mk,mk->m", magnitude[:, 4:], weight[:, 4:])
    apart = np.abs(one - other) / (one + other)
    return np.clip((_APART - apart) / (_APART - _ALIKE), 0.0, 1.0), 0.5 * (one + other)


def _shared_scale(column: NDArray[np.int32], light: F32, neighbour: NDArray[np.int32], own: F32) -> F32:
    """(n,) σ: the mean light of both sides of the seams that a texel is read at, or is near.

    Were it the texel's own light, the brighter side of every pair would give way more, and closing
    seams would darken the map: by 4 % where charts are as many and small as an ornate hall's.
    """
    read = column >= 0
    at, value = column[read], np.broadcast_to(light[:, None], column.shape)[read]
    total = np.bincount(at, value, minlength=len(own))
    count = np.bincount(at, minlength=len(own)).astype(np.float64)
    for _ in range(_RINGS):
        beside, there = np.maximum(neighbour, 0), (neighbour >= 0) & (count[neighbour] > 0)
        mean = total / np.maximum(count, 1.0)
        spread, n = (np.where(there, mean[beside], 0.0)).sum(axis=1), there.sum(axis=1)
        reached = (count == 0) & (n > 0)
        total[reached], count[reached] = spread[reached] / n[reached], 1.0
    return np.where(count > 0, total / np.maximum(count, 1.0), own).astype(np.float32)


def _jump_of_change(column: NDArray[np.int32], weight: F32, scale: F32) -> csr_array:
    """(M, n) from the unknown that each footprint entry is (M, 8), −1 for what stays."""
    from scipy.sparse import csr_array

    changes = column >= 0
    column = np.where(changes, column, 0)
    entries = np.where(changes, weight * scale[column], np.float32(0.0)).ravel()
    starts = np.arange(0, column.size + 1, column.shape[1], dtype=np.int32)
    return csr_array((entries, column.ravel(), starts), shape=(len(column), len(scale)))


def _normal_matrix(jump: csr_array, neighbour: NDArray[np.int32], diagonal: F32) -> csr_array:
    """JᵀJ, plus −α for each pair of neighbours and the given diagonal."""
    from scipy.sparse import csr_array, diags_array

    row, direction = np.nonzero(neighbour >= 0)
    couplings = csr_array(
        (np.full(len(row), -_SMOOTH, np.float32), (row, neighbour[row, direction])),
        shape=(len(diagonal), len(diagonal)),
    )
    return (jump.T @ jump + couplings + diags_array(diagonal)).tocsr()


def _conjugate_gradient(matrix: csr_array, right: F32) -> F32:
    """Solves for all channels (n, C) at once, preconditioned by the diagonal.

    Sums run in NumPy's fixed order, not BLAS's, so that the bits don't depend on the number of threads.
    """
    to_unit = np.float32(1.0) / np.asarray(matrix.diagonal(), np.float32)[:, None]
    change = np.zeros_like(right)
    residual = right.copy()
    direction = to_unit * residual
    energy = _dot(residual, direction)
    enough = energy * _TOLERANCE**2
    for _ in range(_MOST_STEPS):
        if (energy <= enough).all():
            break
        image = matrix @ direction
        step = energy / np.maximum(_dot(direction, image), 1e-30)
        change += (step * direction).astype(np.float32)
        residual -= (step * image).astype(np.float32)
        preconditioned = to_unit * residual
        last, energy = energy, _dot(residual, preconditioned)
        direction = preconditioned + (energy / np.maximum(last, 1e-30)).astype(np.float32) * direction
    return change


def _dot(a: F32, b: F32) -> NDArray[np.float64]:
    """(C,) sums over rows."""
    return (a * b).sum(axis=0, dtype=np.float64)
