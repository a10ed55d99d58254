"""Bakes of built-in scenes for tests of light: small maps, no denoiser."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from irradia.bake.lightmap import BakeOptions, LightmapResult, bake_lightmap
from irradia.bake.setup import cover
from irradia.bake.texels import TexelSet
from irradia.cli.lighting import LightOptions, light_scene
from irradia.core import silent_progress
from irradia.scene.layout import LightmapLayout
from irradia.scene.lightmap_uv import LayoutOptions, layout_lightmap
from irradia.scene.load import load_scene
from irradia.scene.merge import MergedMesh
from irradia.scene.types import Scene


def lit(name: str) -> Scene:
    """A built-in scene under the light that it asks for."""
    return light_scene(load_scene(f"builtin:{name}"), LightOptions(default_light=False))


def laid_out(scene: Scene, resolution: int) -> LightmapLayout:
    """Its layout on one page."""
    return layout_lightmap(scene, LayoutOptions(resolution=resolution), silent_progress())


def bake(scene: Scene, resolution: int, samples: int, **options: object) -> LightmapResult:
    """Bakes without the denoiser."""
    choices = {"denoise": False, "samples": samples, **options}
    return bake_lightmap(scene, laid_out(scene, resolution), BakeOptions(**choices))  # type: ignore[arg-type]


def places(scene: Scene, layout: LightmapLayout) -> tuple[MergedMesh, TexelSet, NDArray[np.float64]]:
    """The merged mesh, its texels, and world positions (N, SUBSAMPLES, 3) of their sub-samples."""
    mesh, texels = cover(scene, layout)
    triangle, weights = texels.locate(mesh)
    corners = mesh.positions[mesh.indices[triangle]].astype(np.float64)
    return mesh, texels, np.einsum("nsk,nskc->nsc", weights, corners)


def instance_of(mesh: MergedMesh, texels: TexelSet) -> NDArray[np.uint32]:
    """(N,) the instance that each texel belongs to."""
    return mesh.instance[texels.triangle]


def without_light(scene: Scene) -> Scene:
    """The same surfaces, dark."""
    dark = tuple(replace(m, emission=(0.0, 0.0, 0.0)) for m in scene.materials)
    return replace(scene, materials=dark, lights=(), environment=None)
