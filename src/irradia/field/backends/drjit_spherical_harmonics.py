"""Spherical harmonics in Dr.Jit; :mod:`irradia.field.encodings.spherical_harmonics` says which."""

from __future__ import annotations

import math
from types import ModuleType

from irradia.field.backends.drjit_encoding import DrJitEncoding, Lookup
from irradia.field.backends.drjit_tiles import F
from irradia.field.encodings.spherical_harmonics import SphericalHarmonics, normalisation


class DrJitSphericalHarmonics(DrJitEncoding[SphericalHarmonics]):
    """All of a direction's are one block: they share their polynomials."""

    def __init__(self, encoding: SphericalHarmonics, jit: ModuleType, first: int) -> None:
        super().__init__(encoding, jit, first)
        self.block_size = encoding.n_outputs

    def features(self, at: Lookup, parameters: F) -> list[F]:
        """See the base class."""
        degree = self.encoding.degree
        x, y, z = (2.0 * at.coordinate(axis) - 1.0 for axis in range(3))
        found = [self.jit.Float(0.0)] * self.block_size
        # cos mφ and sin mφ times sin^m θ, which the Legendre part leaves out.
        cosine, sine = self.jit.Float(1.0), self.jit.Float(0.0)
        for m in range(degree):
            for order, polynomial in enumerate(_legendre(degree, m, z), start=m):
                scaled = normalisation(order, m) * polynomial
                centre = order * (order + 1)
                found[centre + m] = scaled * cosine
                if m:
                    found[centre - m] = scaled * sine
            cosine, sine = x * cosine - y * sine, x * sine + y * cosine
        return found


def _legendre(degree: int, m: int, z: F) -> list[F]:
    """P_l^m(z) / sin^m θ without Condon and Shortley's sign, for l from m to degree − 1."""
    found = [type(z)(math.prod(range(1, 2 * m, 2)))]
    before = type(z)(0.0)
    for order in range(m + 1, degree):
        last = found[-1]
        found.append(((2 * order - 1) * z * last - (order + m - 1) * before) / (order - m))
        before = last
    return found
