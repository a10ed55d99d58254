"""The bake seen by a camera, beside the path-traced references."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from irradia.core.progress import Progress
from irradia.scene.types import Camera, Scene

if TYPE_CHECKING:
    from irradia.metrics import Comparison
    from irradia.transport.render import BakedLight

F32 = NDArray[np.float32]


@dataclass(frozen=True)
class ViewOptions:
    """The pictures of a report.

    Attributes:
        width_px, height_px: Their size.
        reference_spp: Samples per pixel of the diffuse reference.
        full_spp: Samples per pixel with full materials, which is only looked at.
        baked_spp: Samples per pixel of the baked view: enough for smooth edges.
        seed: Root of all random numbers.
        fast_rays: Gives up watertight intersection for speed.
    """

    width_px: int = 960
    height_px: int = 540
    reference_spp: int = 256
    full_spp: int = 64
    baked_spp: int = 32
    seed: int = 0
    fast_rays: bool = False


@dataclass(frozen=True)
class View:
    """One camera's pictures: (H, W, 3) linear radiance each, and their comparison.

    Attributes:
        baked, reference: Diffuse transport; these are compared.
        full: Full materials, to look at.
        flip: (H, W) error of ``baked``.
    """

    camera: Camera
    baked: F32
    reference: F32
    full: F32
    flip: F32
    comparison: Comparison


def render_view(scene: Scene, lightmap: BakedLight, options: ViewOptions, progress: Progress) -> View:
    """Renders through the scene's first camera, or one that frames it."""
    from irradia.metrics import compare, flip
    from irradia.scene.framing import camera_from_spec
    from irradia.transport.render import RenderOptions, Transport, render

    camera = camera_from_spec(scene, None, options.width_px / options.height_px)

    def picture(spp: int, transport: Transport, shown: BakedLight | None = None) -> F32:
        how = RenderOptions(
            options.width_px, options.height_px, spp, transport, options.seed, options.fast_rays
        )
        return render(scene, camera, how, lightmap=shown, progress=progress)

    baked = picture(options.baked_spp, "diffuse", lightmap)
    reference = picture(options.reference_spp, "diffuse")
    full = picture(options.full_spp, "full")
    with progress.stage("comparison"):
        error = flip(baked, reference).error
        return View(camera, baked, reference, full, error, compare(baked, reference))
