"""The sub-samples of a lightmap's texels, on the device."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from irradia.transport.backend import dr, mi
from irradia.transport.geometry import SurfacePoint
from irradia.transport.subsample_set import (
    CODE_BITS,
    PLACE_MASK,
    STEPS,
    SUBSAMPLES,
    TRIANGLE_MASK,
    TRIANGLE_SHIFT,
    Y_SHIFT,
    SubsampleSet,
)
from irradia.transport.world import World


class Subsamples:
    """For every texel, ``count`` places on triangles.

    Args:
        world: Knows where on the page its triangles lie.
        pixel: (N,) flat pixel of each texel, pages one after the other.
        samples: The places.
    """

    def __init__(self, world: World, pixel: NDArray[np.uint32], samples: SubsampleSet) -> None:
        self.n_texels, self.count = len(pixel), SUBSAMPLES
        self._world = world
        # What is written to is copied: on the CPU a device array made of a NumPy array is that array.
        self._pixel = mi.UInt32(pixel.copy())
        # Word by word, so that one sub-sample of neighbouring texels is read from neighbouring places.
        self._code = mi.UInt32(samples.code.flatten())
        self._first = mi.UInt32(samples.first.copy())
        self._triangle = mi.UInt32(samples.triangle)

    def fetch(self, texel: mi.UInt32, subsample: mi.UInt32) -> tuple[mi.UInt32, mi.Point2f]:
        """Triangle and barycentrics."""
        code = self._codes(texel, subsample)
        which = (code >> TRIANGLE_SHIFT) & TRIANGLE_MASK
        triangle = dr.gather(mi.UInt32, self._triangle, dr.gather(mi.UInt32, self._first, texel) + which)
        pixel = dr.gather(mi.UInt32, self._pixel, texel)
        width, height = self._world.page_width, self._world.page_height
        x = mi.Float64(pixel % width) + mi.Float64(code & PLACE_MASK) / STEPS
        y = mi.Float64((pixel // width) % height) + mi.Float64((code >> Y_SHIFT) & PLACE_MASK) / STEPS
        corner, *edges = self._world.on_page(triangle, mi.Bool(True))
        away = mi.Vector2d(x, y) - mi.Vector2d(corner)
        return triangle, _weights_at(away, *(mi.Vector2d(edge) for edge in edges))

    def point(self, world: World, texel: mi.UInt32, subsample: mi.UInt32) -> SurfacePoint:
        """The surface there."""
        return world.point(*self.fetch(texel, subsample), mi.Bool(True))

    def copy(self, texel: mi.UInt32, source: mi.UInt32, target: mi.UInt32) -> None:
        """Overwrites sub-samples by others of the same texels, each texel named once."""
        row = (target >> 1) * self.n_texels + texel
        shift = (target & 1) * CODE_BITS
        others = dr.gather(mi.UInt32, self._code, row) & ~(mi.UInt32(0xFFFF) << shift)
        dr.scatter(self._code, others | (self._codes(texel, source) << shift), row)
        dr.eval(self._code)

    def move(self, texel: mi.UInt32, source_texel: mi.UInt32, sources: Sequence[mi.UInt32]) -> None:
        """Overwrites all sub-samples of some texels by those numbered ``sources`` of other texels.

        No texel may be both among the one and among the other.
        """
        codes = [self._codes(source_texel, source) for source in sources]
        for word, (even, odd) in enumerate(zip(codes[::2], codes[1::2], strict=True)):
            dr.scatter(self._code, even | (odd << CODE_BITS), texel + word * self.n_texels)
        for column in (self._pixel, self._first):
            dr.scatter(column, dr.gather(mi.UInt32, column, source_texel), texel)
        dr.eval(self._code, self._pixel, self._first)

    def _codes(self, texel: mi.UInt32, subsample: mi.UInt32) -> mi.UInt32:
        """See :class:`SubsampleSet`."""
        word = dr.gather(mi.UInt32, self._code, (subsample >> 1) * self.n_texels + texel)
        return (word >> ((subsample & 1) * CODE_BITS)) & 0xFFFF


@dr.syntax
def _weights_at(away: mi.Vector2d, first: mi.Vector2d, second: mi.Vector2d) -> mi.Point2f:
    """Weights of the second and third corner; see :func:`subsample_set.weights_at`.

    In double precision: on a large page a thin triangle's area drowns in the rounding of floats.

    Args:
        away: The point, seen from the triangle's first corner.
        first: Its edge to the second corner.
        second: Its edge to the third.
    """
    area = _cross(first, second)
    weights = mi.Point2d(_cross(away, second) / area, _cross(first, away) / area)
    inside = (weights.x >= 0.0) & (weights.y >= 0.0) & (weights.x + weights.y <= 1.0)
    if ~inside:
        weights = _on_outline(away, first, second)
    return mi.Point2f(weights)


def _cross(a: mi.Vector2d, b: mi.Vector2d) -> mi.Float64:
    return a.x * b.y - a.y * b.x


def _on_outline(away: mi.Vector2d, first: mi.Vector2d, second: mi.Vector2d) -> mi.Point2d:
    """Weights of the outline's nearest point; the first edge wins a draw."""
    corner = mi.Vector2d(0.0)
    best, weights = mi.Float64(dr.inf), mi.Point2d(0.0)
    for start, end, weights_of in (
        (corner, first, lambda t: mi.Point2d(t, 0.0)),
        (first, second, lambda t: mi.Point2d(1.0 - t, t)),
        (second, corner, lambda t: mi.Point2d(0.0, 1.0 - t)),
    ):
        along, from_start = end - start, away - start
        length2 = dr.squared_norm(along)
        t = dr.clip(dr.dot(along, from_start) / dr.select(length2 > 0.0, length2, 1.0), 0.0, 1.0)
        distance2 = dr.squared_norm(from_start - along * t)
        nearer = distance2 < best
        best = dr.select(nearer, distance2, best)
        weights = dr.select(nearer, weights_of(t), weights)
    return weights
