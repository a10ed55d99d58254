"""The integrator: radiance along rays through a diffuse world.

With no cache this is an unbiased path tracer (Kajiya 1986) with next-event estimation, multiple
importance sampling by the balance heuristic (Veach 1995) and Russian roulette. With a cache, a ray
that stops on a mapped surface takes its radiance from there and ends; it goes on as a path only
from surfaces without texels. Each source of light is counted once:

    punctual lights           by next-event estimation alone: rays can't meet them
    emission, environment     by both, weighted n·p / (n·p + n'·p')
    sources that next-event   by rays alone, weight 1: their density is 0
    estimation doesn't sample
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Protocol

from irradia.transport.backend import dr, mi
from irradia.transport.geometry import Hit, SurfacePoint
from irradia.transport.hemispheres import COSINE, Hemisphere
from irradia.transport.materials import DOUBLE_SIDED, EMISSIVE, FILTERS, TRANSLUCENT, UNLIT
from irradia.transport.sampling import Sampler, to_world
from irradia.transport.sides import mirrored_to_front, pick_side
from irradia.transport.world import HAS_TEXEL, TriangleRecord, World

_ROULETTE_FROM = 4
_MAX_SEGMENTS = 1024  # a ray caught between numerically coincident panes ends here


class LightCache(Protocol):
    """Stored light of mapped surfaces.

    Attributes:
        everywhere: Whether it answers for surfaces without texels too, so that no path goes on.
    """

    everywhere: bool

    def outgoing(self, world: World, hit: Hit, record: TriangleRecord, active: mi.Bool) -> mi.Color3f:
        """Radiance that leaves the front of a surface, emission not counted."""
        ...


@dataclass
class Segment:
    """A ray on its way, and what it has gathered.

    Attributes:
        origin, direction: The ray.
        throughput: What its radiance is multiplied by.
        radiance: Gathered so far.
        pdf: Solid-angle density with which its direction was drawn.
        nee_ratio: Next-event samples per ray where it started; 0 for a camera ray, so that all
            it meets weighs 1.
        travelled: Distance since then, through what let it pass.
        bounces, segments: Counters.
        sampler: Its random numbers.
        active: Whether it goes on.
        lod: Level of detail of the surface where it started; None where nothing has any.
    """

    origin: mi.Point3f
    direction: mi.Vector3f
    throughput: mi.Color3f
    radiance: mi.Color3f
    pdf: mi.Float
    nee_ratio: mi.Float
    travelled: mi.Float
    bounces: mi.UInt32
    segments: mi.UInt32
    sampler: Sampler
    active: mi.Bool
    lod: mi.UInt32 | None = None


def start(
    origin: mi.Point3f,
    direction: mi.Vector3f,
    pdf: mi.Float,
    nee_ratio: mi.Float,
    sampler: Sampler,
    active: mi.Bool,
    lod: mi.UInt32 | None = None,
) -> Segment:
    """A ray that has gathered nothing yet."""
    zero = mi.UInt32(0)
    return Segment(
        origin=mi.Point3f(origin),
        direction=mi.Vector3f(direction),
        throughput=mi.Color3f(1.0),
        radiance=mi.Color3f(0.0),
        pdf=mi.Float(pdf),
        nee_ratio=mi.Float(nee_ratio),
        travelled=mi.Float(0.0),
        bounces=zero,
        segments=mi.UInt32(0),
        sampler=Sampler(mi.UInt32(sampler.index), mi.UInt32(sampler.seed)),
        active=mi.Bool(active),
        lod=lod,
    )


def trace(
    world: World, ray: Segment, cache: LightCache | None = None, *, cull_backs: bool = False
) -> Segment:
    """Follows rays to their end.

    Args:
        world: The scene.
        ray: From :func:`start`.
        cache: Light of mapped surfaces, or None for a pure path tracer.
        cull_backs: Camera rays pass through single-sided surfaces seen from behind, as in engines.
    """
    if world.geometry.has_lods:
        ray.lod = mi.UInt32(0 if ray.lod is None else ray.lod)
    if cache is not None and world.straight and not cull_backs:
        return _advance(world, ray, cache, cull_backs)

    def step(ray: Segment) -> tuple[Segment]:
        return (_advance(world, ray, cache, cull_backs),)

    return dr.while_loop(state=(ray,), cond=lambda ray: ray.active, body=step, label="path")[0]


def _advance(world: World, ray: Segment, cache: LightCache | None, cull_backs: bool) -> Segment:
    """One segment: to the next surface, and what happens there."""
    hit = world.geometry.intersect(ray.origin, ray.direction, ray.active, ray.lod)

    # ---- out of the scene ----
    missed = ray.active & ~hit.valid
    sky, sky_pdf = world.lights.environment_radiance(ray.direction, missed)
    if cull_backs and world.lights.environment is not None:
        first = missed & (ray.bounces == 0)
        sky = dr.select(first, world.lights.environment.backdrop(ray.direction, first), sky)
    ray.radiance += dr.select(missed, ray.throughput * sky * _ray_weight(ray, sky_pdf), 0.0)

    # ---- on a surface: most are opaque, shine not themselves, and their light is known ----
    met = ray.active & hit.valid
    record = world.record(hit.triangle, hit.bary, met)
    back = dr.dot(record.ng, ray.direction) > 0.0
    ray.active = mi.Bool(False)
    if cache is None:
        return _meet(world, ray, hit, record, back, met, cache, cull_backs)
    plain = met & ((record.flags & (FILTERS | EMISSIVE | UNLIT)) == 0)
    known = plain & ~back & _answers(cache, record)
    ray.radiance += dr.select(known, ray.throughput * cache.outgoing(world, hit, record, known), 0.0)
    special = met & ~known
    if not cull_backs:
        special &= ~(plain & back & ((record.flags & (DOUBLE_SIDED | TRANSLUCENT)) == 0))
    if world.plain and not cull_backs:
        return ray

    # ---- the others, jumped over by packets that have none ----
    def meet(ray: Segment, hit: Hit, record: TriangleRecord, back: mi.Bool) -> tuple[Segment]:
        return (_meet(world, ray, hit, record, back, mi.Bool(True), cache, cull_backs),)

    def skip(ray: Segment, *_: object) -> tuple[Segment]:
        return (ray,)

    return dr.if_stmt((ray, hit, record, back), special, meet, skip, label="special surface")[0]


def _meet(
    world: World,
    ray: Segment,
    hit: Hit,
    record: TriangleRecord,
    back: mi.Bool,
    active: mi.Bool,
    cache: LightCache | None,
    cull_backs: bool,
) -> Segment:
    """A surface of any kind: passes light, emits, blocks, knows its light or sends the path on."""
    one_sided = (record.flags & DOUBLE_SIDED) == 0

    # ---- let through ----
    passes, stop_weight = mi.Bool(False), mi.Float(1.0)
    if world.filters:
        thin = active & ((record.flags & FILTERS) != 0)
        appearance = world.appearance(hit.triangle, hit.bary, thin)
        probability = appearance.pass_probability
        passes = thin & (ray.sampler.next_1d() < probability)
        stop_weight = dr.select(thin & ~passes, dr.rcp(dr.maximum(1.0 - probability, 1e-6)), 1.0)
        tint = appearance.through / dr.maximum(probability, 1e-6)
        ray.throughput = dr.select(passes, ray.throughput * tint, ray.throughput)
    if cull_backs:
        passes = passes | (active & back & one_sided & (ray.bounces == 0))
    stops = active & ~passes

    # ---- emission met on the way, weighed against next-event estimation ----
    ray.travelled += dr.select(active, hit.t, 0.0)
    cos_light = dr.dot(record.ng, ray.direction) * dr.rsqrt(dr.maximum(dr.squared_norm(record.ng), 1e-37))
    started = ray.origin + ray.direction * (hit.t - ray.travelled)
    light_pdf = world.lights.area_pdf(hit.triangle, started, ray.travelled, cos_light, stops)
    emitted = world.emission(hit.triangle, hit.bary, back, stops)
    weight = stop_weight * _ray_weight(ray, light_pdf)
    ray.radiance += dr.select(stops, ray.throughput * emitted * weight, 0.0)

    # ---- an opaque back reflects nothing; a mapped front may know its light ----
    dark = back & one_sided
    if world.translucent:
        dark &= (record.flags & TRANSLUCENT) == 0
    ends = stops & (dark | ((record.flags & UNLIT) != 0))
    if cache is not None:
        known = stops & ~ends & _answers(cache, record)
        if not cache.everywhere:
            known &= ~back
        ray.radiance += dr.select(known, ray.throughput * cache.outgoing(world, hit, record, known), 0.0)
        ends |= known

    # ---- otherwise the path goes on ----
    if cache is not None and world.straight and not cull_backs:
        return ray
    ray = _bounce(world, ray, hit, back, stop_weight, stops & ~ends)
    beyond = world.geometry.step_past(ray.origin, ray.direction, hit.t)
    ray.origin = dr.select(passes, beyond, ray.origin)
    ray.segments += 1
    ray.active = (ray.active | passes) & (ray.segments < _MAX_SEGMENTS)
    return ray


def _answers(cache: LightCache, record: TriangleRecord) -> mi.Bool:
    """Whether the cache knows what leaves a surface's front."""
    return mi.Bool(True) if cache.everywhere else (record.flags & HAS_TEXEL) != 0


