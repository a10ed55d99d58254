"""Ambient occlusion as a map: from a scene and its layout to finished pages."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from irradia.bake.finish import Finisher, FinishOptions
from irradia.bake.occlusion import OcclusionOptions, bake_occlusion
from irradia.bake.options import BakeOptions
from irradia.bake.regions import find_regions
from irradia.bake.setup import cover, prepare
from irradia.bake.texels import TexelSet
from irradia.core.progress import Progress, silent_progress
from irradia.scene.layout import LightmapLayout
from irradia.scene.types import F32, Scene


@dataclass(frozen=True)
class OcclusionMap:
    """Baked ambient occlusion.

    Attributes:
        texels: Which texels there are.
        valid: (N,) whether a texel's value is its own; the others take it from their chart.
        hidden_share: (N,) share of each texel's sub-samples that lie inside something.
        openness: (N,) as traced, in [0, 1].
        pages: (P, H, W, 3) finished: seams closed, dilated, three times the same.
        distance_m: Beyond it nothing occludes.
    """

    texels: TexelSet
    valid: NDArray[np.bool_]
    hidden_share: F32
    openness: F32
    pages: F32
    distance_m: float

    @property
    def coverage(self) -> F32:
        """(P, H, W) share of each texel that charts cover; 0 where the texel is invalid."""
        return self.texels.to_pages(np.where(self.valid, self.texels.coverage, np.float32(0.0)))


def bake_occlusion_map(
    scene: Scene,
    layout: LightmapLayout,
    options: OcclusionOptions,
    progress: Progress | None = None,
    *,
    fast_rays: bool = False,
    seams: bool = True,
) -> OcclusionMap:
    """Bakes how open every texel is; see :func:`bake_occlusion`.

    Args:
        scene: Its lights don't matter.
        layout: Where charts lie.
        options: How.
        progress: Shows stages.
        fast_rays: Gives up watertight intersection for speed.
        seams: Whether edges that are one in space are made to agree across charts.

    Raises:
        InputError: If nothing in the scene takes a lightmap.
    """
    from irradia.bake.seam_points import find_seam_points
    from irradia.transport.texel_grid import TexelGrid

    progress = progress or silent_progress()
    with progress.stage("texels"):
        mesh, texels = cover(scene, layout)
    with progress.stage("ray tracing set-up"):
        light = prepare(scene, mesh, layout, texels, BakeOptions(fast_rays=fast_rays))
    with progress.stage("hidden texels"):
        grid = TexelGrid(texels.pixel, texels.chart, texels.width_px, texels.height_px)
        footprints = light.clear_footprints(grid)
        region = find_regions(texels, footprints.visible, footprints.cut_off, footprints.moved)
    openness = bake_occlusion(light.world, light.subsamples, texels, options, progress)
    points = find_seam_points(mesh, layout) if seams else None
    how = FinishOptions(denoise=False, seams=seams)
    finisher = Finisher(texels, footprints.valid, how, progress, region=region, seams=points)
    pages = finisher.irradiance(np.repeat(openness[:, None], 3, axis=1))
    distance_m = options.distance_in(light.world.geometry.radius)
    return OcclusionMap(
        texels, footprints.valid, footprints.hidden_share, openness, np.minimum(pages, 1.0), distance_m
    )
