"""The lightmap bake: from a scene and its layout to E/π in every texel."""

from __future__ import annotations

import time
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import NDArray

from irradia.bake.epochs import Epoch, EpochPlan, run_epochs
from irradia.bake.texels import TexelSet
from irradia.core import InputError, Progress, Seed, silent_progress
from irradia.scene.layout import LightmapLayout
from irradia.scene.merge import MergedMesh, merge
from irradia.scene.types import Scene

if TYPE_CHECKING:
    from irradia.transport.texel_light import TexelLight

Integrator = Literal["cached", "path"]
_MAX_SAMPLES = 1 << 20


@dataclass(frozen=True)
class BakeOptions:
    """How to bake.

    Attributes:
        samples: Rays per texel that make the result.
        integrator: ``cached`` gather, or the unbiased ``path`` reference.
        direct_samples: Next-event samples per texel; None takes as many as suit ``samples``.
        seed: Root of all random numbers.
        fast_rays: Gives up watertight intersection for speed.
        denoise: Whether the finished pages are denoised.
    """

    samples: int = 64
    integrator: Integrator = "cached"
    direct_samples: int | None = None
    seed: int = 0
    fast_rays: bool = False
    denoise: bool = True

    def __post_init__(self) -> None:
        if not 1 <= self.samples <= _MAX_SAMPLES:
            raise InputError(f"expected 1 to {_MAX_SAMPLES} samples, found {self.samples}", where="--samples")
        if self.integrator not in ("cached", "path"):
            raise InputError(f"expected cached or path, found {self.integrator!r}", where="--integrator")

    @property
    def n_direct(self) -> int:
        """Next-event samples per texel."""
        if self.direct_samples is not None:
            return self.direct_samples
        return self.samples if self.integrator == "path" else max(8, self.samples // 2)


@dataclass(frozen=True)
class LightmapResult:
    """A baked lightmap.

    Attributes:
        texels: Which texels there are.
        irradiance_over_pi: (N, 3) as traced: linear, not denoised.
        hidden_share: (N,) share of each texel's sub-samples that lie inside something; the light
            is that of the others.
        pages: (P, H, W, 3) finished: denoised where asked, dilated.
        stats: What the bake did and how fast; plain values, fit for JSON.
    """

    texels: TexelSet
    irradiance_over_pi: NDArray[np.float32]
    hidden_share: NDArray[np.float32]
    pages: NDArray[np.float32]
    stats: dict[str, Any]

    @property
    def valid(self) -> NDArray[np.bool_]:
        """(N,) whether the texel sees the scene rather than the inside of a wall."""
        return self.hidden_share < 1.0

    @property
    def raw_pages(self) -> NDArray[np.float32]:
        """(P, H, W, 3) as traced, 0 outside covered texels."""
        return self.texels.to_pages(self.irradiance_over_pi)

    @property
    def coverage(self) -> NDArray[np.float32]:
        """(P, H, W) share of each texel that charts cover; 0 where the texel is invalid."""
        return self.texels.to_pages(np.where(self.valid, self.texels.coverage, np.float32(0.0)))


def bake_lightmap(
    scene: Scene, layout: LightmapLayout, options: BakeOptions, progress: Progress | None = None
) -> LightmapResult:
    """Bakes a lightmap.

    Raises:
        InputError: If nothing in the scene takes a lightmap.
    """
    from irradia.bake.finish import finish

    progress = progress or silent_progress()
    with progress.stage("texels"):
        mesh, texels = cover(scene, layout)
    with progress.stage("ray tracing set-up"):
        light = prepare(scene, mesh, layout, texels, options)
    clamped = light.world.clamped_materials
    if clamped:
        names = ", ".join(name or "an unnamed material" for name in clamped)
        progress.say(f"note: reflectance is limited to 0.98 in {names}")
    with progress.stage("hidden texels"):
        hidden_share = light.drop_hidden_subsamples()
    start = time.perf_counter()
    estimate, epochs, launches = _trace(light, options, progress)
    seconds = time.perf_counter() - start
    stats = _stats(light, options, epochs, launches, seconds)
    valid = hidden_share < 1.0
    stats["valid_share"] = float(valid.mean())
    stats["clamped_materials"] = clamped
    pages = finish(texels, estimate, valid, denoise=options.denoise, progress=progress)
    return LightmapResult(texels, estimate, hidden_share, pages, stats)


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
    """Uploads the scene and its texels, and compiles the kernels."""
    from irradia.transport.texel_light import TexelLight
    from irradia.transport.world import World

    world = World(scene, mesh, (layout.width_px, layout.height_px), robust=not options.fast_rays)
    ratio = options.n_direct / options.samples
    light = TexelLight(world, texels.pixel, texels.triangle, texels.barycentric, ratio)
    light.warm_up(cached=options.integrator == "cached")
    return light


def _trace(
    light: TexelLight, options: BakeOptions, progress: Progress
) -> tuple[NDArray[np.float32], list[Epoch], int]:
    """E/π per texel, with a record of what was traced."""
    plan = EpochPlan.for_options(options.samples, cached=options.integrator == "cached")
    return run_epochs(light, plan, options.n_direct, Seed(options.seed).child("bake"), progress)


def _stats(
    light: TexelLight, options: BakeOptions, epochs: list[Epoch], launches: int, seconds: float
) -> dict[str, Any]:
    n_samples = light.n_texels * sum(epoch.rays for epoch in epochs)
    n_direct = light.n_texels * options.n_direct if light.world.lights.any else 0
    return {
        "integrator": options.integrator,
        "texels": light.n_texels,
        "samples_per_texel": options.samples,
        "direct_samples_per_texel": options.n_direct if light.world.lights.any else 0,
        "epochs": [{"rays": e.rays, "mean": e.mean} for e in epochs],
        "launches_per_pass": launches,
        "tracing_seconds": seconds,
        "samples_per_second": n_samples / seconds,
        "rays_per_second": (n_samples + n_direct) / seconds,
    }