def _ray_weight(ray: Segment, light_pdf: mi.Float) -> mi.Float:
    """Balance heuristic for light that a ray met."""
    return ray.pdf / dr.maximum(ray.pdf + ray.nee_ratio * light_pdf, 1e-30)


def _bounce(
    world: World, ray: Segment, hit: Hit, back: mi.Bool, stop_weight: mi.Float, active: mi.Bool
) -> Segment:
    """Next-event estimation at a surface and a new direction from it."""
    point = world.point(hit.triangle, hit.bary, active, back)
    reflectance = world.appearance(hit.triangle, hit.bary, active).reflectance
    throughput = ray.throughput * reflectance * stop_weight
    active = active & (dr.max(throughput) > 0.0)
    arriving = direct(world, point, ray.sampler, mi.Float(1.0), active).light
    ray.radiance += dr.select(active, throughput * arriving, 0.0)

    leaving = draw_ray(point, ray.sampler)
    throughput = throughput * leaving.weight
    goes_on = active & leaving.above
    survival = dr.select(ray.bounces >= _ROULETTE_FROM, dr.minimum(dr.max(throughput), 0.95), 1.0)
    goes_on &= ray.sampler.next_1d() < survival

    ray.throughput = dr.select(goes_on, throughput / survival, ray.throughput)
    ray.origin = dr.select(goes_on, leaving.origin, ray.origin)
    ray.direction = dr.select(goes_on, leaving.direction, ray.direction)
    ray.pdf = dr.select(goes_on, leaving.pdf, ray.pdf)
    ray.nee_ratio = dr.select(goes_on, 1.0, ray.nee_ratio)
    ray.travelled = dr.select(goes_on, 0.0, ray.travelled)
    ray.bounces = dr.select(active, ray.bounces + 1, ray.bounces)
    if point.lod is not None:
        ray.lod = dr.select(goes_on, point.lod, ray.lod)
    ray.active = goes_on
    return ray


