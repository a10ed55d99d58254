"""What ``--probes`` and ``--probe-samples`` ask for."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

from irradia.core.errors import InputError

Placement = Literal["grid", "random", "auto"]
MAX_PROBES = 1 << 18
MAX_SAMPLES = 1 << 20
_FORMS = "grid:SPACING, random:N or auto"


@dataclass(frozen=True)
class ProbeOptions:
    """How to place probes and how well to light them.

    Attributes:
        placement: ``grid``: a lattice over the scene's space. ``random``: spread over free space.
            ``auto``: an octree, fine near geometry and where light changes.
        spacing_m: Between neighbours of a grid.
        count: Probes of ``random``, and the most that ``auto`` makes.
        samples: Rays per probe.
        seed: Root of all random numbers.
        fast_rays: Gives up watertight intersection for speed.
    """

    placement: Placement = "auto"
    spacing_m: float = 1.0
    count: int = 4096
    samples: int = 1024
    seed: int = 0
    fast_rays: bool = False

    def __post_init__(self) -> None:
        if not (math.isfinite(self.spacing_m) and self.spacing_m > 0.0):
            raise InputError(f"expected a spacing above 0 m, found {self.spacing_m:g}", where="--probes")
        if not 1 <= self.count <= MAX_PROBES:
            raise InputError(f"expected 1 to {MAX_PROBES} probes, found {self.count}", where="--probes")
        if not 1 <= self.samples <= MAX_SAMPLES:
            raise InputError(
                f"expected 1 to {MAX_SAMPLES} samples, found {self.samples}", where="--probe-samples"
            )

    @staticmethod
    def parse(text: str, *, samples: int = 1024, seed: int = 0, fast_rays: bool = False) -> ProbeOptions:
        """Reads ``grid:0.5`` (metres), ``random:2000`` or ``auto``.

        Raises:
            InputError: The text has none of these forms, or a number is out of range.
        """
        kind, _, value = text.partition(":")
        if kind == "grid" and value:
            spacing_m = _number(value, text)
            return ProbeOptions("grid", spacing_m, samples=samples, seed=seed, fast_rays=fast_rays)
        if kind == "random" and value:
            count = _number(value, text)
            if not count.is_integer():
                raise InputError(f"expected a whole number of probes, found '{value}'", where="--probes")
            return ProbeOptions("random", count=int(count), samples=samples, seed=seed, fast_rays=fast_rays)
        if text == "auto":
            return ProbeOptions("auto", samples=samples, seed=seed, fast_rays=fast_rays)
        raise InputError(f"expected {_FORMS}, found '{text}'", where="--probes", fix="Try --probes grid:1.")


def _number(value: str, text: str) -> float:
    try:
        number = float(value)
    except ValueError:
        number = math.nan
    if not math.isfinite(number):
        raise InputError(f"expected {_FORMS}, found '{text}'", where="--probes", fix="Try --probes grid:1.")
    return number
