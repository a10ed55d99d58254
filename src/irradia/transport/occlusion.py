"""How open texels are: the kernel of ambient occlusion.

Rays are drawn about the vertex normal. Those that it alone sends below the surface are left out of
the count rather than called occluded, so that a convex body is open everywhere, however coarse its
mesh.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from irradia.transport.backend import dr, mi
from irradia.transport.punctual import FAR
from irradia.transport.sampling import Sampler, cosine_hemisphere, hash_u32, to_world
from irradia.transport.subsamples import Subsamples
from irradia.transport.world import World

_RAYS_PER_SUBSAMPLE = 8  # in a row, for they start at one place


@dataclass
class OpenSums:
    """Running sums over rays; their quotient is the openness.

    Attributes:
        free: (N) rays that met nothing, those in part that something let through.
        drawn: (N) rays above the surface.
        n_rays: Rays tried per texel so far.
    """

    free: mi.Float
    drawn: mi.Float
    n_rays: int

    def openness(self) -> NDArray[np.float32]:
        """(N,) 1 where nothing is near, 0 where all is closed."""
        return np.array(self.free / dr.maximum(self.drawn, 1.0))


class Openness:
    """Looks out from texels.

    Args:
        world: What occludes.
        subsamples: Of the texels.
        pixel: (N,) flat pixel of each texel: seeds its random numbers.
        distance_m: How far to look; infinity for all the way.
        seed: Root of the random numbers.
    """

    def __init__(
        self, world: World, subsamples: Subsamples, pixel: NDArray[np.uint32], distance_m: float, seed: int
    ) -> None:
        self._world, self._subsamples = world, subsamples
        self._texel_seed = hash_u32(mi.UInt32(pixel) ^ hash_u32(dr.opaque(mi.UInt32, seed)))
        self._distance = dr.opaque(mi.Float, min(distance_m, FAR))

    def nothing(self) -> OpenSums:
        """No rays yet."""
        n_texels = self._subsamples.n_texels
        return OpenSums(dr.zeros(mi.Float, n_texels), dr.zeros(mi.Float, n_texels), 0)

    def add(self, sums: OpenSums, n_rays: int) -> OpenSums:
        """Draws more rays from every texel, sub-samples taken in turn; one launch."""
        last = sums.n_rays + n_rays
        free, drawn = self._look(dr.opaque(mi.UInt32, sums.n_rays), dr.opaque(mi.UInt32, last))
        result = OpenSums(sums.free + free, sums.drawn + drawn, last)
        dr.eval(result.free, result.drawn)
        return result

    @staticmethod
    def wait() -> None:
        """Returns when all rays so far are done, so that progress tells the truth."""
        dr.sync_thread()

    @dr.syntax
    def _look(self, first: mi.UInt32, last: mi.UInt32) -> tuple[mi.Float, mi.Float]:
        texel = dr.arange(mi.UInt32, self._subsamples.n_texels)
        free, drawn = mi.Float(0.0), mi.Float(0.0)
        k = mi.UInt32(first)
        while k < last:
            block = k // _RAYS_PER_SUBSAMPLE
            point = self._subsamples.point(self._world, texel, block % self._subsamples.count)
            block_end = dr.minimum(last, (block + 1) * _RAYS_PER_SUBSAMPLE)
            while k < block_end:
                u = Sampler(mi.UInt32(k), mi.UInt32(self._texel_seed)).next_2d()
                direction = to_world(point.ns, cosine_hemisphere(u))
                above = dr.dot(direction, point.ng) > 0.0
                passes = self._world.transmittance(point.origin, direction, self._distance, above, point.lod)
                free += dr.select(above, mi.luminance(passes), 0.0)
                drawn += dr.select(above, 1.0, 0.0)
                k += 1
        return free, drawn
