"""The lightmap bake: from a scene and its layout to E/π in every texel."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from irradia.bake.directional_modes import MODES
from irradia.bake.options import MAX_SAMPLES, BakeOptions, Mode
from irradia.bake.plan import plan_epochs, slice_bounds
from irradia.bake.progressive import Pass, ProgressiveBake
from irradia.bake.rounds import PERCENTILE, ROUND, AdaptiveRounds, Rounds, UniformRounds
from irradia.bake.texels import TexelSet
from irradia.core import InputError, Progress, Seed, silent_progress
from irradia.scene.layout import LightmapLayout
from irradia.scene.merge import MergedMesh, merge
from irradia.scene.types import F32, U32, Camera, Light, Scene

if TYPE_CHECKING:
    from irradia.bake.directional import DirectionalMaps
    from irradia.bake.finish import Finisher
    from irradia.transport.texel_light import TexelLight
    from irradia.transport.texel_noise import NoiseMeter

__all__ = ["BakeOptions", "LightmapBake", "LightmapResult", "Selection", "bake_lightmap", "start_bake"]


@dataclass(frozen=True)
class Selection:
    """What of a lightmap is baked, and in which order.

    Attributes:
        view: Texels that this camera sees are finished first.
        instances: (I,) which instances get the result's rays; None for all. The others are traced
            as far as the light of the chosen ones needs.
        covered: Numbers of covered texels that do; None for all.
        shard: (i, n): trace the i-th of n parts of the result's rays, counted from 1.
    """

    view: Camera | None = None
    instances: NDArray[np.bool_] | None = None
    covered: U32 | None = None
    shard: tuple[int, int] | None = None


@dataclass(frozen=True)
class LightmapResult:
    """A baked lightmap.

    Attributes:
        texels: Which texels there are.
        irradiance_over_pi: (N, 3) as traced: linear, not denoised.
        hidden_share: (N,) share of each texel's sub-samples that lie inside something; the light
            is that of the others.
        sample_count: (N,) rays that make the result.
        pages: (P, H, W, 3) finished: denoised where asked, dilated.
        directional: Maps of the light's direction, where they were asked for.
        stats: What the bake did and how fast; plain values, fit for JSON.
    """

    texels: TexelSet
    irradiance_over_pi: F32
    hidden_share: F32
    sample_count: U32
    pages: F32
    stats: dict[str, Any]
    directional: DirectionalMaps | None = None

    @property
    def valid(self) -> NDArray[np.bool_]:
        """(N,) whether the texel sees the scene rather than the inside of a wall."""
        return self.hidden_share < 1.0

    @property
    def raw_pages(self) -> F32:
        """(P, H, W, 3) as traced, 0 outside covered texels."""
        return self.texels.to_pages(self.irradiance_over_pi)

    @property
    def coverage(self) -> F32:
        """(P, H, W) share of each texel that charts cover; 0 where the texel is invalid."""
        return self.texels.to_pages(np.where(self.valid, self.texels.coverage, np.float32(0.0)))


@dataclass(frozen=True)
class LightmapBake:
    """A bake in the making: iterate over :meth:`passes`, then take the :meth:`result`.

    Attributes:
        mesh, layout, texels, light: The scene, what is baked and where, and its kernels.
        hidden_share: See :class:`LightmapResult`.
        bake: The passes.
        meter: Noise of the result so far.
    """

    options: BakeOptions
    mesh: MergedMesh
    layout: LightmapLayout
    texels: TexelSet
    light: TexelLight
    hidden_share: F32
    bake: ProgressiveBake
    meter: NoiseMeter

    def passes(self, progress: Progress | None = None) -> Iterator[Pass]:
        """Runs the bake from where it stands; see :class:`Pass` for what each tells."""
        return self.bake.passes(progress or silent_progress())

    def result(self, progress: Progress | None = None) -> LightmapResult:
        """The map as it is now, finished for use."""
        progress = progress or silent_progress()
        estimate = self.light.to_host(self.bake.estimate())
        valid = self.hidden_share < 1.0
        finisher = self._finisher(valid, progress)
        pages = finisher.irradiance(estimate)
        directional = self._directional(pages, valid, finisher, progress)
        counts = self.bake.sample_counts()
        return LightmapResult(
            self.texels, estimate, self.hidden_share, counts, pages, self.stats(), directional
        )

    def _finisher(self, valid: NDArray[np.bool_], progress: Progress) -> Finisher:
        from irradia.bake.finish import Finisher, FinishOptions
        from irradia.bake.seam_points import find_seam_points

        options = FinishOptions(denoise=self.options.denoise, seams=self.options.seams)
        seams = None
        if options.seams:
            with progress.stage("seams"):
                seams = find_seam_points(self.mesh, self.layout)
        return Finisher(self.texels, valid, options, progress, seams=seams)

    def _directional(
        self, pages: F32, valid: NDArray[np.bool_], finisher: Finisher, progress: Progress
    ) -> DirectionalMaps | None:
        mode = self.options.directional
        if mode is None:
            return None
        from irradia.bake.directional import finish_directional, texel_normals

        return finish_directional(
            mode,
            self.texels,
            pages,
            self.bake.moments(),
            texel_normals(self.mesh, self.texels),
            valid,
            denoise=self.options.denoise,
            progress=progress,
            finisher=finisher,
        )

    def stats(self) -> dict[str, Any]:
        """What the bake did and how fast; plain values, fit for JSON."""
        now, light = self.bake.progression, self.light
        seconds = max(now.spent_s, 1e-9)
        served = self.bake.sample_counts()[self.bake.texels]
        n_direct = int(np.array(now.total.samples, np.int64).sum()) if light.world.lights.any else 0
        return {
            "integrator": self.options.integrator,
            "mode": self.options.mode,
            "texels": light.n_texels,
            "samples_per_texel": float(served.mean()) if len(served) else 0.0,
            "direct_samples_per_texel": n_direct / max(light.n_texels, 1),
            "complete": self.bake.complete,
            "epochs": [{"rays": e.rays, "mean": e.mean} for e in now.epochs],
            "launches_per_pass": self.bake.launches,
            "tracing_seconds": seconds,
            "samples_per_second": now.n_rays / seconds,
            "rays_per_second": (now.n_rays + n_direct) / seconds,
            "noise_p95": self._noise(),
            "valid_share": float((self.hidden_share < 1.0).mean()),
            "clamped_materials": light.world.clamped_materials,
        }

    def _noise(self) -> float | None:
        """95th percentile of the result's relative standard error, where rounds have shown it."""
        if not self.meter.knows:
            return None
        error = self.meter.relative_error(self.bake.progression.total)[self.bake.texels]
        return float(np.percentile(error, PERCENTILE)) if len(error) else None


