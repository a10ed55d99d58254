"""How much of one punctual light arrives at texels: the kernel of shadow masks.

A texel's visibility is the ratio of the light's irradiance with and without what stands in the way,
both estimated from the same samples of the light's disc or sphere and of the texel's footprint. A live
light times that ratio is therefore what a bake of the same light would hold.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from irradia.transport.backend import dr, mi
from irradia.transport.punctual import PunctualLights
from irradia.transport.sampling import Sampler, hash_u32
from irradia.transport.subsamples import Subsamples
from irradia.transport.world import World


@dataclass
class LightShare:
    """Sums over the samples of one light, or of several that nowhere meet.

    Attributes:
        arrived: (N) luminance of the irradiance that arrived.
        offered: (N) the same with nothing in the way.
    """

    arrived: mi.Float
    offered: mi.Float

    def visibility(self) -> tuple[NDArray[np.float32], NDArray[np.bool_]]:
        """(N,) the share that arrives, in [0, 1], and (N,) whether there is any light to ask for."""
        arrived, offered = np.array(self.arrived), np.array(self.offered)
        lit = offered > 0.0
        share = np.divide(arrived, offered, out=np.zeros_like(arrived), where=lit)
        return np.minimum(share, np.float32(1.0)), lit


class LightVisibility:
    """Asks texels for lights.

    Args:
        world: What stands in the way.
        subsamples: Of the texels.
        pixel: (N,) flat pixel of each texel: seeds its random numbers.
        lights: Those that may be asked for.
        seed: Root of the random numbers.
    """

    def __init__(
        self,
        world: World,
        subsamples: Subsamples,
        pixel: NDArray[np.uint32],
        lights: PunctualLights,
        seed: int,
    ) -> None:
        self._world, self._subsamples, self._lights = world, subsamples, lights
        self._texel_seed = hash_u32(mi.UInt32(pixel) ^ hash_u32(dr.opaque(mi.UInt32, seed)))

    def nothing(self) -> LightShare:
        """No light asked for yet."""
        n_texels = self._subsamples.n_texels
        return LightShare(dr.zeros(mi.Float, n_texels), dr.zeros(mi.Float, n_texels))

    def add(self, share: LightShare, light: int, n_samples: int) -> LightShare:
        """Adds samples of one light at every texel, as many from each sub-sample; one launch.

        Args:
            share: What was asked before.
            light: Place among the lights.
            n_samples: Per texel; rounded up to a multiple of the sub-samples.
        """
        per_place = -(-n_samples // self._subsamples.count)
        arrived, offered = self._ask(dr.opaque(mi.UInt32, light), dr.opaque(mi.UInt32, per_place))
        result = LightShare(share.arrived + arrived, share.offered + offered)
        dr.eval(result.arrived, result.offered)
        return result

    @staticmethod
    def wait() -> None:
        """Returns when all rays so far are done, so that progress tells the truth."""
        dr.sync_thread()

    @dr.syntax
    def _ask(self, light: mi.UInt32, per_place: mi.UInt32) -> tuple[mi.Float, mi.Float]:
        texel = dr.arange(mi.UInt32, self._subsamples.n_texels)
        arrived, offered = mi.Float(0.0), mi.Float(0.0)
        seed = hash_u32(self._texel_seed ^ light)
        k, last = mi.UInt32(0), per_place * self._subsamples.count
        while k < last:
            point = self._subsamples.point(self._world, texel, k // per_place)
            next_place = k + per_place
            while k < next_place:
                # ---- what the surface would get from a place on the light ----
                u = Sampler(mi.UInt32(k), mi.UInt32(seed)).next_2d()
                direction, distance, irradiance = self._lights.sample_one(
                    point.origin, light, u, mi.Bool(True)
                )
                cosine = dr.dot(point.ns, direction)
                facing = (cosine > 0.0) & (dr.dot(point.ng, direction) > 0.0)
                incident = dr.select(facing, irradiance * cosine, 0.0)
                offered += mi.luminance(incident)

                # ---- and what it gets ----
                lit = facing & (dr.max(incident) > 0.0)
                passes = self._world.transmittance(point.origin, direction, distance, lit, point.lod)
                arrived += mi.luminance(incident * passes)
                k += 1
        return arrived, offered
