"""Shadow masks: for lights that shine live, which texels they reach, four lights to an image.

Three steps: :func:`plan_shadow_mask`, before anything is traced, because lights that find no channel
are then baked like others; :func:`bake_shadow_mask`; :func:`finish_shadow_mask`.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from irradia.bake.dilate import fill_invalid
from irradia.bake.light_reach import cut_patches, reaches, strength
from irradia.bake.mask_channels import N_CHANNELS, NO_CHANNEL, assign_channels
from irradia.bake.texels import TexelSet
from irradia.core.errors import InputError
from irradia.core.progress import Progress, silent_progress
from irradia.core.rng import Seed
from irradia.scene.merge import MergedMesh
from irradia.scene.types import F32, U32, Light

if TYPE_CHECKING:
    from irradia.bake.finish import Finisher
    from irradia.transport.subsamples import Subsamples
    from irradia.transport.world import World

_MAX_SAMPLES = 1 << 16
_NAMES_IN_NOTE = 8


@dataclass(frozen=True)
class ShadowMaskOptions:
    """How to bake shadow masks.

    Attributes:
        samples: Rays per texel and light that has a size; sharp ones get one per sub-sample.
        seed: Root of all random numbers.
    """

    samples: int = 64
    seed: int = 0

    def __post_init__(self) -> None:
        if not 1 <= self.samples <= _MAX_SAMPLES:
            raise InputError(f"expected 1 to {_MAX_SAMPLES} samples, found {self.samples}", where="--samples")


@dataclass(frozen=True)
class ShadowMaskPlan:
    """Which light's shadow goes where.

    Attributes:
        channels: By light of the scene: 0 … 3, or None for lights without a mask.
        fallback: Mixed lights that found no channel, ascending: they must be baked.
    """

    channels: tuple[int | None, ...]
    fallback: tuple[int, ...] = ()

    def members(self, channel: int) -> list[int]:
        """Lights of one channel, ascending."""
        return [index for index, at in enumerate(self.channels) if at == channel]

    @property
    def needed(self) -> bool:
        """Whether there is a mask to bake."""
        return any(channel is not None for channel in self.channels)

    def lights(self, lights: tuple[Light, ...]) -> tuple[Light, ...]:
        """The scene's lights with those of ``fallback`` baked."""
        return tuple(
            replace(light, mode="baked") if index in self.fallback else light
            for index, light in enumerate(lights)
        )

    def to_json(self, lights: tuple[Light, ...], files: Sequence[str]) -> dict[str, Any]:
        """What ``bake.json`` says of the masks: which files, and which light's shadow is where."""
        return {
            "files": list(files),
            "lights": [
                {"light": index, "name": lights[index].name, "channel": channel}
                for index, channel in enumerate(self.channels)
                if channel is not None
            ],
            "baked_instead": [{"light": index, "name": lights[index].name} for index in self.fallback],
        }

    def notes(self, lights: tuple[Light, ...]) -> tuple[str, ...]:
        """What the user should know."""
        if not self.fallback:
            return ()
        names = [lights[i].name or f"light {i}" for i in self.fallback[:_NAMES_IN_NOTE]]
        more = len(self.fallback) - len(names)
        listed = ", ".join(names) + (f" and {more} more" if more else "")
        return (
            f"baked, not mixed, for want of a shadow mask channel (where lights overlap there are "
            f"{N_CHANNELS}; give lights a range so that fewer do): {listed}",
        )


@dataclass(frozen=True)
class ShadowMask:
    """Shadows at texels.

    Attributes:
        visibility: (N, 4) share of the light of each channel that arrives, in [0, 1]; 1 in channels
            without a light.
        lit: (N, 4) whether, shadows aside, a light of the channel shines there; elsewhere nothing
            is known.
    """

    visibility: F32
    lit: NDArray[np.bool_]


