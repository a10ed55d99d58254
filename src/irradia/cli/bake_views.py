"""The bake seen by a camera, beside the path-traced references."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from irradia.core.progress import Progress
from irradia.core.rng import Seed
from irradia.scene.types import Camera, Scene

if TYPE_CHECKING:
    from irradia.metrics import Comparison
    from irradia.transport.render import BakedLight

F32 = NDArray[np.float32]


@dataclass(frozen=True)
class ViewOptions:
    """The pictures of a report.

    Attributes:
        reference_spp: Samples per pixel of the diffuse reference, two halves together.
        n_pixels: About how many each picture has; its shape is the camera's.
        full_spp: Samples per pixel with full materials, which is only looked at.
        baked_spp: Samples per pixel of the baked view: enough for smooth edges.
        seed: Root of all random numbers.
        fast_rays: Gives up watertight intersection for speed.
    """

    reference_spp: int = 128
    n_pixels: int = 768 * 432
    full_spp: int = 32
    baked_spp: int = 16
    seed: int = 0
    fast_rays: bool = False


@dataclass(frozen=True)
class View:
    """One camera's pictures: (H, W, 3) linear radiance each, and their comparison.

    Attributes:
        baked, reference: Diffuse transport; these are compared, in pixels that show the scene.
        halves: Two independent ones whose mean ``reference`` is.
        full: Full materials, to look at.
        flip: (H, W) error of ``baked``, 0 where the backdrop is seen.
        relmse_noise_free: relMSE without what the reference's own noise adds to it.
    """

    camera: Camera
    baked: F32
    reference: F32
    halves: tuple[F32, F32]
    full: F32
    flip: F32
    comparison: Comparison
    relmse_noise_free: float


def render_view(scene: Scene, lightmap: BakedLight, options: ViewOptions, progress: Progress) -> View:
    """Renders through the scene's first camera, or one that frames it.

    The reference is made in two independent halves, so that its noise can be told from error.
    """
    from irradia.metrics import compare, flip_where, relmse_without_reference_noise
    from irradia.scene.framing import camera_from_spec
    from irradia.transport.gbuffer import pixels_of_scene
    from irradia.transport.render import RenderOptions, Transport, render

    camera = camera_from_spec(scene, None)
    width, height = picture_size(camera.aspect, options.n_pixels)

    def picture(name: str, spp: int, transport: Transport, shown: BakedLight | None = None) -> F32:
        seed = Seed(options.seed).child(name).uint32()
        how = RenderOptions(width, height, spp, transport, seed, options.fast_rays)
        return render(scene, camera, how, lightmap=shown, progress=progress)

    baked = picture("baked", options.baked_spp, "diffuse", lightmap)
    half_spp = max(options.reference_spp // 2, 1)
    halves = picture("reference-0", half_spp, "diffuse"), picture("reference-1", half_spp, "diffuse")
    full = picture("full", options.full_spp, "full")
    with progress.stage("comparison"):
        reference = 0.5 * (halves[0] + halves[1])
        scene_only = pixels_of_scene(scene, camera, RenderOptions(width, height, fast_rays=options.fast_rays))
        return View(
            camera,
            baked,
            reference,
            halves,
            full,
            flip_where(baked, reference, scene_only),
            compare(baked, reference, scene_only),
            relmse_without_reference_noise(baked[scene_only], *(half[scene_only] for half in halves)),
        )


def picture_size(aspect: float, n_pixels: int) -> tuple[int, int]:
    """Width and height of about ``n_pixels`` in this shape, each even and at least 2."""
    width = math.sqrt(n_pixels * aspect)
    return max(2, 2 * round(width / 2)), max(2, 2 * round(width / aspect / 2))
