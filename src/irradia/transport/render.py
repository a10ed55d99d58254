"""Images: the diffuse reference, and a baked result seen by the same camera.

Both follow camera rays with the one integrator. A reference has no cache. A baked image reads E/π
from the finished lightmap, bilinearly as an engine would, times the surface's own reflectance.
Single-sided surfaces are invisible from behind, as in engines.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from irradia.core import InputError, Progress, Seed, silent_progress
from irradia.scene.layout import LightmapLayout
from irradia.scene.merge import CAMERA_LOD, merge, seen_by_camera
from irradia.scene.types import Camera, Scene
from irradia.transport.backend import dr, mi
from irradia.transport.camera_rays import camera_ray
from irradia.transport.geometry import Hit
from irradia.transport.path import LightCache, start, trace
from irradia.transport.sampling import Sampler, hash_u32
from irradia.transport.world import TriangleRecord, World

Transport = Literal["diffuse", "full"]
_MAX_EDGE_PX = 16_384
_SAMPLES_PER_PASS = 8


@dataclass(frozen=True)
class RenderOptions:
    """How to render.

    Attributes:
        width, height: Pixels.
        spp: Samples a pixel.
        transport: ``diffuse``, what bakes are compared with, or ``full`` materials.
        seed: Root of all random numbers.
        fast_rays: Gives up watertight intersection for speed.
    """

    width: int = 1280
    height: int = 720
    spp: int = 64
    transport: Transport = "diffuse"
    seed: int = 0
    fast_rays: bool = False

    def __post_init__(self) -> None:
        if not (1 <= self.width <= _MAX_EDGE_PX and 1 <= self.height <= _MAX_EDGE_PX):
            raise InputError(f"expected 1 to {_MAX_EDGE_PX} px a side, found {self.width} × {self.height}")
        if self.spp < 1:
            raise InputError(f"expected at least 1 sample, found {self.spp}", where="--spp")
        if self.transport not in ("diffuse", "full"):
            raise InputError(f"expected diffuse or full, found {self.transport!r}", where="--transport")


@dataclass(frozen=True)
class BakedLight:
    """A finished lightmap to render from: pages (P, H, W, 3) of E/π, and where charts lie on them."""

    layout: LightmapLayout
    pages: NDArray[np.float32]


def render(
    scene: Scene,
    camera: Camera,
    options: RenderOptions,
    *,
    lightmap: BakedLight | None = None,
    progress: Progress | None = None,
) -> NDArray[np.float32]:
    """Renders an image of linear radiance, (height, width, 3), row 0 at the top."""
    progress = progress or silent_progress()
    if options.transport == "full":
        from irradia.transport.full import render_full

        return render_full(scene, camera, options, progress)
    with progress.stage("scene for rendering"):
        renderer = _Renderer(scene, camera, options, lightmap)
        renderer.add_samples(0)
    name = "render from the bake" if lightmap else "render the reference"
    n_pixels = options.width * options.height
    with progress.stage(name, options.spp * n_pixels, "samples") as stage:
        while renderer.count < options.spp:
            n = min(_SAMPLES_PER_PASS, options.spp - renderer.count)
            renderer.add_samples(n)
            stage.advance(n * n_pixels)
    return renderer.image()


class DisplayCache:
    """A finished lightmap, filtered bilinearly, times the reflectance at the hit."""

    def __init__(self, pages: NDArray[np.float32]) -> None:
        n_pages, self._height, self._width = pages.shape[:3]
        texels = np.zeros((n_pages, self._height, self._width, 4), np.float32)
        texels[..., :3] = pages
        self._texels = mi.Float(texels.ravel())

    everywhere = False

    def outgoing(self, world: World, hit: Hit, record: TriangleRecord, active: mi.Bool) -> mi.Color3f:
        """See :class:`LightCache`."""
        x, y = record.pixel.x - 0.5, record.pixel.y - 0.5
        x0, y0 = dr.floor(x), dr.floor(y)
        fx, fy = x - x0, y - y0
        total = mi.Color3f(0.0)
        for dy, wy in ((0, 1.0 - fy), (1, fy)):
            for dx, wx in ((0, 1.0 - fx), (1, fx)):
                column = dr.clip(mi.Int32(x0) + dx, 0, self._width - 1)
                row = dr.clip(mi.Int32(y0) + dy, 0, self._height - 1)
                index = record.page_start + mi.UInt32(row) * self._width + mi.UInt32(column)
                texel = dr.gather(mi.Vector4f, self._texels, index, active)
                total += mi.Color3f(texel.x, texel.y, texel.z) * (wx * wy)
        looks = world.appearance(hit.triangle, hit.bary, active)
        return total * looks.reflectance / dr.maximum(1.0 - looks.pass_probability, 1e-6)


class _Renderer:
    """One lane a pixel; every pass adds a few samples inside the kernel."""

    def __init__(
        self, scene: Scene, camera: Camera, options: RenderOptions, lightmap: BakedLight | None
    ) -> None:
        layout = lightmap.layout if lightmap else None
        size = (layout.width_px, layout.height_px) if layout else None
        mesh = seen_by_camera(merge(scene, layout))
        self._world = World(scene, mesh, size, robust=not options.fast_rays)
        self._lod = mi.UInt32(CAMERA_LOD) if self._world.geometry.has_lods else None
        self._cache = DisplayCache(lightmap.pages) if lightmap else None
        self._camera = camera
        self._width, self._height = options.width, options.height
        self._seed = Seed(options.seed).child("render").uint32()
        self._sum = dr.zeros(mi.Color3f, self._width * self._height)
        self.count = 0

    def add_samples(self, n: int) -> None:
        """Adds ``n`` samples to every pixel."""
        first, last = dr.opaque(mi.UInt32, self.count), dr.opaque(mi.UInt32, self.count + n)
        self._sum += self._loop(first, last, self._cache)
        dr.eval(self._sum)
        dr.sync_thread()
        self.count += n

    @dr.syntax
    def _loop(self, first: mi.UInt32, last: mi.UInt32, cache: LightCache | None) -> mi.Color3f:
        pixel = dr.arange(mi.UInt32, self._width * self._height)
        seed = hash_u32(pixel ^ hash_u32(dr.opaque(mi.UInt32, self._seed)))
        total = mi.Color3f(0.0)
        k = mi.UInt32(first)
        while k < last:
            sampler = Sampler(mi.UInt32(k), mi.UInt32(seed))
            jitter = sampler.next_2d()
            origin, direction = camera_ray(self._camera, self._width, self._height, pixel, jitter)
            ray = start(origin, direction, mi.Float(1.0), mi.Float(0.0), sampler, mi.Bool(True), self._lod)
            ray = trace(self._world, ray, cache, cull_backs=True)
            total += ray.radiance
            k += 1
        return total

    def image(self) -> NDArray[np.float32]:
        """Mean over samples."""
        flat = np.array(self._sum).T / max(self.count, 1)
        return np.ascontiguousarray(flat, np.float32).reshape(self._height, self._width, 3)
