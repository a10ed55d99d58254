"""Everything that stands between a scene and its first ray."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from irradia.bake.directional_modes import MODES
from irradia.bake.lightmap import LightmapBake, Selection
from irradia.bake.options import MAX_SAMPLES, BakeOptions, Mode
from irradia.bake.plan import lanes_per_texel, plan_epochs, rays_per_pass, slice_bounds
from irradia.bake.progressive import ProgressiveBake
from irradia.bake.regions import find_regions
from irradia.bake.rounds import ROUND, AdaptiveRounds, Rounds, UniformRounds
from irradia.bake.shadow_mask import plan_shadow_mask
from irradia.bake.texels import TexelSet
from irradia.core import InputError, Progress, Seed
from irradia.scene.layout import LightmapLayout
from irradia.scene.merge import MergedMesh, merge
from irradia.scene.types import F32, U32, Light, Scene

if TYPE_CHECKING:
    from irradia.transport.texel_light import TexelLight
    from irradia.transport.texel_sums import Lanes


def set_up(
    scene: Scene, layout: LightmapLayout, options: BakeOptions, progress: Progress, selection: Selection
) -> LightmapBake:
    """Lists texels, uploads the scene, compiles kernels and decides who gets rays.

    Raises:
        InputError: If nothing in the scene takes a lightmap.
    """
    from irradia.transport.texel_grid import TexelGrid
    from irradia.transport.texel_noise import NoiseMeter

    with progress.stage("texels"):
        mesh, texels = cover(scene, layout)
    lights = lights_in_mode(scene.lights, options.mode)
    masks = plan_shadow_mask(mesh, lights)
    for note in masks.notes(lights):
        progress.say(f"note: {note}")
    scene = replace(scene, lights=masks.lights(lights))
    with progress.stage("ray tracing set-up"):
        light = prepare(scene, mesh, layout, texels, options)
    _warn_of_clamped(light, progress)
    with progress.stage("hidden texels"):
        grid = TexelGrid(texels.pixel, texels.chart, texels.width_px, texels.height_px)
        footprints = light.clear_footprints(grid)
        light.give_back()
        region = find_regions(texels, footprints.visible, footprints.cut_off, footprints.moved)
        light.keep_sides_apart(footprints, region)
    valid = footprints.valid
    chosen = valid & _chosen_texels(texels, mesh, selection)
    traced = _indices(valid if options.cached else chosen)
    queues = _queues(light, chosen, selection, progress)
    with progress.stage("kernels"):
        _compile(light, traced, queues, options)
    meter = NoiseMeter(texels.pixel, texels.chart, (texels.n_pages, texels.height_px, texels.width_px))
    samples = options.planned_samples
    plan = plan_epochs(
        samples, cached=options.cached and not options.one_bounce, hurry=selection.view is not None
    )

    def relative_error() -> F32:
        return meter.relative_error(bake.progression.total)

    bake = ProgressiveBake(
        light,
        plan,
        _rounds(queues, options, selection.shard, sum(plan.growing), relative_error),
        meter,
        traced,
        Seed(options.seed).child("bake"),
        samples=samples,
        time_s=options.time_s,
        one_bounce=options.one_bounce,
    )
    if options.directional is None:
        texels = texels.without_samples()  # they are on the device now
    return LightmapBake(
        options, mesh, layout, texels, light, footprints, bake, meter, scene.lights, masks, region
    )


def _compile(light: TexelLight, traced: U32, queues: Sequence[U32], options: BakeOptions) -> None:
    """Compiles what the passes will run; nothing stays on the device but the kernels."""
    nothing = light.cache_of_nothing(options.cached, one_bounce=options.one_bounce)
    light.warm_up(_lanes(light, traced), nothing)
    for queue in queues:
        if len(queue):
            light.warm_up(_lanes(light, queue), nothing, last_epoch=True)


def cover(scene: Scene, layout: LightmapLayout) -> tuple[MergedMesh, TexelSet]:
    """Merges the scene and lists its covered texels."""
    from irradia.bake.rasterise import rasterise

    mesh = merge(scene, layout)
    texels = rasterise(mesh, layout)
    if len(texels.pixel) == 0:
        raise InputError("nothing in the scene takes a lightmap", where=scene.name)
    return mesh, texels


def prepare(
    scene: Scene, mesh: MergedMesh, layout: LightmapLayout, texels: TexelSet, options: BakeOptions
) -> TexelLight:
    """Uploads the scene and its texels."""
    from irradia.scene.tangents import world_tangents
    from irradia.transport.channels import Channels
    from irradia.transport.frames import TangentFrames
    from irradia.transport.moments import MOMENTS
    from irradia.transport.normal_maps import NormalMaps
    from irradia.transport.texel_light import TexelLight
    from irradia.transport.world import World

    world = World(scene, mesh, (layout.width_px, layout.height_px), robust=not options.fast_rays)
    frames = normal_maps = None
    moments = MOMENTS[MODES[options.directional].moments]() if options.directional else None
    if options.normal_maps or (moments and moments.tangent_space):
        frames = TangentFrames(world_tangents(scene, mesh, layout))
        normal_maps = NormalMaps(scene, frames) if options.normal_maps else None
    live = any(light.mode in ("mixed", "realtime") for light in scene.lights)
    channels = Channels(live, options.indirect_clamp, moments)
    return TexelLight(
        world,
        texels.pixel,
        texels.samples,
        options.nee_ratio,
        channels,
        normal_maps=normal_maps,
        frames=frames if moments and moments.tangent_space else None,
    )


def lights_in_mode(lights: tuple[Light, ...], mode: Mode) -> tuple[Light, ...]:
    """Punctual lights with the part that a bake of one mode gives them."""
    if mode == "indirect":
        return tuple(replace(light, mode="realtime") if light.mode == "baked" else light for light in lights)
    if mode == "direct":
        return tuple(replace(light, mode="baked") if light.mode != "off" else light for light in lights)
    return lights


def _warn_of_clamped(light: TexelLight, progress: Progress) -> None:
    names = ", ".join(name or "an unnamed material" for name in light.world.clamped_materials)
    if names:
        progress.say(f"note: reflectance is limited to 0.98 in {names}")


def _chosen_texels(texels: TexelSet, mesh: MergedMesh, selection: Selection) -> NDArray[np.bool_]:
    chosen = np.ones(len(texels.pixel), np.bool_)
    if selection.covered is not None:
        chosen[:] = False
        chosen[selection.covered] = True
    if selection.instances is not None:
        chosen &= selection.instances[mesh.instance[texels.triangle]]
    return chosen


def _queues(
    light: TexelLight, chosen: NDArray[np.bool_], selection: Selection, progress: Progress
) -> list[U32]:
    """Lists of texels in order of importance."""
    if selection.view is None:
        return [_indices(chosen)]
    with progress.stage("what the camera sees"):
        seen = light.seen_from(selection.view)
    progress.say(f"The camera sees {float(seen[chosen].mean()):.0%} of the texels: these come first.")
    return [_indices(chosen & seen), _indices(chosen & ~seen)]


def _lanes(light: TexelLight, texels: U32) -> Lanes:
    n = len(texels)
    return light.lanes(texels, lanes_per_texel(n, rays_per_pass(n), light.wanted_lanes))


def _indices(mask: NDArray[np.bool_]) -> U32:
    return np.flatnonzero(mask).astype(np.uint32)


def _rounds(
    queues: list[U32],
    options: BakeOptions,
    shard: tuple[int, int] | None,
    early_rays: int,
    relative_error: Callable[[], F32],
) -> Rounds:
    if options.watches_noise:
        samples = options.samples or MAX_SAMPLES
        return AdaptiveRounds(
            queues, relative_error, noise=options.noise, samples=samples, early_rays=early_rays
        )
    if options.samples is None:
        open_end = range(ROUND, MAX_SAMPLES + 1, ROUND)
        return UniformRounds(queues, [open_end] * len(queues), early_rays=early_rays)
    # What the camera sees comes in few and large launches; the rest in small portions as they are owed.
    ends = [slice_bounds(options.samples, len(queues[0]))]
    ends += [slice_bounds(options.samples, sum(len(queue) for queue in queues)) for _ in queues[1:]]
    return UniformRounds(queues, ends, early_rays=early_rays, part=_part(shard, len(ends[0])))


def _part(shard: tuple[int, int] | None, n_slices: int) -> tuple[int, int] | None:
    """First and end of a shard's slices."""
    if shard is None:
        return None
    number, count = shard
    if count > n_slices:
        raise InputError(
            f"this bake can be divided into {n_slices} at most, found {count}",
            where="--shard",
            fix="More samples or texels can be divided among more machines.",
        )
    return (number - 1) * n_slices // count, number * n_slices // count
