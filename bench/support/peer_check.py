"""Holds the peer to the known answers before anything is timed."""

from __future__ import annotations

import tempfile
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from irradia.bake.setup import cover
from irradia.bake.texels import TexelSet
from irradia.core.progress import silent_progress
from irradia.scene.lightmap_uv import LayoutOptions, layout_lightmap
from irradia.scene.merge import MergedMesh
from irradia.scene.types import Material
from support.bake_task import write_task
from support.cycles import bake_with_cycles
from support.known_answers import KnownAnswer, known_answers

RESOLUTION_PX = 48
SAMPLES = 1024


@dataclass(frozen=True)
class Verdict:
    """How far the peer is from one answer.

    Attributes:
        mean_error: Of the mean over texels, relative, the worst channel's.
        worst_error: Of the worst texel, relative.
    """

    name: str
    mean_error: float
    worst_error: float
    passed: bool


def check_peer(threads: int) -> Iterator[Verdict]:
    """Bakes every known answer with the peer."""
    for known in known_answers():
        yield _check(known, threads)


def _check(known: KnownAnswer, threads: int) -> Verdict:
    layout = layout_lightmap(known.scene, LayoutOptions(resolution=RESOLUTION_PX), silent_progress())
    mesh, texels = cover(known.scene, layout)
    with tempfile.TemporaryDirectory() as folder:
        task = Path(folder) / "task.npz"
        write_task(task, known.scene, layout)
        baked = bake_with_cycles(task, SAMPLES, seed=1, threads=threads)
    counted = inner_texels(known.scene.materials, mesh, texels)
    values = baked.pages.reshape(-1, 3)[texels.pixel[counted]].astype(np.float64)
    expected = known.answer(texel_positions(mesh, texels)[counted])
    mean_error = float(np.abs(values.mean(axis=0) / expected.mean(axis=0) - 1.0).max())
    worst_error = float(np.abs(values / expected - 1.0).max())
    # Texels are points to the one and small areas to the other; 3 % holds for noise-free ones.
    passed = mean_error < known.tolerance and (known.noisy or worst_error < 0.03)
    return Verdict(known.name, mean_error, worst_error, passed)


def inner_texels(materials: tuple[Material, ...], mesh: MergedMesh, texels: TexelSet) -> np.ndarray:
    """(N,) texels that lie wholly in a chart, on opaque surfaces that reflect.

    At a chart's border bakers differ in where they sample; where nothing is reflected, the peer's
    division by the albedo has no answer.
    """
    compared = np.array([_is_opaque_and_lit(material) for material in materials])
    return (texels.coverage >= 1.0) & compared[mesh.material[texels.triangle]]


def _is_opaque_and_lit(material: Material) -> bool:
    opaque = material.alpha_mode == "opaque" and material.transmission == 0.0
    return opaque and min(material.base_color[:3]) > 0.0 and not material.unlit


def texel_positions(mesh: MergedMesh, texels: TexelSet) -> np.ndarray:
    """(N, 3) mean position of each texel's sub-samples."""
    triangle, weights = texels.locate(mesh)
    corners = mesh.positions[mesh.indices[triangle]].astype(np.float64)
    return np.einsum("nsk,nskc->nsc", weights, corners).mean(axis=1)
