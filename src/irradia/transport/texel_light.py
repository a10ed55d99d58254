"""Light arriving at texels: the kernels of the lightmap bake.

A pass gives every texel of a list some gather rays and some next-event samples, in a loop inside one
kernel. One lane serves one texel, or several lanes share one where the list is too short to fill the
device; their parts are then added in fixed order. No scatter adds floats, so the same bits come out
for any number of threads, and no value returns to the host.
"""

from __future__ import annotations

import copy
from collections.abc import Callable
from dataclasses import dataclass
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from irradia.scene.types import Camera
from irradia.transport.backend import device, dr, mi
from irradia.transport.channels import MAP, Channels
from irradia.transport.footprints import Footprints, clear_footprints
from irradia.transport.frames import Frame, TangentFrames
from irradia.transport.geometry import SurfacePoint
from irradia.transport.lights import Lights
from irradia.transport.normal_maps import NormalMaps
from irradia.transport.path import LightCache, direct, draw_ray, start, trace
from irradia.transport.radiosity import Darkness, OtherSides, RadiosityCache, TexelCache
from irradia.transport.sampling import Sampler, hash_u32
from irradia.transport.subsample_set import SubsampleSet
from irradia.transport.subsamples import Subsamples
from irradia.transport.texel_appearance import TexelAppearance
from irradia.transport.texel_grid import TexelGrid
from irradia.transport.texel_sums import Lanes, TexelSums
from irradia.transport.view import seen_texels
from irradia.transport.world import World

_RAYS_PER_SUBSAMPLE = 8
_LANES = {"cpu": 1 << 13, "cuda": 1 << 21}
T = TypeVar("T")
TexelColour = mi.Color3f  # one colour a texel


@dataclass(frozen=True)
class Draw:
    """Samples for each texel of a pass.

    Attributes:
        rays: Gather rays; a multiple of the lanes a texel.
        direct: Next-event samples; likewise.
        seed, direct_seed: Streams of random numbers, the same for all passes of an epoch and a bake.
        first_subsample: Where an epoch begins among the sub-samples.
    """

    rays: int
    direct: int
    seed: int
    direct_seed: int
    first_subsample: int = 0


