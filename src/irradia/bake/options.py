"""How to bake: every choice that decides a lightmap's values."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

from irradia.bake.directional_modes import DirectionalName
from irradia.bake.plan import CACHED_NEE_RATIO
from irradia.core.errors import InputError

Integrator = Literal["cached", "path"]
Mode = Literal["full", "indirect", "direct"]
MAX_SAMPLES = 1 << 20
_SAMPLES_OF_AN_OPEN_BAKE = 256  # what its early epochs are sized for


@dataclass(frozen=True)
class BakeOptions:
    """How to bake.

    A bake ends at the first of its limits: ``samples``, ``time_s``, ``noise``.

    Attributes:
        samples: Rays per texel that make the result; the mean over texels where rays are spread
            adaptively. None leaves the end to the other limits.
        time_s: Seconds of tracing.
        noise: Target for the 95th percentile of standard error over mean (plus 1 % of the median).
        adaptive: Spreads rays by noise even without a target.
        integrator: ``cached`` gather, or the unbiased ``path`` reference.
        mode: ``full`` light; ``indirect`` leaves out the first bounce of punctual lights; ``direct``
            is the first bounce of everything alone.
        seed: Root of all random numbers.
        fast_rays: Gives up watertight intersection for speed.
        denoise: Whether the finished pages are denoised.
        indirect_clamp: Largest radiance that a gather ray may bring, in units of the map; None, the
            default, keeps the bake unbiased.
        directional: Maps of the light's direction beside the plain map, or None.
        normal_maps: Whether texels receive light on the normals of their normal textures.
        seams: Whether edges that are one in space are made to agree across charts.
        direct_map: Whether the part that punctual lights send straight is a map of its own as well.
    """

    samples: int | None = 64
    time_s: float | None = None
    noise: float | None = None
    adaptive: bool = False
    integrator: Integrator = "cached"
    mode: Mode = "full"
    seed: int = 0
    fast_rays: bool = False
    denoise: bool = True
    indirect_clamp: float | None = None
    directional: DirectionalName | None = None
    normal_maps: bool = False
    seams: bool = True
    direct_map: bool = False

    def __post_init__(self) -> None:
        if self.samples is None and self.time_s is None and self.noise is None:
            raise InputError("expected a limit: samples, a time or a noise level", where="--samples")
        if self.samples is not None and not 1 <= self.samples <= MAX_SAMPLES:
            raise InputError(f"expected 1 to {MAX_SAMPLES} samples, found {self.samples}", where="--samples")
        for value, where in (
            (self.time_s, "--time"),
            (self.noise, "--noise"),
            (self.indirect_clamp, "--indirect-clamp"),
        ):
            if value is not None and not (math.isfinite(value) and value > 0.0):
                raise InputError(f"expected a number above 0, found {value}", where=where)
        if self.directional is not None and self.normal_maps:
            raise InputError(
                "expected directional maps or normal-mapped plain maps, found both",
                where="--normal-maps",
                fix="Directional maps are for normal maps at run time; bake those alone.",
            )
        if self.integrator not in ("cached", "path"):
            raise InputError(f"expected cached or path, found {self.integrator!r}", where="--integrator")
        if self.mode not in ("full", "indirect", "direct"):
            raise InputError(f"expected full, indirect or direct, found {self.mode!r}", where="--mode")

    @property
    def cached(self) -> bool:
        """Whether surfaces that rays meet read their light from the map."""
        return self.integrator == "cached"

    @property
    def planned_samples(self) -> int:
        """What the early epochs and the first light are sized for."""
        return self.samples if self.samples is not None else _SAMPLES_OF_AN_OPEN_BAKE

    @property
    def nee_ratio(self) -> float:
        """Next-event samples per gather ray: fewer where a cache spares most of the noise."""
        return CACHED_NEE_RATIO if self.cached and not self.one_bounce else 1.0

    @property
    def one_bounce(self) -> bool:
        """Whether light ends where it first arrives."""
        return self.mode == "direct"

    @property
    def watches_noise(self) -> bool:
        """Whether rays go where the noise is."""
        return self.adaptive or self.noise is not None
