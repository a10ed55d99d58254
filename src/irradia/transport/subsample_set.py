"""The sub-samples of a lightmap's texels as they are handed over: 2 bytes each, and a list of triangles.

A sub-sample's barycentrics follow from its place on the page and its triangle, so only those are kept:
the place in 64ths of the texel, and which of the texel's few triangles. Eight of them with a triangle
number and two float weights each took 96 bytes a texel; this takes about 26, and nothing is rounded:
sub-samples that fill a texel stand on odd 16ths.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from irradia.scene.types import F64, U32

SUBSAMPLES = 8  # of each texel
STEPS = 64  # places along a texel's edge
CODE_BITS = 16  # of one sub-sample: 6 of x, 6 of y, 3 of the triangle; two stand in a word
Y_SHIFT, TRIANGLE_SHIFT = 6, 12
PLACE_MASK, TRIANGLE_MASK = STEPS - 1, SUBSAMPLES - 1


@dataclass(frozen=True)
class SubsampleSet:
    """Where on the mesh each texel is sampled.

    Attributes:
        code: (SUBSAMPLES / 2, N) two sub-samples a word, the even one in the low half: x and y in
            the texel in 64ths (6 bits each), and which of the texel's triangles (3 bits).
        first: (N,) where a texel's triangles begin in ``triangle``.
        triangle: (M,) triangles of the merged mesh, those of one texel in a row.
    """

    code: U32
    first: U32
    triangle: U32

    @staticmethod
    def none() -> SubsampleSet:
        """No texels."""
        nothing = np.empty(0, np.uint32)
        return SubsampleSet(np.empty((SUBSAMPLES // 2, 0), np.uint32), nothing, nothing)

    def take(self, texels: NDArray[np.integer]) -> SubsampleSet:
        """Those of some texels only."""
        return SubsampleSet(np.ascontiguousarray(self.code[:, texels]), self.first[texels], self.triangle)

    def unpack(self) -> tuple[U32, F64]:
        """Triangles (N, SUBSAMPLES), and places (N, SUBSAMPLES, 2) in the texel, in [0, 1)."""
        halves = np.stack([self.code & 0xFFFF, self.code >> CODE_BITS], axis=1)
        code = halves.reshape(SUBSAMPLES, -1).T
        place = np.stack([code & PLACE_MASK, (code >> Y_SHIFT) & PLACE_MASK], axis=-1) / STEPS
        which = (code >> TRIANGLE_SHIFT) & TRIANGLE_MASK
        return self.triangle[self.first[:, None] + which], place


def weights_at(point: F64, corners: F64) -> F64:
    """Barycentric weights (…, 3) of the points (…, 2) of triangles (…, 3, 2) that are nearest to them.

    The triangles may have no area; a point counts as inside only if all its weights say so.
    """
    edge = corners[..., 1:, :] - corners[..., :1, :]
    away = point - corners[..., 0, :]
    with np.errstate(divide="ignore", invalid="ignore"):
        area = _cross(edge[..., 0, :], edge[..., 1, :])
        second, third = _cross(away, edge[..., 1, :]) / area, _cross(edge[..., 0, :], away) / area
        weights = np.stack([1.0 - second - third, second, third], axis=-1)
    inside = (weights >= 0.0).all(axis=-1)  # never of a triangle without area: it gives NaN or infinity
    return np.where(inside[..., None], weights, _on_outline(point, corners))


def _cross(a: F64, b: F64) -> F64:
    return a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]


def _on_outline(point: F64, corners: F64) -> F64:
    """Weights of the outline's point nearest to ``point``; the first edge wins a draw."""
    best = np.full(point.shape[:-1], np.inf)
    weights = np.zeros((*point.shape[:-1], 3))
    for i in range(3):
        j = (i + 1) % 3
        along, away = corners[..., j, :] - corners[..., i, :], point - corners[..., i, :]
        length2 = (along**2).sum(axis=-1)
        t = np.clip((along * away).sum(axis=-1) / np.where(length2 > 0.0, length2, 1.0), 0.0, 1.0)
        distance2 = ((away - t[..., None] * along) ** 2).sum(axis=-1)
        nearer = distance2 < best
        best = np.where(nearer, distance2, best)
        here = np.zeros_like(weights)
        here[..., i], here[..., j] = 1.0 - t, t
        weights = np.where(nearer[..., None], here, weights)
    return weights
