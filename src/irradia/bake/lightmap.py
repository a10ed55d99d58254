"""The lightmap bake: from a scene and its layout to finished maps."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from irradia.bake.options import BakeOptions
from irradia.bake.progressive import Pass, ProgressiveBake
from irradia.bake.rounds import PERCENTILE
from irradia.bake.shadow_mask import ShadowMaskPlan
from irradia.bake.texels import TexelSet
from irradia.core import Progress, silent_progress
from irradia.scene.layout import LightmapLayout
from irradia.scene.merge import MergedMesh
from irradia.scene.types import F32, U32, Camera, Light, Scene

if TYPE_CHECKING:
    from irradia.bake.directional import DirectionalMaps
    from irradia.bake.finish import Finisher
    from irradia.transport.footprints import Footprints
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
        valid: (N,) whether the texel's light counts; the others take it from their chart.
        sample_count: (N,) rays that make the result.
        pages: (P, H, W, 3) finished: denoised where asked, dilated.
        stats: What the bake did and how fast; plain values, fit for JSON.
        all_light: (P, H, W, 3) with the first bounce of live lights, where there are any: what
            surfaces shine with.
        directional: Maps of the light's direction, where they were asked for.
        shadows: (P, H, W, 4) what arrives of live lights, where any has a channel.
        lights: The scene's, with the part that each has had.
        shadow_channels: For each, its channel of ``shadows`` or None.
        direct: (P, H, W, 3) the part of ``pages`` that baked punctual lights send straight, where it was
            asked for and there are any.
    """

    texels: TexelSet
    irradiance_over_pi: F32
    hidden_share: F32
    valid: NDArray[np.bool_]
    sample_count: U32
    pages: F32
    stats: dict[str, Any]
    all_light: F32 | None = None
    directional: DirectionalMaps | None = None
    shadows: F32 | None = None
    lights: tuple[Light, ...] = ()
    shadow_channels: tuple[int | None, ...] = ()
    direct: F32 | None = None

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
        footprints: What of each texel looks at the scene.
        bake: The passes.
        meter: Noise of the result so far.
        lights: The scene's, with the part that each has.
        masks: Which of them have a shadow mask.
        region: (N,) parts of charts over which light may be taken from texel to texel.
    """

    options: BakeOptions
    mesh: MergedMesh
    layout: LightmapLayout
    texels: TexelSet
    light: TexelLight
    footprints: Footprints
    bake: ProgressiveBake
    meter: NoiseMeter
    lights: tuple[Light, ...]
    masks: ShadowMaskPlan
    region: U32

    @property
    def valid(self) -> NDArray[np.bool_]:
        """(N,) whether a texel's light counts."""
        return self.footprints.valid

    def passes(self, progress: Progress | None = None) -> Iterator[Pass]:
        """Runs the bake from where it stands; see :class:`Pass` for what each tells."""
        return self.bake.passes(progress or silent_progress())

    def estimate(self) -> F32:
        """(N, 3) E/π as known now."""
        return self.light.to_host(self.bake.estimate())

    def result(self, progress: Progress | None = None) -> LightmapResult:
        """The map as it is now, finished for use; ``progress`` shows stages.

        A complete bake gives its memory on the device back first: finishing takes as much again.
        """
        progress = progress or silent_progress()
        estimate, counts, stats = self.estimate(), self.bake.sample_counts(), self.stats()
        moments = None if self.options.directional is None else self.bake.moments()
        live = self.light.to_host(self.bake.live_light()) if self.light.channels.live else None
        if self.bake.complete:
            self.bake.release()
        finisher = self._finisher(progress)
        pages = finisher.irradiance(estimate)
        return LightmapResult(
            self.texels,
            estimate,
            self.footprints.hidden_share,
            self.valid,
            counts,
            pages,
            stats,
            None if live is None else pages + finisher.companion(live, pages, lowest=0.0),
            None if moments is None else self._directional(moments, pages, finisher, progress),
            self._shadows(pages, finisher, progress),
            self.lights,
            self.masks.channels,
            self._direct(pages, finisher, progress),
        )

    def _finisher(self, progress: Progress) -> Finisher:
        from irradia.bake.finish import Finisher, FinishOptions
        from irradia.bake.seam_points import find_seam_points

        options = FinishOptions(denoise=self.options.denoise, seams=self.options.seams)
        seams = None
        if options.seams:
            with progress.stage("seams"):
                seams = find_seam_points(self.mesh, self.layout)
        return Finisher(self.texels, self.valid, options, progress, region=self.region, seams=seams)

    def _directional(
        self, moments: F32, pages: F32, finisher: Finisher, progress: Progress
    ) -> DirectionalMaps | None:
        mode = self.options.directional
        if mode is None:
            return None
        from irradia.bake.directional import finish_directional, texel_normals

        return finish_directional(
            mode,
            self.texels,
            pages,
            moments,
            texel_normals(self.mesh, self.texels),
            self.valid,
            denoise=self.options.denoise,
            progress=progress,
            finisher=finisher,
        )

    def _shadows(self, pages: F32, finisher: Finisher, progress: Progress) -> F32 | None:
        if not self.masks.needed:
            return None
        from irradia.bake.shadow_mask import ShadowMaskOptions, bake_shadow_mask, finish_shadow_mask

        mask = bake_shadow_mask(
            self.light.world,
            self.light.subsamples,
            self.texels,
            self.lights,
            self.masks,
            ShadowMaskOptions(seed=self.options.seed),
            progress,
        )
        return finish_shadow_mask(mask, self.texels, self.valid, pages, finisher, self.region)

    def _direct(self, pages: F32, finisher: Finisher, progress: Progress) -> F32 | None:
        if not self.options.direct_map:
            return None
        from irradia.bake.direct_map import trace_direct_map

        samples, seed = self.options.planned_samples, self.options.seed
        direct = trace_direct_map(self.light, self.mesh, self.lights, samples, seed, progress)
        return None if direct is None else finisher.companion(direct, pages, lowest=0.0)

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
            "noise_p95": self.noise(),
            "clamped_off_share": self.bake.clamped_off_share(),
            "valid_share": float(self.valid.mean()),
            "clamped_materials": light.world.clamped_materials,
        }

    def noise(self) -> float | None:
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
    """Prepares everything up to the first ray; see :mod:`irradia.bake.setup`.

    Raises:
        InputError: If nothing in the scene takes a lightmap.
    """
    from irradia.bake.setup import set_up

    return set_up(scene, layout, options, progress or silent_progress(), selection or Selection())
