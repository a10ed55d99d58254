"""Light and sight at points in free space: the kernels of the probe bake.

Light is gathered as spherical harmonics of incoming radiance. One lane takes a block of a probe's
samples and keeps the 27 sums in registers; blocks are added up in order, so the same bits come out for
any number of threads. As for texels, next-event estimation reaches punctual lights, which project to SH
as the deltas that they are, and shares emissive surfaces and the environment with rays by multiple
importance sampling.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from irradia.transport.backend import dr, mi
from irradia.transport.geometry import SurfacePoint
from irradia.transport.materials import DOUBLE_SIDED, FILTERS, TRANSLUCENT
from irradia.transport.path import LightCache, start, trace
from irradia.transport.sampling import Sampler, hash_u32
from irradia.transport.world import World

N_COEFFICIENTS = 9
_SAMPLES_PER_BLOCK = 64
_LANES_PER_LAUNCH = 1 << 18
_RAYS_PER_LAUNCH = 1 << 21
_UNIFORM = 1.0 / (4.0 * math.pi)  # density of directions over the sphere


@dataclass(frozen=True)
class Sight:
    """What rays met.

    Attributes:
        distance: Metres to the first surface that stops most light; inf where none does.
        back: Whether that was the inside of something solid.
        sky: Share of the sky's light that comes through, 0 where anything opaque is in the way.
    """

    distance: NDArray[np.float32]
    back: NDArray[np.bool_]
    sky: NDArray[np.float32]


def look_around(
    world: World, origins: NDArray[np.float32], directions: NDArray[np.float32]
) -> Iterator[tuple[slice, Sight]]:
    """Looks from every origin (N, 3) in every unit direction (D, 3).

    Yields:
        Some origins at a time, so that memory is bounded, and what they see, (n, D) each.
    """
    d = mi.Vector3f(*_columns(directions))
    n_directions = len(directions)
    step, per_origin = max(_RAYS_PER_LAUNCH // n_directions, 1), dr.opaque(mi.UInt32, n_directions)
    for first in range(0, len(origins), step):
        part = slice(first, min(first + step, len(origins)))
        o = mi.Point3f(*_columns(origins[part]))
        lane = dr.arange(mi.UInt32, (part.stop - first) * n_directions)
        origin = lane // per_origin
        chosen = dr.gather(mi.Vector3f, d, lane - origin * per_origin)
        found = _first_surface(world, dr.gather(mi.Point3f, o, origin), chosen)
        yield part, _to_host(found, (part.stop - first, n_directions))


def look_along(world: World, origins: NDArray[np.float32], directions: NDArray[np.float32]) -> Sight:
    """Looks once from every origin (N, 3) in its own unit direction (N, 3); results are (N,)."""
    if len(origins) == 0:
        none = np.zeros(0, np.float32)
        return Sight(none, none.astype(bool), none)
    o = mi.Point3f(*_columns(origins))
    d = mi.Vector3f(*_columns(directions))
    return _to_host(_first_surface(world, o, d), (len(origins),))


def gather_sh(
    world: World,
    origins: NDArray[np.float32],
    least_m: NDArray[np.float32],
    n_samples: int,
    seed: int,
    cache: LightCache | None = None,
) -> Iterator[tuple[slice, NDArray[np.float32]]]:
    """Incoming radiance at points, projected on the nine functions of orders 0 to 2.

    Args:
        world: The scene.
        origins: (N, 3) metres.
        least_m: (N,) lamps without extent count as at least that far away: a probe stands for the
            space around it, and in the very place of a lamp its light would be infinite.
        n_samples: Rays a point, and as many next-event samples.
        seed: Of this gather.
        cache: Stored light of mapped surfaces; None traces whole paths.

    Yields:
        Some points at a time and their coefficients (n, 9, 3), in the project's order and signs.
    """
    n_blocks = -(-n_samples // _SAMPLES_PER_BLOCK)
    step = max(_LANES_PER_LAUNCH // n_blocks, 1)
    per_probe, total = dr.opaque(mi.UInt32, n_blocks), dr.opaque(mi.UInt32, n_samples)
    for first in range(0, len(origins), step):
        part = slice(first, min(first + step, len(origins)))
        o = mi.Point3f(*_columns(origins[part]))
        lane = dr.arange(mi.UInt32, (part.stop - first) * n_blocks)
        probe = lane // per_probe
        block = lane - probe * per_probe
        stream = hash_u32((probe + dr.opaque(mi.UInt32, first)) ^ hash_u32(dr.opaque(mi.UInt32, seed)))
        last = dr.minimum((block + 1) * _SAMPLES_PER_BLOCK, total)
        origin = dr.gather(mi.Point3f, o, probe)
        least = dr.gather(mi.Float, mi.Float(np.ascontiguousarray(least_m[part], np.float32)), probe)
        sums = project_light(world, origin, least, block * _SAMPLES_PER_BLOCK, last, stream, cache)
        dr.eval(sums)  # all in one launch: each reduction would start one of its own
        channels = [dr.block_sum(channel, n_blocks) for colour in sums for channel in colour]
        stacked = np.stack([np.array(channel) for channel in channels], axis=1) / np.float32(n_samples)
        yield part, stacked.reshape(-1, N_COEFFICIENTS, 3)


@dr.syntax
def project_light(
    world: World,
    origin: mi.Point3f,
    least: mi.Float,
    first: mi.UInt32,
    last: mi.UInt32,
    stream: mi.UInt32,
    cache: LightCache | None,
) -> list[mi.Color3f]:
    """Sums of SH over samples ``first`` to ``last`` of each lane, N_COEFFICIENTS of them.

    Args:
        world: The scene.
        origin: Where each lane looks from.
        least: See ``least_m`` of :func:`gather_sh`.
        first: Number of the first sample.
        last: Number after the last.
        stream: Each lane's random numbers.
        cache: Stored light of mapped surfaces; None traces whole paths.
    """
    sums = [mi.Color3f(0.0) for _ in range(N_COEFFICIENTS)]
    k = mi.UInt32(first)
    while k < last:
        sampler = Sampler(mi.UInt32(k), mi.UInt32(stream))

        # ---- a ray in a uniformly drawn direction ----
        direction = uniform_sphere(sampler.next_2d())
        light, towards = _direct(world, origin, least, sampler)
        ray = start(origin, direction, mi.Float(_UNIFORM), mi.Float(1.0), sampler, mi.Bool(True))
        radiance = trace(world, ray, cache).radiance * (1.0 / _UNIFORM)

        # ---- both projected ----
        sums = _project(sums, direction, radiance)
        sums = _project(sums, towards, light)
        k += 1
    return sums


def _direct(
    world: World, origin: mi.Point3f, least: mi.Float, sampler: Sampler
) -> tuple[mi.Color3f, mi.Vector3f]:
    """One next-event sample of radiance over its density, MIS-weighted, and where it comes from.

    The first bounce of lights that are lit live is left out.
    """
    if not world.lights.any:
        return mi.Color3f(0.0), mi.Vector3f(0.0, 0.0, 1.0)
    u, pick = sampler.next_2d(), sampler.next_1d()
    no_side = mi.Vector3f(0.0)
    finest = mi.UInt32(0) if world.geometry.has_lods else None
    point = SurfacePoint(position=origin, origin=origin, ng=no_side, ns=no_side, lod=finest)
    emission = world.emission_seen_from(point)
    sample = world.lights.sample(world.geometry, emission, point, pick, u, mi.Bool(True))
    useful = dr.max(sample.weight) > 0.0
    useful &= ~world.lights.is_live(sample.punctual, useful)
    # Lamps keep 1e-6 m away by themselves, which makes their irradiance finite, and here dividable.
    softened = dr.square(dr.minimum(dr.maximum(sample.distance, 1e-6) / least, 1.0))
    weight = dr.select(sample.pdf > 0.0, sample.pdf / (sample.pdf + _UNIFORM), softened)
    arriving = world.transmittance(origin, sample.direction, sample.distance, useful, finest)
    return dr.select(useful, sample.weight * arriving * weight, 0.0), sample.direction


@dr.syntax
def _first_surface(
    world: World, origin: mi.Point3f, direction: mi.Vector3f
) -> tuple[mi.Float, mi.Bool, mi.Float]:
    """Distance to what stops most light, whether its back was met, and the sky's share."""
    o, travelled = mi.Point3f(origin), dr.zeros(mi.Float, dr.width(origin))
    distance = dr.full(mi.Float, math.inf, dr.width(origin))
    sky = dr.full(mi.Float, 1.0, dr.width(origin))
    back = dr.full(mi.Bool, False, dr.width(origin))
    active = dr.full(mi.Bool, True, dr.width(origin))
    while active:
        hit = world.geometry.intersect(o, direction, active)
        active &= hit.valid
        record = world.record(hit.triangle, hit.bary, active)
        filters = active & ((record.flags & FILTERS) != 0)
        looks = world.appearance(hit.triangle, hit.bary, filters)
        travelled += dr.select(active, hit.t, 0.0)
        stops = active & (~filters | (looks.pass_probability < 0.5)) & (distance == math.inf)
        distance = dr.select(stops, travelled, distance)
        solid = (record.flags & (DOUBLE_SIDED | FILTERS | TRANSLUCENT)) == 0
        back |= stops & solid & (dr.dot(record.ng, direction) > 0.0)
        sky = dr.select(active, dr.select(filters, sky * dr.mean(looks.through), 0.0), sky)
        o = dr.select(filters, world.geometry.step_past(o, direction, hit.t), o)
        active = filters & (sky > 1e-3)
    return distance, back, sky