def plan_shadow_mask(mesh: MergedMesh, lights: tuple[Light, ...]) -> ShadowMaskPlan:
    """Gives the mixed lights channels; lights that may shine on one place never share one.

    Args:
        mesh: The scene with its layout: light counts where there are texels.
        lights: All of the scene's.
    """
    mixed = [index for index, light in enumerate(lights) if light.mode == "mixed"]
    channels: list[int | None] = [None] * len(lights)
    if not mixed:
        return ShadowMaskPlan(tuple(channels))
    patches = cut_patches(mesh)
    reached = [reaches(lights[index], patches) for index in mixed]
    power = [strength(lights[index], patches, r) for index, r in zip(mixed, reached, strict=True)]
    assigned = assign_channels(_overlap(np.array(reached)), power)
    for index, channel in zip(mixed, assigned, strict=True):
        channels[index] = None if channel == NO_CHANNEL else int(channel)
    return ShadowMaskPlan(tuple(channels), tuple(index for index in mixed if channels[index] is None))


def bake_shadow_mask(
    world: World,
    subsamples: Subsamples,
    texels: TexelSet,
    lights: tuple[Light, ...],
    plan: ShadowMaskPlan,
    options: ShadowMaskOptions | None = None,
    progress: Progress | None = None,
) -> ShadowMask:
    """Traces what arrives of each light that has a channel.

    Args:
        world: What stands in the way.
        subsamples: Of the texels, hidden ones already replaced.
        texels: Where they lie.
        lights: Those that the plan was made for.
        plan: From :func:`plan_shadow_mask`.
        options: How.
        progress: Shows the stage "shadow mask".
    """
    from irradia.transport.light_visibility import LightVisibility
    from irradia.transport.punctual import PunctualLights

    options, progress = options or ShadowMaskOptions(), progress or silent_progress()
    seed = Seed(options.seed).child("shadow-mask").uint32()
    kernel = LightVisibility(world, subsamples, texels.pixel, PunctualLights(lights), seed)
    visibility = np.ones((len(texels.pixel), N_CHANNELS), np.float32)
    lit = np.zeros(visibility.shape, np.bool_)
    with progress.stage(
        "shadow mask", total=len(lights) - plan.channels.count(None), unit=" lights"
    ) as stage:
        for channel in range(N_CHANNELS):
            share = kernel.nothing()
            for index in plan.members(channel):
                sharp = lights[index].radius_m == 0.0 and lights[index].angle_deg == 0.0
                share = kernel.add(share, index, subsamples.count if sharp else options.samples)
                kernel.wait()
                stage.advance()
            if plan.members(channel):
                visibility[:, channel], lit[:, channel] = share.visibility()
    return ShadowMask(visibility, lit)


def finish_shadow_mask(
    mask: ShadowMask,
    texels: TexelSet,
    valid: NDArray[np.bool_],
    pages: F32,
    finisher: Finisher,
    region: U32 | None = None,
) -> F32:
    """Pages on which every texel has a value.

    Where a channel's lights don't shine, it continues the shadows beside it on the chart, so that
    filtering darkens no terminator; charts that they don't reach at all are shadowed.

    Args:
        mask: From :func:`bake_shadow_mask`.
        texels: Where its texels lie.
        valid: (N,) False where a texel lies inside something.
        pages: (P, H, W, 3) the finished irradiance.
        finisher: That made them.
        region: (N,) of valid texels, finer than charts; shadows go on within one.

    Returns:
        (P, H, W, 4) visibility in [0, 1].
    """
    values = mask.visibility.copy()
    for channel in np.flatnonzero(mask.lit.any(axis=0)):
        known = mask.lit[:, channel] & valid
        values[:, channel] = fill_invalid(values[:, channel, None], known, texels, region)[:, 0]
    return np.clip(finisher.companion(values, pages, lowest=0.0, relative=False), 0.0, 1.0)


def _overlap(reached: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """(L, L) whether two rows of (L, K) have a patch in common."""
    bits = np.packbits(reached, axis=1)
    return np.array([(bits & row).any(axis=1) for row in bits])