def bake_lightmap(
    scene: Scene,
    layout: LightmapLayout,
    options: BakeOptions,
    progress: Progress | None = None,
    selection: Selection | None = None,
) -> LightmapResult:
    """Bakes a lightmap from beginning to end.

    Raises:
        InputError: If nothing in the scene takes a lightmap.
    """
    bake = start_bake(scene, layout, options, progress, selection)
    for _ in bake.passes(progress):
        pass
    return bake.result(progress)


def start_bake(
    scene: Scene,
    layout: LightmapLayout,
    options: BakeOptions,
    progress: Progress | None = None,
    selection: Selection | None = None,
) -> LightmapBake:
    """Prepares everything up to the first ray.

    Raises:
        InputError: If nothing in the scene takes a lightmap.
    """
    from irradia.transport.texel_noise import NoiseMeter

    progress, selection = progress or silent_progress(), selection or Selection()
    scene = replace(scene, lights=lights_in_mode(scene.lights, options.mode))
    with progress.stage("texels"):
        mesh, texels = cover(scene, layout)
    with progress.stage("ray tracing set-up"):
        light = prepare(scene, mesh, layout, texels, options)
    _warn_of_clamped(light, progress)
    with progress.stage("hidden texels"):
        hidden_share = light.drop_hidden_subsamples()
    valid = hidden_share < 1.0
    chosen = valid & _chosen_texels(texels, mesh, selection)
    traced = _indices(valid if options.cached else chosen)
    with progress.stage("kernels"):
        light.warm_up(traced, light.cache_of_nothing(options.cached, one_bounce=options.mode == "direct"))
    meter = NoiseMeter(texels.pixel, texels.chart, (texels.n_pages, texels.height_px, texels.width_px))
    queues = _queues(light, chosen, selection, progress)
    samples = options.planned_samples
    bake = ProgressiveBake(
        light,
        plan_epochs(
            samples,
            cached=options.cached and options.mode != "direct",
            hurry=selection.view is not None,
        ),
        _rounds(queues, options, selection, lambda: meter.relative_error(bake.progression.total)),
        meter,
        traced,
        Seed(options.seed).child("bake"),
        samples=samples,
        time_s=options.time_s,
        one_bounce=options.mode == "direct",
    )
    return LightmapBake(options, mesh, layout, texels, light, hidden_share, bake, meter)


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


def _indices(mask: NDArray[np.bool_]) -> U32:
    return np.flatnonzero(mask).astype(np.uint32)


def _rounds(
    queues: list[U32], options: BakeOptions, selection: Selection, relative_error: Callable[[], F32]
) -> Rounds:
    if options.watches_noise:
        samples = options.samples or MAX_SAMPLES
        return AdaptiveRounds(queues, relative_error, noise=options.noise, samples=samples)
    if options.samples is None:
        return UniformRounds(queues, range(ROUND, MAX_SAMPLES + 1, ROUND))
    ends = slice_bounds(options.samples, sum(len(queue) for queue in queues))
    if selection.shard is None:
        return UniformRounds(queues, ends)
    number, count = selection.shard
    if count > len(ends):
        raise InputError(
            f"expected at most {len(ends)} shards for this bake, found {count}",
            where="--shard",
            fix="More samples or texels can be divided among more machines.",
        )
    first, last = ((number + i) * len(ends) // count for i in (-1, 0))
    return UniformRounds(queues, ends, first=first, last=last)