class TexelLight:
    """The texels of a lightmap, on the device, and the passes over them.

    Args:
        world: The scene.
        pixel: (N,) flat pixel of each texel: seeds its random numbers, so that they don't depend
            on which other texels there are.
        samples: Where each texel is sampled.
        nee_ratio: Next-event samples per gather ray, which multiple importance sampling goes by.
        channels: What is kept of each sample; by default E/π alone.
        normal_maps: Bends the normals that light is received on.
        frames: Tangents, where channels ask for them.
    """

    def __init__(
        self,
        world: World,
        pixel: NDArray[np.uint32],
        samples: SubsampleSet,
        nee_ratio: float,
        channels: Channels | None = None,
        *,
        normal_maps: NormalMaps | None = None,
        frames: TangentFrames | None = None,
    ) -> None:
        self.world = world
        self._n_pages = int(pixel[-1]) // (world.page_width * world.page_height) + 1 if len(pixel) else 1
        self.n_texels = len(pixel)
        self.nee_ratio = nee_ratio
        self.channels = channels or Channels()
        self._normal_maps, self._frames = normal_maps, frames
        self.subsamples = Subsamples(world, pixel, samples)
        self._pixel = mi.UInt32(pixel)
        self._other_sides: OtherSides | None = None
        self._every = dr.arange(mi.UInt32, self.n_texels)
        dr.eval(self._every)

    def lanes(self, texels: NDArray[np.uint32], per_texel: int = 1) -> Lanes:
        """Lanes that serve a list of texels, given in ascending order."""
        if 2 * len(texels) < self.n_texels or per_texel > 1:
            return Lanes(mi.UInt32(texels), len(texels), per_texel)
        served = np.zeros(self.n_texels, np.uint32)
        served[texels] = 1
        return Lanes(self._every, len(texels), served=mi.UInt32(served))

    @property
    def wanted_lanes(self) -> int:
        """How many lanes keep the device busy."""
        return _LANES[device.kind]

    def warm_up(self, lanes: Lanes, cache: TexelCache | None, *, last_epoch: bool = False) -> None:
        """Compiles the kernels by running them with no rays; those of the last epoch count from others."""
        after = None
        if last_epoch:
            earlier = self.empty_sums()
            dr.make_opaque(earlier.rays, earlier.samples)
            after = earlier.counting_from(0, 0)
        self.add_rays(self.empty_sums(), lanes, Draw(0, 0, 0, 0), cache, after=after)
        self.wait()

    def cache_of_nothing(self, cached: bool, *, one_bounce: bool) -> TexelCache | None:
        """What rays read before anything is known, or where nothing is to be read."""
        if one_bounce:
            return Darkness()
        nothing = dr.zeros(mi.Color3f, self.n_texels)
        return self.cache(nothing, nothing) if cached else None

    def wait(self) -> None:
        """Returns when all passes so far are done, so that progress tells the truth."""
        dr.sync_thread()

    def give_back(self) -> None:
        """Returns what is free on the device to the system; otherwise it is kept for the next array."""
        dr.flush_malloc_cache()

    def empty_sums(self) -> TexelSums:
        """No rays yet."""
        return TexelSums.empty(self.n_texels, self.channels.count)

    def clear_footprints(self, grid: TexelGrid) -> Footprints:
        """See :func:`irradia.transport.footprints.clear_footprints`."""
        found = clear_footprints(self.world, self.subsamples, grid)
        return found

    def keep_sides_apart(self, footprints: Footprints, region: NDArray[np.uint32]) -> None:
        """See :class:`OtherSides`."""
        sides = OtherSides(footprints, region)
        self._other_sides = sides if sides.count else None

    def seen_from(self, camera: Camera) -> NDArray[np.bool_]:
        """See :func:`irradia.transport.view.seen_texels`."""
        return seen_texels(self.world, self.subsamples, camera)

    def reflectance(self) -> mi.Color3f:
        """Mean ρ over each texel's footprint, of the light that stops there."""
        rho, stops = dr.zeros(mi.Color3f, self.n_texels), dr.zeros(mi.Float, self.n_texels)
        texel = dr.arange(mi.UInt32, self.n_texels)
        looks_at = TexelAppearance(self.world, self.subsamples.count)
        for subsample in range(self.subsamples.count):
            triangle, bary = self.subsamples.fetch(texel, dr.opaque(mi.UInt32, subsample))
            looks = looks_at.at(triangle, bary, mi.Bool(True))
            rho += looks.reflectance
            stops += 1.0 - looks.pass_probability
            dr.eval(rho, stops)
        rho = rho / dr.maximum(stops, 1e-6)
        dr.eval(rho)
        return rho

    def add_rays(
        self,
        sums: TexelSums,
        lanes: Lanes,
        draw: Draw,
        cache: TexelCache | None,
        *,
        after: TexelSums | None = None,
    ) -> TexelSums:
        """One pass over a list of texels.

        Args:
            sums: What is added to.
            lanes: The texels.
            draw: How many samples each gets.
            cache: Light of mapped surfaces, or None to trace whole paths.
            after: Earlier samples of the same sequences. Together with those in ``sums`` they say
                where each texel goes on.
        """
        cache = cache and cache.read_from(lanes.read(self._every))
        texel, pixel, part = lanes.read(self._every), lanes.read(self._pixel), lanes.part()
        earlier = sums if after is None else after.plus(sums)

        rays = lanes.count(draw.rays)
        first = lanes.read(earlier.rays) + part * rays
        shift = dr.opaque(mi.UInt32, draw.first_subsample % self.subsamples.count)
        gathered = self._gather(texel, _stream(pixel, draw.seed), first, first + rays, shift, cache)

        arrived = self.channels.zeros()
        if self.world.lights.any:
            samples = lanes.count(draw.direct)
            first = lanes.read(earlier.samples) + part * samples
            arrived = self._direct(texel, _stream(pixel, draw.direct_seed), first, first + samples)
        return sums.add(lanes, gathered, arrived, draw.rays, draw.direct)

    @dr.syntax
    def _gather(
        self,
        texel: mi.UInt32,
        texel_seed: mi.UInt32,
        first: mi.UInt32,
        last: mi.UInt32,
        shift: mi.UInt32,
        cache: LightCache | None,
    ) -> list[mi.Color3f]:
        """Sums over rays ``first`` to ``last``: eight from each sub-sample in turn."""
        sums = self.channels.zeros()
        hemisphere = self.channels.hemisphere
        ratio = dr.opaque(mi.Float, self.nee_ratio)
        k = mi.UInt32(first)
        while k < last:
            block = k // _RAYS_PER_SUBSAMPLE
            point, frame = self._receiver(texel, (block + shift) % self.subsamples.count)
            block_end = dr.minimum(last, (block + 1) * _RAYS_PER_SUBSAMPLE)
            while k < block_end:
                sampler = Sampler(mi.UInt32(k), mi.UInt32(texel_seed))
                leaving = draw_ray(point, sampler, hemisphere)
                ray = start(
                    leaving.origin, leaving.direction, leaving.pdf, ratio, sampler, leaving.above, point.lod
                )
                light = trace(self.world, ray, cache).radiance * leaving.weight
                sums = _plus(sums, self.channels.of_ray(light, leaving.arrives_from, frame))
                k += 1
        return sums

    @dr.syntax
    def _direct(
        self, texel: mi.UInt32, texel_seed: mi.UInt32, first: mi.UInt32, last: mi.UInt32
    ) -> list[mi.Color3f]:
        """Sums over next-event samples ``first`` to ``last``, sub-samples taken in turn."""
        sums = self.channels.zeros()
        hemisphere = self.channels.hemisphere
        ratio = dr.opaque(mi.Float, self.nee_ratio)
        k = mi.UInt32(first)
        while k < last:
            point, frame = self._receiver(texel, k % self.subsamples.count)
            sampler = Sampler(mi.UInt32(k), mi.UInt32(texel_seed))
            arrival = direct(self.world, point, sampler, ratio, mi.Bool(True), hemisphere)
            sums = _plus(sums, self.channels.of_arrival(arrival, frame))
            k += 1
        return sums

    def nothing(self) -> mi.Color3f:
        """No light at any texel."""
        return dr.zeros(mi.Color3f, self.n_texels)

    def add_next_event(
        self, total: mi.Color3f, lights: Lights, seed: int, first: int, end: int
    ) -> mi.Color3f:
        """Adds next-event samples of other lights than the world's to sums of E/π at all texels.

        Args:
            total: What was summed before.
            lights: Those that rays can't meet: what gather rays bring is not asked for.
            seed: Stream of random numbers.
            first: The first sample; sub-samples are taken in turn.
            end: One past the last.
        """
        alone, world = copy.copy(self), copy.copy(self.world)
        world.lights, alone.world, alone.channels = lights, world, Channels()
        stream = _stream(self._pixel, seed)
        (arrived,) = alone._direct(
            self._every, stream, dr.opaque(mi.UInt32, first), dr.opaque(mi.UInt32, end)
        )
        result = total + arrived
        dr.eval(result)
        return result

    def _receiver(self, texel: mi.UInt32, subsample: mi.UInt32) -> tuple[SurfacePoint, Frame]:
        """The place that light is gathered at, bent by its normal map where those count."""
        active = mi.Bool(True)
        if self._normal_maps is None and self._frames is None:
            point = self.subsamples.point(self.world, texel, subsample)
            return point, Frame.around(point.ns)
        triangle, bary = self.subsamples.fetch(texel, subsample)
        point = self.subsamples.point(self.world, texel, subsample)
        if self._normal_maps is not None:
            point = self._normal_maps.apply(self.world, point, triangle, bary, active)
        if self._frames is None:
            return point, Frame.around(point.ns)
        return point, self._frames.at(triangle, bary, point.ns, active)

    def incoming(self, *parts: TexelSums) -> mi.Color3f:
        """E/π of independent parts together, as the next epoch's cache needs it; it keeps no hold of them."""
        result = mi.Color3f(0.0)
        for sums in parts:
            result = result + sums.mean(MAP)
            if self.channels.live:
                result = result + sums.mean(MAP + 1)
        dr.eval(result)
        return result

    def cache(
        self, irradiance_over_pi: mi.Color3f, reflectance: mi.Color3f, scale: float = 1.0
    ) -> RadiosityCache:
        """Light leaving each texel, as the next epoch will read it."""
        n_pixels = self.world.page_width * self.world.page_height * self._n_pages
        sides, factor = self._other_sides, reflectance * dr.opaque(mi.Float, scale)
        rows = dr.zeros(mi.Float, 4 * (n_pixels + (sides.count if sides else 0)))
        around, other_row = None, mi.UInt32(0)
        if sides is not None:
            around = sides.around(irradiance_over_pi)
            other_row = sides.write(rows, n_pixels, irradiance_over_pi, around, factor)
        outgoing = irradiance_over_pi * factor
        fourth = dr.reinterpret_array(mi.Float, other_row)
        dr.scatter(rows, mi.Vector4f(outgoing.x, outgoing.y, outgoing.z, fourth), self._pixel)
        dr.eval(rows)
        return RadiosityCache(rows, self.world.page_width, around, sides.region if sides else None)

    def mean(self, irradiance_over_pi: mi.Color3f) -> float:
        """Mean over texels and channels: the one number that goes back to the host."""
        rows = [np.sum(np.array(row), dtype=np.float64) for row in irradiance_over_pi]  # one at a time
        return float(np.sum(rows)) / max(3 * self.n_texels, 1)

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


def _plus(sums: list[mi.Color3f], more: list[mi.Color3f]) -> list[mi.Color3f]:
    return [a + b for a, b in zip(sums, more, strict=True)]


def _stream(pixel: mi.UInt32, seed: int) -> mi.UInt32:
    """A texel's own scramble."""
    return hash_u32(pixel ^ hash_u32(dr.opaque(mi.UInt32, seed)))
