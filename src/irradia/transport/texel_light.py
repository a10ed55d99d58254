"""Light arriving at texels: the kernels of the lightmap bake.

One lane is one texel. A pass draws a few rays from each of the texel's sub-samples in turn, in a
loop inside the kernel, and adds what they bring to that texel's sums: no scatter, so the same bits
come out for any number of threads, and no value returns to the host.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from irradia.transport.backend import dr, mi
from irradia.transport.geometry import Hit
from irradia.transport.hidden import drop_hidden
from irradia.transport.path import LightCache, direct, start, trace
from irradia.transport.sampling import Sampler, cosine_hemisphere, hash_u32, to_world
from irradia.transport.subsamples import Subsamples
from irradia.transport.world import TriangleRecord, World

_RAYS_PER_SUBSAMPLE = 8
T = TypeVar("T")
TexelColour = mi.Color3f  # one colour a texel


class RadiosityCache:
    """Radiance leaving each texel of the map, ρ · E/π, read by the nearest texel."""

    def __init__(self, radiosity: mi.Float, width_px: int) -> None:
        self._radiosity = radiosity
        self._width = width_px

    def outgoing(self, world: World, hit: Hit, record: TriangleRecord, active: mi.Bool) -> mi.Color3f:
        """See :class:`LightCache`."""
        pixel = record.page_start + mi.UInt32(record.pixel.y) * self._width + mi.UInt32(record.pixel.x)
        value = dr.gather(mi.Vector4f, self._radiosity, pixel, active)
        return mi.Color3f(value.x, value.y, value.z)


@dataclass
class TexelSums:
    """Running sums over rays; E/π is their quotient.

    Attributes:
        light: (N) sum of weighted radiance.
        count: Rays drawn per texel so far.
    """

    light: mi.Color3f
    count: int

    @property
    def mean(self) -> mi.Color3f:
        """E/π."""
        return self.light / max(self.count, 1)


class TexelLight:
    """The texels of a lightmap, on the device, and the passes over them.

    Args:
        world: The scene.
        pixel: (N,) flat pixel of each texel: seeds its random numbers, so that they don't depend
            on which other texels there are.
        triangle: (N, S) triangle under each sub-sample.
        barycentric: (N, S, 2).
        nee_ratio: Next-event samples per gather ray that the whole bake will have drawn.
    """

    def __init__(
        self,
        world: World,
        pixel: NDArray[np.uint32],
        triangle: NDArray[np.uint32],
        barycentric: NDArray[np.float32],
        nee_ratio: float,
    ) -> None:
        self.world = world
        self._n_pages = int(pixel[-1]) // (world.page_width * world.page_height) + 1 if len(pixel) else 1
        self.n_texels = len(pixel)
        self._subsamples = Subsamples(triangle, barycentric)
        self._pixel = mi.UInt32(pixel)
        self._nee_ratio = nee_ratio

    def warm_up(self, *, cached: bool) -> None:
        """Compiles the kernels by running them with no rays."""
        sums = self.empty_sums()
        cache = self.cache(sums.light, sums.light) if cached else None
        self.gather(sums, 0, 0, cache, first_subsample=0)
        self.direct(sums, 0, 0)
        self.wait()

    def wait(self) -> None:
        """Returns when all passes so far are done, so that progress tells the truth."""
        dr.sync_thread()

    def empty_sums(self) -> TexelSums:
        """No rays yet."""
        return TexelSums(dr.zeros(mi.Color3f, self.n_texels), 0)

    def drop_hidden_subsamples(self) -> NDArray[np.float32]:
        """See :func:`irradia.transport.hidden.drop_hidden`."""
        return drop_hidden(self.world, self._subsamples)

    def _texel_seed(self, seed: int) -> mi.UInt32:
        return hash_u32(self._pixel ^ hash_u32(dr.opaque(mi.UInt32, seed)))

    def reflectance(self) -> mi.Color3f:
        """Mean ρ over each texel's footprint, of the light that stops there."""
        rho, stops = dr.zeros(mi.Color3f, self.n_texels), dr.zeros(mi.Float, self.n_texels)
        texel = dr.arange(mi.UInt32, self.n_texels)
        for subsample in range(self._subsamples.count):
            triangle, bary = self._subsamples.fetch(texel, dr.opaque(mi.UInt32, subsample))
            looks = self.world.appearance(triangle, bary, mi.Bool(True))
            rho += looks.reflectance
            stops += 1.0 - looks.pass_probability
            dr.eval(rho, stops)
        return rho / dr.maximum(stops, 1e-6)

    def gather(
        self, sums: TexelSums, n_rays: int, seed: int, cache: LightCache | None, *, first_subsample: int
    ) -> TexelSums:
        """Adds ``n_rays`` cosine-distributed rays to every texel, moving on by a sub-sample every eight."""
        first, last = dr.opaque(mi.UInt32, sums.count), dr.opaque(mi.UInt32, sums.count + n_rays)
        shift = dr.opaque(mi.UInt32, first_subsample % self._subsamples.count)
        light = self._gather_loop(self._texel_seed(seed), first, last, shift, cache)
        result = TexelSums(sums.light + light, sums.count + n_rays)
        dr.eval(result.light)
        return result

    @dr.syntax
    def _gather_loop(
        self,
        texel_seed: mi.UInt32,
        first: mi.UInt32,
        last: mi.UInt32,
        shift: mi.UInt32,
        cache: LightCache | None,
    ) -> mi.Color3f:
        """Rays ``first`` to ``last``: from each sub-sample in turn, eight."""
        texel = dr.arange(mi.UInt32, self.n_texels)
        light = mi.Color3f(0.0)
        ratio = dr.opaque(mi.Float, self._nee_ratio)
        k = mi.UInt32(first)
        while k < last:
            block = k // _RAYS_PER_SUBSAMPLE
            point = self._subsamples.point(self.world, texel, (block + shift) % self._subsamples.count)
            block_end = dr.minimum(last, (block + 1) * _RAYS_PER_SUBSAMPLE)
            while k < block_end:
                sampler = Sampler(mi.UInt32(k), mi.UInt32(texel_seed))
                local = cosine_hemisphere(sampler.next_2d())
                direction = to_world(point.ns, local)
                above = (dr.dot(direction, point.ng) > 0.0) & (local.z > 0.0)
                ray = start(point.origin, direction, local.z * (1.0 / math.pi), ratio, sampler, above)
                light += trace(self.world, ray, cache).radiance
                k += 1
        return light

    def direct(self, sums: TexelSums, n_samples: int, seed: int) -> TexelSums:
        """Adds next-event samples to every texel, sub-samples taken in turn."""
        if not self.world.lights.any:
            return TexelSums(sums.light, sums.count + n_samples)
        first, last = dr.opaque(mi.UInt32, sums.count), dr.opaque(mi.UInt32, sums.count + n_samples)
        ratio = dr.opaque(mi.Float, self._nee_ratio)
        light = self._direct_loop(self._texel_seed(seed), first, last, ratio)
        result = TexelSums(sums.light + light, sums.count + n_samples)
        dr.eval(result.light)
        return result

    @dr.syntax
    def _direct_loop(self, texel_seed, first, last, ratio):
        texel = dr.arange(mi.UInt32, self.n_texels)
        light = mi.Color3f(0.0)
        k = mi.UInt32(first)
        while k < last:
            point = self._subsamples.point(self.world, texel, k % self._subsamples.count)
            sampler = Sampler(mi.UInt32(k), mi.UInt32(texel_seed))
            light += direct(self.world, point, sampler, ratio, mi.Bool(True)).light
            k += 1
        return light

    def cache(
        self, irradiance_over_pi: mi.Color3f, reflectance: mi.Color3f, scale: float = 1.0
    ) -> RadiosityCache:
        """Light leaving each texel, as the next epoch will read it."""
        width, height = self.world.page_width, self.world.page_height
        buffer = dr.zeros(mi.Float, 4 * width * height * self._n_pages)
        outgoing = irradiance_over_pi * reflectance * dr.opaque(mi.Float, scale)
        value = mi.Vector4f(outgoing.x, outgoing.y, outgoing.z, 0.0)
        dr.scatter(buffer, value, self._pixel)
        dr.eval(buffer)
        return RadiosityCache(buffer, width)

    def mean(self, irradiance_over_pi: mi.Color3f) -> float:
        """Mean over texels and channels: the one number that goes back to the host."""
        return float(np.mean(self.to_host(irradiance_over_pi), dtype=np.float64))

    def to_host(self, value: mi.Color3f) -> NDArray[np.float32]:
        """(N, 3) array."""
        return np.ascontiguousarray(np.array(value).T)

    def count_launches(self, run: Callable[[], T]) -> tuple[T, int]:
        """Runs a piece of work to its end and counts the kernels that it launched."""
        with dr.scoped_set_flag(dr.JitFlag.KernelHistory, True):
            dr.kernel_history_clear()
            result = run()
            dr.sync_thread()
            return result, sum(entry["type"] == dr.KernelType.JIT for entry in dr.kernel_history())
