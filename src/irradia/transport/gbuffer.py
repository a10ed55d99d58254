"""What a camera sees, as places to ask for light: pictures from fields, probes and anything else.

Primary visibility is that of :mod:`irradia.transport.render`: the same rays for the same seed, let through
by alpha, transmission and the backs of single-sided surfaces at random. Where a ray stops, the surface's
E is asked for elsewhere, from arrays, and

    L = other + ρ/π · E(p, n)

with ``other`` all that needs no E: emission, the backdrop, and the direct light of lights that are lit live
(mixed and realtime), traced with shadow rays. Surfaces that let light through diffusely ask twice, with
T/π · E(p, −n) for the light behind them.
"""

from __future__ import annotations

import copy
import math
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from irradia.core import Progress, Seed, silent_progress
from irradia.scene.merge import CAMERA_LOD, merge, seen_by_camera
from irradia.scene.types import Camera, Scene
from irradia.transport.backend import dr, mi
from irradia.transport.camera_rays import camera_ray
from irradia.transport.light_setup import make_lights
from irradia.transport.materials import DOUBLE_SIDED, FILTERS
from irradia.transport.path import direct
from irradia.transport.render import RenderOptions
from irradia.transport.sampling import Sampler, hash_u32
from irradia.transport.world import World

F32 = NDArray[np.float32]
Irradiance = Callable[[F32, F32], F32]
"""Positions (S, 3) and unit normals (S, 3) to E (S, 3)."""

_SAMPLES_AT_ONCE = 1 << 20
_MAX_SEGMENTS = 1024
_MASK_SPP = 4


@dataclass(frozen=True)
class SeenPlaces:
    """Some rows of a picture.

    Attributes:
        rows: Which.
        shown: (rows, width) share of each pixel's rays that stop at a surface; the others see the backdrop.
        other: (rows, width, 3) mean radiance that needs no E.
        pixel: (S,) number within these rows of each sample that asks for E.
        positions, normals: (S, 3) where; normals are vertex normals, turned to the side that is seen.
        factor: (S, 3) what E is multiplied by: ρ/π, what let the ray through, and the share of its pixel.
        behind: (S, 3) likewise of E at the turned normal; None where no surface lets light through.
    """

    rows: slice
    shown: F32
    other: F32
    pixel: NDArray[np.int64]
    positions: F32
    normals: F32
    factor: F32
    behind: F32 | None

    def lit_by(self, irradiance: Irradiance) -> F32:
        """(rows, width, 3) radiance under somebody's E."""
        light = irradiance(self.positions, self.normals) * self.factor
        if self.behind is not None:
            through = np.flatnonzero(self.behind.max(axis=1, initial=0.0) > 0.0)
            at, turned = self.positions[through], -self.normals[through]
            light[through] += irradiance(at, turned) * self.behind[through]
        return self.other + self._per_pixel(light)

    def _per_pixel(self, light: F32) -> F32:
        shape = self.other.shape
        n_pixels = shape[0] * shape[1]
        sums = [np.bincount(self.pixel, weights=channel, minlength=n_pixels) for channel in light.T]
        return np.stack(sums, axis=1).reshape(shape).astype(np.float32)


def picture_under(
    scene: Scene,
    camera: Camera,
    options: RenderOptions,
    irradiance: Irradiance,
    progress: Progress | None = None,
    *,
    name: str = "picture",
) -> F32:
    """Renders (height, width, 3) linear radiance under somebody's E; ``name`` is the stage that is shown."""
    picture = np.zeros((options.height, options.width, 3), np.float32)
    n_samples = options.spp * options.width * options.height
    with (progress or silent_progress()).stage(name, n_samples, "samples") as stage:
        for seen in look(scene, camera, options):
            picture[seen.rows] = seen.lit_by(irradiance)
            stage.advance((seen.rows.stop - seen.rows.start) * options.width * options.spp)
    return picture


def pixels_of_scene(scene: Scene, camera: Camera, options: RenderOptions) -> NDArray[np.bool_]:
    """(height, width) pixels that show the scene: at least half of their rays stop at a surface.

    Where none does, all of them: there is nothing but backdrop to be judged.
    """
    return mostly_scene(look(scene, camera, replace(options, spp=_MASK_SPP)))