def _columns(rows: NDArray[np.float32]) -> list[mi.Float]:
    """x, y and z of (N, 3) on the device, each for itself: split there, N would be part of the kernel."""
    return [mi.Float(np.ascontiguousarray(column, np.float32)) for column in rows.T]


def _to_host(found: tuple[mi.Float, mi.Bool, mi.Float], shape: tuple[int, ...]) -> Sight:
    dr.eval(found)
    distance, back, sky = (np.array(value).reshape(shape) for value in found)
    return Sight(distance, back.astype(np.bool_), sky)


def _project(sums: list[mi.Color3f], direction: mi.Vector3f, light: mi.Color3f) -> list[mi.Color3f]:
    """Adds light from a direction to the coefficients."""
    return [total + light * value for total, value in zip(sums, _sh(direction), strict=True)]


def uniform_sphere(u: mi.Point2f) -> mi.Vector3f:
    """A direction, all equally likely."""
    z = 1.0 - 2.0 * u.x
    radius = dr.safe_sqrt(1.0 - z * z)
    sin_phi, cos_phi = dr.sincos(2.0 * math.pi * u.y)
    return mi.Vector3f(radius * cos_phi, radius * sin_phi, z)


def _sh(d: mi.Vector3f) -> list[mi.Float]:
    """The nine functions; order and constants as docs/conventions.md fixes them."""
    x, y, z = d.x, d.y, d.z
    return [
        mi.Float(0.2820947918),
        0.4886025119 * y,
        0.4886025119 * z,
        0.4886025119 * x,
        1.0925484306 * x * y,
        1.0925484306 * y * z,
        0.3153915653 * (3.0 * z * z - 1.0),
        1.0925484306 * x * z,
        0.5462742153 * (x * x - y * y),
    ]
