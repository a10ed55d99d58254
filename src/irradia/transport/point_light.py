"""Light at points, with its noise: the kernels of datasets.

Every point's samples come in N_BLOCKS independent sequences, a lane each, and the spread of the blocks'
means is how uncertain their mean is: without bias, though samples within a block are stratified. What is
counted is what the bake counts at a texel (:mod:`irradia.transport.texel_light`): rays by the cosine,
next-event samples, emission and environment shared between both by multiple importance sampling, and the
first bounce of lights that are lit live left out.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from irradia.core.sh import BAND, COSINE_LOBE
from irradia.transport.backend import dr, mi
from irradia.transport.geometry import SurfacePoint
from irradia.transport.path import LightCache, direct, draw_ray, start, trace
from irradia.transport.probe_light import N_COEFFICIENTS, project_light, uniform_sphere
from irradia.transport.receivers import DeviceReceivers, Receivers, columns
from irradia.transport.sampling import Sampler, cosine_hemisphere, hash_u32, to_world
from irradia.transport.world import World

F32 = NDArray[np.float32]

N_BLOCKS = 4
LEAST_DISTANCE_M = 0.01
"""A lamp without extent is never nearer than that to coefficients: in its very place they are infinite."""

_BACKS_SEED = 0xBAC5  # the directions are fixed: they decide on places, not on light


@dataclass(frozen=True)
class Estimate:
    """What was found at N points.

    Attributes:
        values: (N, 3) E in W·m⁻², or (N, k, 3) coefficients of radiance.
        variance: (N,) estimated variance of E, averaged over channels, from N_BLOCKS blocks. Of
            coefficients it is that of E too, averaged over all normals.
    """

    values: F32
    variance: F32


def gather_irradiance(
    world: World, receivers: Receivers, first: int, n_samples: int, seed: int, cache: LightCache | None
) -> Estimate:
    """E at points, in one launch.

    Args:
        world: The scene.
        receivers: The points.
        first: Number of the first among all points that share a seed: random numbers go by it, so
            that it doesn't matter how points are divided among launches.
        n_samples: Rays a point, and as many next-event samples; a multiple of N_BLOCKS.
        seed: Of this gather.
        cache: Stored light of mapped surfaces; None traces whole paths.
    """
    there = DeviceReceivers.of(world, receivers)
    number, stream = _lanes(len(receivers), first, seed)
    total = _irradiance_loop(world, there.fetch(number), stream, _per_block(n_samples), cache)
    dr.eval(total)
    blocks = np.array(total, np.float64).T.reshape(-1, N_BLOCKS, 3) * (math.pi * N_BLOCKS / n_samples)
    variance = blocks.var(axis=1, ddof=1).mean(axis=1) / N_BLOCKS
    return Estimate(blocks.mean(axis=1).astype(np.float32), variance.astype(np.float32))


def gather_coefficients(
    world: World,
    positions: F32,
    first: int,
    n_samples: int,
    seed: int,
    cache: LightCache | None,
    n_coefficients: int = N_COEFFICIENTS,
) -> Estimate:
    """SH of the radiance that arrives at positions (N, 3), in one launch.

    Arguments as :func:`gather_irradiance` takes them; coefficients beyond ``n_coefficients`` are left out.
    """
    place = mi.Point3f(*columns(positions))
    number, stream = _lanes(len(positions), first, seed)
    origin = dr.gather(mi.Point3f, place, number)
    least = dr.opaque(mi.Float, LEAST_DISTANCE_M)
    sums = project_light(world, origin, least, mi.UInt32(0), _per_block(n_samples), stream, cache)
    dr.eval(sums)
    stacked = np.array([np.array(s, np.float64) for s in sums[:n_coefficients]])  # (k, 3, N · N_BLOCKS)
    blocks = stacked.transpose(2, 0, 1).reshape(-1, N_BLOCKS, n_coefficients, 3) * (N_BLOCKS / n_samples)
    # The mean over all normals of (Σ Aᵢ cᵢ Yᵢ)² is Σ Aᵢ² cᵢ² / 4π: the functions are orthonormal.
    lobe = COSINE_LOBE[BAND[:n_coefficients]]
    variance = (blocks.var(axis=1, ddof=1).mean(axis=2) / N_BLOCKS) @ (lobe**2 / (4.0 * math.pi))
    return Estimate(blocks.mean(axis=1).astype(np.float32), variance.astype(np.float32))


def share_of_backs(world: World, receivers: Receivers, n_rays: int, *, all_round: bool) -> F32:
    """(N,) share of rays that first meet the inside of something solid.

    Args:
        world: The scene.
        receivers: The points.
        n_rays: Each point's, in the same directions.
        all_round: Rays in all directions, by solid angle; else above the normal, by the cosine.
    """
    if len(receivers) == 0:
        return np.zeros(0, np.float32)
    point = DeviceReceivers.of(world, receivers).fetch(dr.arange(mi.UInt32, len(receivers)))
    backs = _count_backs(world, point, dr.opaque(mi.UInt32, n_rays), all_round)
    dr.eval(backs)
    return np.array(backs) / np.float32(n_rays)


def _lanes(n_points: int, first: int, seed: int) -> tuple[mi.UInt32, mi.UInt32]:
    """Each lane's point and its stream of random numbers."""
    lane = dr.arange(mi.UInt32, n_points * N_BLOCKS)
    among_all = lane + dr.opaque(mi.UInt32, first * N_BLOCKS & 0xFFFFFFFF)
    return lane // N_BLOCKS, hash_u32(among_all ^ hash_u32(dr.opaque(mi.UInt32, seed)))


def _per_block(n_samples: int) -> mi.UInt32:
    """Opaque, so that the number isn't part of the kernel."""
    return dr.opaque(mi.UInt32, n_samples // N_BLOCKS)


@dr.syntax
def _irradiance_loop(
    world: World, point: SurfacePoint, stream: mi.UInt32, n: mi.UInt32, cache: LightCache | None
) -> mi.Color3f:
    """Sums of E/π over the first ``n`` samples of each lane."""
    total = mi.Color3f(0.0)
    k = mi.UInt32(0)
    while k < n:
        sampler = Sampler(mi.UInt32(k), mi.UInt32(stream))

        # ---- a ray by the cosine, and what next-event estimation brings ----
        leaving = draw_ray(point, sampler)
        arrival = direct(world, point, sampler, mi.Float(1.0), mi.Bool(True))
        total += dr.select(arrival.live, 0.0, arrival.light)

        # ---- the light that the ray meets ----
        ray = start(
            leaving.origin, leaving.direction, leaving.pdf, mi.Float(1.0), sampler, leaving.above, point.lod
        )
        total += trace(world, ray, cache).radiance
        k += 1
    return total


@dr.syntax
def _count_backs(world: World, point: SurfacePoint, n: mi.UInt32, all_round: bool) -> mi.Float:
    backs = mi.Float(0.0)
    k = mi.UInt32(0)
    while k < n:
        u = Sampler(mi.UInt32(k), mi.UInt32(_BACKS_SEED)).next_2d()
        direction = uniform_sphere(u) if all_round else to_world(point.ns, cosine_hemisphere(u))
        looks = mi.Bool(True) if all_round else dr.dot(direction, point.ng) > 0.0
        backs += dr.select(world.meets_back(point.origin, direction, looks, point.lod), 1.0, 0.0)
        k += 1
    return backs