def mostly_scene(bands: Iterable[SeenPlaces]) -> NDArray[np.bool_]:
    """:func:`pixels_of_scene` of all bands of a picture, in order."""
    shown = np.concatenate([band.shown for band in bands]) >= 0.5
    return shown if shown.any() else np.ones_like(shown)


def look(scene: Scene, camera: Camera, options: RenderOptions) -> Iterator[SeenPlaces]:
    """Looks through a camera, a band of rows at a time, so that memory is bounded.

    Args:
        scene: Its mixed and realtime lights are lit live; all others are somebody's E.
        camera: Where from.
        options: Size, samples a pixel and seed; transport is diffuse whatever they say.
    """
    viewer = _Viewer(scene, camera, options)
    step = max(_SAMPLES_AT_ONCE // (options.width * options.spp), 1)
    for first in range(0, options.height, step):
        yield viewer.look(slice(first, min(first + step, options.height)))


@dataclass
class _Sight:
    """A camera's ray on its way.

    Attributes:
        origin, direction: The ray.
        throughput: What let it pass so far.
        other: What it has met that needs no E.
        sampler: Its random numbers.
        triangle, bary, back: Where it stopped, and whether from behind.
        stopped: Whether it did stop.
        weight: Throughput there, over the probability of stopping.
        segments: Counter.
        active: Whether it goes on.
    """

    origin: mi.Point3f
    direction: mi.Vector3f
    throughput: mi.Color3f
    other: mi.Color3f
    sampler: Sampler
    triangle: mi.UInt32
    bary: mi.Point2f
    back: mi.Bool
    stopped: mi.Bool
    weight: mi.Color3f
    segments: mi.UInt32
    active: mi.Bool


class _Viewer:
    """A scene ready to be looked at; one lane a sample."""

    def __init__(self, scene: Scene, camera: Camera, options: RenderOptions) -> None:
        mesh = seen_by_camera(merge(scene))
        self._world = World(scene, mesh, robust=not options.fast_rays)
        # The same surfaces under live lights alone, for the direct light that no E holds.
        self._live_world = copy.copy(self._world)
        self._live_world.lights = make_lights(_under_live_lights(scene), mesh)
        self._lod = mi.UInt32(CAMERA_LOD) if self._world.geometry.has_lods else None
        self._camera, self._options = camera, options
        self._seed = Seed(options.seed).child("render").uint32()

    def look(self, rows: slice) -> SeenPlaces:
        """A band of the picture."""
        width, spp = self._options.width, self._options.spp
        n_pixels = (rows.stop - rows.start) * width
        lane = dr.arange(mi.UInt32, n_pixels * spp)
        local = lane // dr.opaque(mi.UInt32, spp)
        found = self._samples(local + dr.opaque(mi.UInt32, rows.start * width), lane - local * spp)
        dr.eval(found)
        stopped, other, asks, position, normal, factor, behind = found
        chosen = np.flatnonzero(np.array(asks))
        share = np.float32(1.0 / spp)
        light = _rows(other).reshape(n_pixels, spp, 3).sum(axis=1) * share
        return SeenPlaces(
            rows,
            np.array(stopped).reshape(rows.stop - rows.start, width, spp).mean(axis=2, dtype=np.float32),
            light.reshape(rows.stop - rows.start, width, 3),
            chosen // spp,
            _rows(position)[chosen],
            _rows(normal)[chosen],
            _rows(factor)[chosen] * share,
            _rows(behind)[chosen] * share if self._world.translucent else None,
        )

    def _samples(
        self, pixel: mi.UInt32, number: mi.UInt32
    ) -> tuple[mi.Bool, mi.Color3f, mi.Bool, mi.Point3f, mi.Vector3f, mi.Color3f, mi.Color3f]:
        """Whether a surface is seen; other light; whether E is asked for; where, and the factors in front
        and behind.
        """
        world, options = self._world, self._options
        seed = hash_u32(pixel ^ hash_u32(dr.opaque(mi.UInt32, self._seed)))
        sampler = Sampler(mi.UInt32(number), mi.UInt32(seed))
        jitter = sampler.next_2d()
        seen = self._follow(*camera_ray(self._camera, options.width, options.height, pixel, jitter), sampler)

        # ---- what the surface does with light ----
        asks = mi.Bool(seen.stopped)
        point = world.point(seen.triangle, seen.bary, asks, seen.back)
        reflected = seen.weight * world.appearance(seen.triangle, seen.bary, asks).reflectance
        live = direct(self._live_world, point, seen.sampler, mi.Float(1.0), asks).light
        other = seen.other + dr.select(asks, reflected * live, 0.0)
        factor, behind = reflected * (1.0 / math.pi), mi.Color3f(0.0)
        if point.sides is not None:
            factor, behind = factor * point.sides.front, factor * point.sides.behind
        asks &= dr.max(dr.maximum(factor, behind)) > 0.0
        return seen.stopped, other, asks, point.position, point.ns, factor, behind

    def _follow(self, origin: mi.Point3f, direction: mi.Vector3f, sampler: Sampler) -> _Sight:
        """To where a ray stops, or out of the scene."""
        start = _Sight(
            origin=mi.Point3f(origin),
            direction=mi.Vector3f(direction),
            throughput=mi.Color3f(1.0),
            other=mi.Color3f(0.0),
            sampler=sampler,
            triangle=mi.UInt32(0),
            bary=mi.Point2f(0.0),
            back=mi.Bool(False),
            stopped=mi.Bool(False),
            weight=mi.Color3f(0.0),
            segments=mi.UInt32(0),
            active=mi.Bool(True),
        )

        def step(ray: _Sight) -> tuple[_Sight]:
            return (self._advance(ray),)

        return dr.while_loop(state=(start,), cond=lambda ray: ray.active, body=step, label="sight")[0]

    def _advance(self, ray: _Sight) -> _Sight:
        """One segment: to the next surface, and through it or not."""
        world = self._world
        hit = world.geometry.intersect(ray.origin, ray.direction, ray.active, self._lod)
        missed, met = ray.active & ~hit.valid, ray.active & hit.valid
        if world.lights.environment is not None:
            backdrop = world.lights.environment.backdrop(ray.direction, missed)
            ray.other += dr.select(missed, ray.throughput * backdrop, 0.0)
        record = world.record(hit.triangle, hit.bary, met)
        back = dr.dot(record.ng, ray.direction) > 0.0

        # ---- let through ----
        passes, stop_weight = met & back & ((record.flags & DOUBLE_SIDED) == 0), mi.Float(1.0)
        if world.filters:
            thin = met & ((record.flags & FILTERS) != 0)
            looks = world.appearance(hit.triangle, hit.bary, thin)
            probability = looks.pass_probability
            filtered = thin & (ray.sampler.next_1d() < probability)
            stop_weight = dr.select(thin, dr.rcp(dr.maximum(1.0 - probability, 1e-6)), 1.0)
            tint = looks.through / dr.maximum(probability, 1e-6)
            ray.throughput = dr.select(filtered, ray.throughput * tint, ray.throughput)
            passes |= filtered

        # ---- stopped ----
        stops = met & ~passes
        weight = ray.throughput * stop_weight
        ray.other += dr.select(stops, weight * world.emission(hit.triangle, hit.bary, back, stops), 0.0)
        ray.weight = dr.select(stops, weight, ray.weight)
        ray.stopped |= stops
        ray.triangle = dr.select(stops, hit.triangle, ray.triangle)
        ray.bary = dr.select(stops, hit.bary, ray.bary)
        ray.back = dr.select(stops, back, ray.back)

        beyond = world.geometry.step_past(ray.origin, ray.direction, hit.t)
        ray.origin = dr.select(passes, beyond, ray.origin)
        ray.segments += 1
        ray.active = passes & (ray.segments < _MAX_SEGMENTS)
        return ray


def _under_live_lights(scene: Scene) -> Scene:
    """Without every source whose first bounce is somebody's E."""
    lights = tuple(
        light if light.mode in ("mixed", "realtime") else replace(light, mode="off") for light in scene.lights
    )
    dark = tuple(replace(material, emission=(0.0, 0.0, 0.0)) for material in scene.materials)
    return replace(scene, lights=lights, materials=dark, environment=None)


def _rows(columns: mi.Color3f) -> F32:
    """(N, 3) on the host."""
    return np.ascontiguousarray(np.array(columns).T, np.float32)
