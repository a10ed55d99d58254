"""The cached gather in epochs.

A gather ray that meets a surface reads the light leaving it from the map of the previous epoch;
each epoch starts its own sums from nothing. Short epochs carry the light around until the map's
mean has settled, a few longer ones replace their noise, and the last, whose cache is frozen, is
the result: its samples are independent. A running mean that read itself would converge like
n^−(1−ρ) and never get there.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from irradia.core import Progress, Seed

if TYPE_CHECKING:
    from irradia.core.progress import Stage
    from irradia.transport.path import LightCache
    from irradia.transport.texel_light import TexelColour, TexelLight

_RAYS_PER_LAUNCH = 1 << 22
_RAYS_TO_SETTLE = 1 << 18  # an epoch of fewer settles on a mean of its own, and bounces amplify the error
_MAX_SETTLING = 64
_SETTLED = 5e-4  # of the mean: what the epochs still to come may add


@dataclass(frozen=True)
class Epoch:
    """One epoch as it went: rays per texel and the map's mean after it."""

    rays: int
    mean: float


@dataclass(frozen=True)
class EpochPlan:
    """Rays per texel of the epochs after the map has settled; the last makes the result.

    Attributes:
        cached: Whether there is a cache at all; a path-traced bake is one epoch without.
    """

    sizes: tuple[int, ...]
    cached: bool

    @staticmethod
    def for_options(samples: int, *, cached: bool) -> EpochPlan:
        """Doubling epochs up to an eighth of ``samples``, then ``samples``."""
        growing = []
        size = 2
        while cached and size <= samples // 8:
            growing.append(size)
            size *= 2
        return EpochPlan((*growing, samples), cached)


def run_epochs(
    light: TexelLight, plan: EpochPlan, n_direct: int, seed: Seed, progress: Progress
) -> tuple[NDArray[np.float32], list[Epoch], int]:
    """Traces a whole bake.

    Returns:
        E/π (N, 3), the epochs, and kernel launches per pass.
    """
    direct = _direct_light(light, n_direct, seed.child("direct"), progress)
    reflectance = light.reflectance()
    epochs: list[Epoch] = []
    cache: LightCache | None = None
    if plan.cached:
        with progress.stage("light bounces") as stage:
            rays = min(max(_RAYS_TO_SETTLE // light.n_texels, 1), max(plan.sizes[-1] // 8, 1))
            cache = _settle(light, direct, reflectance, rays, seed.child("settle"), epochs, stage)

    estimate, launches = direct, 0
    total = light.n_texels * sum(plan.sizes)
    with progress.stage("gather", total, "samples") as stage:
        for number, size in enumerate(plan.sizes):
            stream = seed.child(f"epoch-{number}")
            gathered, launches = _gather(light, size, cache, number, stream, stage)
            estimate = gathered + direct
            epochs.append(Epoch(size, light.mean(estimate)))
            if plan.cached and number + 1 < len(plan.sizes):
                cache = light.cache(estimate, reflectance)
    return light.to_host(estimate), epochs, launches


def _direct_light(light: TexelLight, n_direct: int, seed: Seed, progress: Progress) -> TexelColour:
    """Light straight from sources: it depends on no cache, so once is enough for all epochs."""
    sums = light.empty_sums()
    with progress.stage("direct light", light.n_texels * n_direct, "samples") as stage:
        while sums.count < n_direct:
            n = min(_rays_per_pass(light.n_texels), n_direct - sums.count)
            sums = light.direct(sums, n, seed.uint32())
            light.wait()
            stage.advance(n * light.n_texels)
    return sums.mean


def _gather(
    light: TexelLight, size: int, cache: LightCache | None, number: int, seed: Seed, stage: Stage
) -> tuple[TexelColour, int]:
    """One epoch from nothing: the mean of ``size`` rays a texel, and kernel launches per pass."""
    gather = partial(light.gather, seed=seed.uint32(), cache=cache, first_subsample=number)
    sums, launches = light.empty_sums(), 0
    while sums.count < size:
        n = min(_rays_per_pass(light.n_texels), size - sums.count)
        sums, launches = light.count_launches(partial(gather, sums, n))
        stage.advance(n * light.n_texels)
    return sums.mean, launches


def _rays_per_pass(n_texels: int) -> int:
    """A power of two that gives a launch a few million rays, and at least one block of sub-samples."""
    return max(8, 1 << (_RAYS_PER_LAUNCH // max(n_texels, 1)).bit_length())


def _settle(
    light: TexelLight,
    direct: TexelColour,
    reflectance: TexelColour,
    rays: int,
    seed: Seed,
    epochs: list[Epoch],
    stage: Stage,
) -> LightCache:
    """Short epochs until what is still to come is below ``_SETTLED`` of the mean.

    All draw the same random numbers, so that the iteration is a fixed linear one whose mean
    converges geometrically; the later epochs draw fresh ones. Every third epoch jumps ahead by
    the geometric series' remainder.
    """
    stream = seed.uint32()
    cache = light.cache(direct, reflectance)
    means: list[float] = [light.mean(direct)]
    for _ in range(_MAX_SETTLING):
        sums = light.gather(light.empty_sums(), rays, stream, cache, first_subsample=0)
        estimate = sums.mean + direct
        means.append(light.mean(estimate))
        epochs.append(Epoch(rays, means[-1]))
        stage.note(f"{len(epochs)} epochs")
        scale = 1.0
        if len(means) >= 3:
            remainder = _geometric_remainder(means)
            if abs(remainder) <= _SETTLED * abs(means[-1]):
                return light.cache(estimate, reflectance)
            if len(means) >= 4:
                scale = 1.0 + remainder / means[-1]
                means = [means[-1] * scale]
        cache = light.cache(estimate, reflectance, scale)
    return cache


def _geometric_remainder(means: list[float]) -> float:
    """What a geometric series that goes on like the last three means would still add."""
    before, last = means[-2] - means[-3], means[-1] - means[-2]
    if before == 0.0 or last == 0.0:
        return 0.0
    ratio = min(max(last / before, 0.0), 0.98)
    return last * ratio / (1.0 - ratio)
