"""The direct map: what of a lightmap is the first bounce of its punctual lights, shadows included.

Fields of indirect light leave exactly that out, so a field and this map together are all light. It is
traced by itself, light by light and from every sub-sample of every texel: sharp lights have no noise,
and soft ones so little that the denoiser takes more from the edges of shadows than it mends.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from irradia.core.progress import Progress
from irradia.core.rng import Seed
from irradia.scene.merge import MergedMesh
from irradia.scene.types import F32, Light
from irradia.transport.subsample_set import SUBSAMPLES

if TYPE_CHECKING:
    from irradia.transport.lights import Lights
    from irradia.transport.texel_light import TexelLight

ONE_BY_ONE = 8  # lights; more are drawn by what they may send, four times the samples for all together
_MANY = 4


def baked_lights(lights: Sequence[Light]) -> tuple[Light, ...]:
    """Those whose first bounce is in the lightmap."""
    return tuple(light for light in lights if light.mode == "baked" and max(light.intensity) > 0.0)


def trace_direct_map(
    light: TexelLight,
    mesh: MergedMesh,
    lights: Sequence[Light],
    samples: int,
    seed: int,
    progress: Progress,
) -> F32 | None:
    """E/π (N, 3) of the first bounce, or None where no punctual light is baked.

    Args:
        light: The texels, hidden ones already replaced.
        mesh: The merged scene.
        lights: All of the scene's, with the part that each has.
        samples: Per texel and light that has an extent.
        seed: Root of all random numbers.
        progress: Shows the stage "direct map".
    """
    chosen = baked_lights(lights)
    if not chosen:
        return None
    soft = light.world.translucent or any(_has_extent(each) for each in chosen)
    one_by_one = len(chosen) <= ONE_BY_ONE
    if one_by_one:
        per_texel = _whole_rounds(samples) if soft else SUBSAMPLES
    else:
        per_texel = _whole_rounds(_MANY * samples)
    n_sources = len(chosen) if one_by_one else 1
    total = light.nothing()
    root = Seed(seed).child("direct-map")
    with progress.stage("direct map", total=n_sources * per_texel, unit=" samples") as stage:
        for number, source in enumerate(_sources(light, mesh, chosen, one_by_one)):
            stream = root.child(f"light-{number}").uint32()
            for first in range(0, per_texel, SUBSAMPLES):
                total = light.add_next_event(total, source, stream, first, first + SUBSAMPLES)
                light.wait()
                stage.advance(SUBSAMPLES)
    return light.to_host(total) / np.float32(per_texel)


def _sources(
    light: TexelLight, mesh: MergedMesh, lights: Sequence[Light], one_by_one: bool
) -> Iterator[Lights]:
    """Every light by itself, or all at once."""
    from irradia.transport.light_setup import make_lights
    from irradia.transport.one_light import OneLight
    from irradia.transport.punctual import PunctualLights

    if one_by_one:
        punctual = PunctualLights(lights)
        yield from (OneLight(punctual, index) for index in range(len(lights)))
        return
    dark = tuple(replace(m, emission=(0.0, 0.0, 0.0)) for m in light.world.scene.materials)
    alone = replace(light.world.scene, materials=dark, lights=tuple(lights), environment=None)
    yield make_lights(alone, mesh)


def _has_extent(light: Light) -> bool:
    return light.radius_m > 0.0 or light.angle_deg > 0.0


def _whole_rounds(samples: int) -> int:
    """At least so many, as many from each sub-sample."""
    return -(-samples // SUBSAMPLES) * SUBSAMPLES
