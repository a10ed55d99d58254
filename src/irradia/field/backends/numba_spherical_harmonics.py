"""The fast version of :class:`irradia.field.encodings.SphericalHarmonics`."""

from __future__ import annotations

import math

import numpy as np

from irradia.field.backends.numba_compile import inner, kernel, take
from irradia.field.backends.numba_encoding import F32, TILE, NumbaEncoding
from irradia.field.backends.numba_team import Team
from irradia.field.backends.numba_vector import load8, splat8, store8
from irradia.field.backends.numba_vector_type import LANES
from irradia.field.encodings import SphericalHarmonics
from irradia.field.encodings.spherical_harmonics import normalisation


class NumbaSphericalHarmonics(NumbaEncoding[SphericalHarmonics]):
    """The definition's recurrences, with eight directions in registers."""

    def __init__(self, encoding: SphericalHarmonics, team: Team) -> None:
        super().__init__(encoding, team)
        n = encoding.degree
        self._factors = np.zeros((n, n), np.float32)  # [l, m]; of P_m^m and its (2 m − 1)!! where l = m
        for m in range(n):
            for order in range(m, n):
                self._factors[order, m] = normalisation(order, m) * math.prod(range(1, 2 * m, 2))

    def forward(self, points: F32, parameters: F32, features: F32, row: int) -> None:
        """As the base says."""
        self.team.run(_all_harmonics, points, features, row, self._factors)


@kernel
def _all_harmonics(_thread, next_task, points, features, row, factors):
    index = take(next_task)
    while index < len(features):
        for s in range(0, TILE, LANES):
            _harmonics8(points, index * TILE + s, features[index], row, s, factors)
        index = take(next_task)


@inner
def _harmonics8(points, sample, tile, row, s, factors):
    """All Y_lm of eight directions."""
    degree = len(factors)
    x = 2.0 * load8(points, (0, sample)) - 1.0
    y = 2.0 * load8(points, (1, sample)) - 1.0
    z = 2.0 * load8(points, (2, sample)) - 1.0
    cosine, sine = splat8(1.0), splat8(0.0)  # of m φ, times sin^m θ
    for m in range(degree):
        before, legendre = splat8(0.0), splat8(1.0)  # P_{l−1}^m and P_l^m over (2 m − 1)!! sin^m θ
        for order in range(m, degree):
            scaled = legendre * factors[order, m]
            centre = row + order * (order + 1)
            if m > 0:
                store8(tile, (centre - m, s), scaled * sine)
            store8(tile, (centre + m, s), scaled * cosine)
            rise = np.float32(2 * order + 1) / np.float32(order + 1 - m)
            fall = np.float32(order + m) / np.float32(order + 1 - m)
            before, legendre = legendre, rise * z * legendre - fall * before
        cosine, sine = x * cosine - y * sine, x * sine + y * cosine
