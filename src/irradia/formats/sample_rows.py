"""What the rows of a dataset are: points of a scene and the light there, to train fields from.

A row holds position 3, unit normal 3 (not with SH), value 3, 12 or 27, variance 1. Values are E in W·m⁻², or
SH coefficients of radiance, (coefficient, channel) flattened.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any, Literal, get_args

import numpy as np
from numpy.typing import NDArray

from irradia.core.errors import InputError

Kind = Literal["surface", "volume", "sh"]
Quantity = Literal["full", "indirect"]
F32 = NDArray[np.float32]

_N_VALUES = {0: 3, 4: 12, 9: 27}


@dataclass(frozen=True)
class SampleInfo:
    """What the rows of a file are.

    Attributes:
        kind: ``surface`` and ``volume`` hold E at points with a normal, ``sh`` coefficients at points.
        quantity: ``indirect`` leaves out the first bounce of punctual lights; see docs/conventions.md.
        aabb: Minimum and maximum, metres: the box by which a field normalises positions.
        n_coefficients: SH coefficients a channel, 4 or 9; 0 of irradiance.
        samples_per_point: Paths or gather rays behind a value; 0 where nobody knows.
        provenance: Anything that JSON holds.
    """

    kind: Kind
    aabb: tuple[tuple[float, float, float], tuple[float, float, float]]
    quantity: Quantity = "full"
    n_coefficients: int = 0
    samples_per_point: int = 0
    provenance: Mapping[str, Any] = field(default_factory=dict)

    def __post_init__(self) -> None:
        if self.kind not in get_args(Kind):
            raise InputError(f"expected a kind of {', '.join(get_args(Kind))}, found {self.kind!r}")
        if self.quantity not in get_args(Quantity):
            raise InputError(f"expected a quantity of full or indirect, found {self.quantity!r}")
        if self.n_coefficients not in ((4, 9) if self.kind == "sh" else (0,)):
            raise InputError(f"{self.kind} samples can't have {self.n_coefficients} coefficients")
        if not (isinstance(self.samples_per_point, int) and self.samples_per_point >= 0):
            raise InputError(f"expected samples a point of 0 or more, found {self.samples_per_point!r}")
        if not isinstance(self.provenance, Mapping):
            raise InputError(f"expected provenance by name, found {self.provenance!r}")
        with np.errstate(over="ignore"):
            box = np.asarray(self.aabb, np.float64).astype(np.float32)
        if box.shape != (2, 3) or not np.isfinite(box).all() or np.any(box[0] > box[1]):
            raise InputError(f"expected an AABB, found {box.tolist()}")

    @property
    def has_normals(self) -> bool:
        """Whether rows have a normal."""
        return self.kind != "sh"

    @property
    def n_values(self) -> int:
        """Numbers of a value: 3, 12 or 27."""
        return _N_VALUES[self.n_coefficients]

    @property
    def n_columns(self) -> int:
        """Numbers of a row."""
        return 3 + 3 * self.has_normals + self.n_values + 1


def check_rows(rows: F32, info: SampleInfo, where: str, first: int = 0) -> None:
    """Refuses rows that can't be samples.

    Args:
        rows: (n, n_columns).
        info: What they should be.
        where: The file, for the error.
        first: Number of the first of them, for the error.

    Raises:
        InputError: A number isn't finite, a position lies outside the box, a normal isn't unit, or a
            variance is negative.
    """
    box = np.array(info.aabb, np.float32)
    slack = np.float32(1e-4) * np.maximum(box[1] - box[0], np.float32(1e-3))
    for problem, bad in _problems(rows, info, box[0] - slack, box[1] + slack):
        if bad.any():
            row = first + int(np.flatnonzero(bad)[0])
            raise InputError(f"expected {problem}, but row {row} is not so", where=where)


def _problems(rows: F32, info: SampleInfo, low: F32, high: F32) -> Iterator[tuple[str, Any]]:
    """What is expected, and (n,) which rows are not so."""
    yield "finite numbers", ~np.isfinite(rows).all(axis=1)
    positions = rows[:, :3]
    yield "positions in the AABB", np.any((positions < low) | (positions > high), axis=1)
    if info.has_normals:
        squared = np.einsum("ij,ij->i", rows[:, 3:6], rows[:, 3:6])
        yield "normals of length 1", np.abs(squared - 1.0) > np.full_like(squared, 1e-2)
    yield "variances of 0 or more", rows[:, -1] < 0.0
