"""What ``irradia sample`` can be asked for."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Literal, get_args

from irradia.core.errors import InputError
from irradia.formats.sample_rows import Quantity

Placement = Literal["surface", "volume", "sh-grid", "sh-random"]
Integrator = Literal["cached", "path"]

MAX_COUNT = 1 << 30  # as many sequences of random numbers there are
MAX_SAMPLES = 1 << 20
DEFAULT_COUNT: dict[Placement, int] = {
    "surface": 2_000_000,
    "volume": 2_000_000,
    "sh-grid": 200_000,
    "sh-random": 200_000,
}
VALIDATION_QUALITY = 16  # times the samples at a point


@dataclass(frozen=True)
class SampleOptions:
    """Which points, and how well their light is known.

    Attributes:
        placement: ``surface``: evenly over the visible sides of surfaces. ``volume``: in free space
            under random normals, a fifth of them on surfaces. ``sh-grid``, ``sh-random``: spherical
            harmonics in free space.
        count: Points; of a grid the sites in the box, and ``spacing_m`` goes before. None for as many as
            DEFAULT_COUNT has.
        spacing_m: Between the sites of a grid.
        order: Of spherical harmonics, 1 or 2.
        quantity: ``indirect`` leaves out the first bounce of punctual lights, as ``irradia bake --mode
            indirect`` does.
        integrator: ``cached``: rays read a finished lightmap where they meet surfaces. ``path``: they go
            on to the end.
        samples: Rays a point, and as many next-event samples: a multiple of four.
        stratified: Whether positions fill surface or space evenly, at every length of the file.
        seed: Root of all random numbers.
        fast_rays: Gives up watertight intersection for speed.
    """

    placement: Placement = "surface"
    count: int | None = None
    spacing_m: float | None = None
    order: int = 1
    quantity: Quantity = "full"
    integrator: Integrator = "cached"
    samples: int = 64
    stratified: bool = False
    seed: int = 0
    fast_rays: bool = False

    def __post_init__(self) -> None:
        for value, kinds, where in (
            (self.placement, get_args(Placement), "--kind"),
            (self.quantity, get_args(Quantity), "--quantity"),
            (self.integrator, get_args(Integrator), "--integrator"),
            (self.order, (1, 2), "--order"),
        ):
            if value not in kinds:
                raise InputError(f"expected {' or '.join(map(str, kinds))}, found {value!r}", where=where)
        if not 1 <= self.n_points <= MAX_COUNT:
            raise InputError(f"expected 1 to {MAX_COUNT} points, found {self.count}", where="--count")
        if not (4 <= self.samples <= MAX_SAMPLES and self.samples % 4 == 0):
            raise InputError(
                f"expected 4 to {MAX_SAMPLES} samples a point, a multiple of 4, found {self.samples}",
                where="--samples",
            )
        if self.spacing_m is not None and not (math.isfinite(self.spacing_m) and self.spacing_m > 0.0):
            raise InputError(f"expected a spacing above 0 m, found {self.spacing_m:g}", where="--spacing")
        if self.spacing_m is not None and self.placement != "sh-grid":
            raise InputError("goes with --kind sh-grid", where="--spacing")

    @property
    def n_points(self) -> int:
        """How many points are wanted."""
        return DEFAULT_COUNT[self.placement] if self.count is None else self.count

    @property
    def is_sh(self) -> bool:
        """Whether coefficients are kept, rather than E on a normal."""
        return self.placement in ("sh-grid", "sh-random")

    @property
    def n_coefficients(self) -> int:
        """SH coefficients a channel; 0 of irradiance."""
        return (self.order + 1) ** 2 if self.is_sh else 0

    def for_validation(self, count: int) -> SampleOptions:
        """An independent set of the same kind, at random places and of higher quality.

        Raises:
            InputError: It would need more samples a point than there may be.
        """
        return replace(
            self,
            placement="sh-random" if self.is_sh else self.placement,
            count=count,
            spacing_m=None,
            samples=self.samples * VALIDATION_QUALITY,
            stratified=False,
        )
