"""Real spherical harmonics of a direction, by the recurrence of associated Legendre polynomials."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from irradia.core.errors import InputError
from irradia.field.encoding import Array, Encoding

MAX_DEGREE = 5


@dataclass(frozen=True)
class SphericalHarmonics(Encoding):
    """Y_lm for l below ``degree``, by l and then m from −l to l; every constant positive.

    As in tiny-cuda-nn the input v lies in [0, 1]³ and the direction is 2v − 1, and ``degree`` counts bands.
    Its signs differ: ours are those of docs/conventions.md.

    Attributes:
        degree: Bands, so 4 has l from 0 to 3.
    """

    name: ClassVar[str] = "sh"

    degree: int = 4

    def __post_init__(self) -> None:
        if not 1 <= self.degree <= MAX_DEGREE:
            raise InputError(f"expected 1–{MAX_DEGREE} bands, found {self.degree}")

    @property
    def n_outputs(self) -> int:
        """degree²."""
        return self.degree**2

    def forward(self, x: Array, parameters: Array) -> Array:
        """Y_lm (N, degree²) of directions 2x − 1, which are taken to have unit length."""
        direction = 2.0 * x.astype(np.float64) - 1.0
        features = np.empty((len(x), self.n_outputs))
        # cos mφ and sin mφ times sin^m θ, which the Legendre part below leaves out.
        cosine, sine = np.ones(len(x)), np.zeros(len(x))
        for m in range(self.degree):
            for order, polynomial in enumerate(_legendre(self.degree, m, direction[:, 2]), start=m):
                factor = normalisation(order, m)
                centre = order * (order + 1)
                features[:, centre + m] = factor * polynomial * cosine
                if m:
                    features[:, centre - m] = factor * polynomial * sine
            cosine, sine = (
                direction[:, 0] * cosine - direction[:, 1] * sine,
                direction[:, 0] * sine + direction[:, 1] * cosine,
            )
        return features.astype(parameters.dtype)


def normalisation(order: int, m: int) -> float:
    """What makes Y_lm orthonormal, for l = ``order`` and m ≥ 0."""
    ratio = math.factorial(order - m) / math.factorial(order + m)
    return math.sqrt((2 * order + 1) / (4.0 * math.pi) * ratio * (2.0 if m else 1.0))


def _legendre(degree: int, m: int, z: Array) -> list[Array]:
    """P_l^m(z) / sin^m θ without Condon and Shortley's sign, for l from m to degree − 1."""
    found = [np.full_like(z, math.prod(range(1, 2 * m, 2)))]
    before = np.zeros_like(z)
    for order in range(m + 1, degree):
        last = found[-1]
        found.append(((2 * order - 1) * z * last - (order + m - 1) * before) / (order - m))
        before = last
    return found
