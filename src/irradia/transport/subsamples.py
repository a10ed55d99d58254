"""The sub-samples of a lightmap's texels, on the device."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from irradia.transport.backend import dr, mi
from irradia.transport.geometry import SurfacePoint
from irradia.transport.world import World


class Subsamples:
    """For every texel, ``count`` places on triangles.

    Rows stand sub-sample by sub-sample, so that one sub-sample of neighbouring texels is read from
    neighbouring places.

    Args:
        triangle: (N, S).
        barycentric: (N, S, 2).
    """

    def __init__(self, triangle: NDArray[np.uint32], barycentric: NDArray[np.float32]) -> None:
        self.n_texels, self.count = triangle.shape
        self._triangle = mi.UInt32(np.ascontiguousarray(triangle.T).ravel())
        self._bary = [mi.Float(np.ascontiguousarray(barycentric[..., i].T).ravel()) for i in (0, 1)]

    def fetch(self, texel: mi.UInt32, subsample: mi.UInt32) -> tuple[mi.UInt32, mi.Point2f]:
        """Triangle and barycentrics."""
        row = subsample * self.n_texels + texel
        bary = mi.Point2f(*[dr.gather(mi.Float, b, row) for b in self._bary])
        return dr.gather(mi.UInt32, self._triangle, row), bary

    def point(self, world: World, texel: mi.UInt32, subsample: mi.UInt32) -> SurfacePoint:
        """The surface there."""
        return world.point(*self.fetch(texel, subsample), mi.Bool(True))

    def copy(self, texel: mi.UInt32, source: mi.UInt32, target: mi.UInt32) -> None:
        """Overwrites sub-samples by others of the same texels."""
        triangle, bary = self.fetch(texel, source)
        dr.eval(triangle, bary)
        row = target * self.n_texels + texel
        dr.scatter(self._triangle, triangle, row)
        for column, value in zip(self._bary, (bary.x, bary.y), strict=True):
            dr.scatter(column, value, row)
        dr.eval(self._triangle, *self._bary)