@dataclass
class LeavingRay:
    """A ray from a surface point, by which E/π is sampled.

    Attributes:
        origin, direction: The ray.
        pdf: Solid-angle density of its direction.
        arrives_from: The direction above the surface that its light counts as coming from.
        weight: What its radiance is multiplied by: 1 for cosine-distributed rays, but for surfaces
            that light comes through.
        above: Whether the ray leaves the surface at all.
    """

    origin: mi.Point3f
    direction: mi.Vector3f
    pdf: mi.Float
    arrives_from: mi.Vector3f
    weight: mi.Color3f
    above: mi.Bool


def draw_ray(point: SurfacePoint, sampler: Sampler, hemisphere: Hemisphere = COSINE) -> LeavingRay:
    """Draws a ray from the front, or from behind where light comes through diffusely."""
    chosen, weight = point, mi.Color3f(1.0)
    if point.sides is not None:
        side = pick_side(point, point.sides, sampler)
        chosen, weight = side.point, side.weight
    local = hemisphere.draw(sampler.next_2d())
    pdf = hemisphere.density(local.z)
    if hemisphere is not COSINE:
        weight = weight * (local.z * (1.0 / math.pi) / pdf)
    direction = to_world(chosen.ns, local)
    above = (dr.dot(direction, chosen.ng) > 0.0) & (local.z > 0.0)
    arrives_from = direction if point.sides is None else mirrored_to_front(direction, point.ns)
    return LeavingRay(chosen.origin, direction, pdf, arrives_from, weight, above)


@dataclass
class Arrival:
    """One next-event sample.

    Attributes:
        light: What it adds to E/π, weighted against rays drawn.
        direction: Where it comes from; above the surface, also for light that comes through it.
        live: Whether its light is lit live, so that its first bounce stays out of the maps.
    """

    light: mi.Color3f
    direction: mi.Vector3f
    live: mi.Bool


def direct(
    world: World,
    point: SurfacePoint,
    sampler: Sampler,
    nee_ratio: mi.Float,
    active: mi.Bool,
    hemisphere: Hemisphere = COSINE,
) -> Arrival:
    """One next-event sample of E/π at a surface point, MIS-weighted against rays of a distribution."""
    lights = world.lights
    if not lights.any:
        return Arrival(mi.Color3f(0.0), mi.Vector3f(0.0, 0.0, 1.0), mi.Bool(False))
    if point.sides is not None:
        side = pick_side(point, point.sides, sampler)
        arrival = direct(world, side.point, sampler, nee_ratio, active, hemisphere)
        direction = mirrored_to_front(arrival.direction, point.ns)
        return Arrival(arrival.light * side.weight, direction, arrival.live)
    u, pick = sampler.next_2d(), sampler.next_2d().x
    sample = lights.sample(world.geometry, world.emission_seen_from(point), point, pick, u, active)
    cosine = dr.dot(point.ns, sample.direction)
    above = active & (cosine > 0.0) & (dr.dot(point.ng, sample.direction) > 0.0)
    above &= dr.max(sample.weight) > 0.0
    ray_pdf = hemisphere.density(cosine)
    weighed = nee_ratio * sample.pdf
    weight = dr.select(sample.pdf > 0.0, weighed / dr.maximum(weighed + ray_pdf, 1e-30), 1.0)
    arriving = world.transmittance(point.origin, sample.direction, sample.distance, above, point.lod)
    light = dr.select(above, sample.weight * arriving * (cosine * (1.0 / math.pi) * weight), 0.0)
    return Arrival(light, sample.direction, lights.is_live(sample.punctual, above))
