"""Ambient occlusion: how much of an even sky each texel sees within a distance."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from irradia.bake.texels import TexelSet
from irradia.core.errors import InputError
from irradia.core.progress import Progress, silent_progress
from irradia.core.rng import Seed
from irradia.scene.types import F32

if TYPE_CHECKING:
    from irradia.transport.subsamples import Subsamples
    from irradia.transport.world import World

_MAX_SAMPLES = 1 << 20
_RAYS_PER_LAUNCH = 64
_DEFAULT_DISTANCE_M = 1.0


@dataclass(frozen=True)
class OcclusionOptions:
    """How to bake ambient occlusion.

    Attributes:
        samples: Rays per texel.
        distance_m: Surfaces farther away don't occlude; infinity lets all do so. None takes a metre,
            or half the radius of scenes of less than two metres.
        seed: Root of all random numbers.
    """

    samples: int = 256
    distance_m: float | None = None
    seed: int = 0

    def __post_init__(self) -> None:
        if not 1 <= self.samples <= _MAX_SAMPLES:
            raise InputError(f"expected 1 to {_MAX_SAMPLES} samples, found {self.samples}", where="--samples")
        if self.distance_m is not None and not self.distance_m > 0.0:
            raise InputError(
                f"expected a distance above 0 m, found {self.distance_m}",
                where="--ao-distance",
                fix="Use inf for no limit.",
            )

    def distance_in(self, radius_m: float) -> float:
        """The distance for a scene of that bounding radius."""
        return self.distance_m or min(_DEFAULT_DISTANCE_M, radius_m / 2)


def bake_occlusion(
    world: World,
    subsamples: Subsamples,
    texels: TexelSet,
    options: OcclusionOptions | None = None,
    progress: Progress | None = None,
) -> F32:
    """Traces the openness of texels.

    Args:
        world: What occludes; alpha and glass do so in part.
        subsamples: Of the texels, hidden ones already replaced.
        texels: Where they lie.
        options: How.
        progress: Shows the stage "ambient occlusion".

    Returns:
        (N,) cosine-weighted share of the hemisphere that is open, in [0, 1]: 1 in the open.
    """
    from irradia.transport.occlusion import Openness

    options, progress = options or OcclusionOptions(), progress or silent_progress()
    seed = Seed(options.seed).child("ambient-occlusion").uint32()
    distance_m = options.distance_in(world.geometry.radius)
    kernel = Openness(world, subsamples, texels.pixel, distance_m, seed)
    sums = kernel.nothing()
    n_texels = len(texels.pixel)
    with progress.stage("ambient occlusion", total=options.samples * n_texels, unit=" rays") as stage:
        for k in range(math.ceil(options.samples / _RAYS_PER_LAUNCH)):
            n_rays = min(_RAYS_PER_LAUNCH, options.samples - k * _RAYS_PER_LAUNCH)
            sums = kernel.add(sums, n_rays)
            kernel.wait()
            stage.advance(n_rays * n_texels)
    return np.ascontiguousarray(sums.openness())
