"""Random numbers that places are made of."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from irradia.core.rng import Seed

F64 = NDArray[np.float64]

# The generalised golden ratio in three dimensions (Roberts 2018, "The Unreasonable Effectiveness of
# Quasirandom Sequences"): g⁴ = g + 1.
_R3 = np.array([0.8191725133961645, 0.6710436067037893, 0.5497004779019703])


class CubePoints:
    """Points of the unit cube, as many as one asks for.

    Args:
        seed: Where they begin.
        stratified: Whether they fill the cube evenly, at any number of them; else they are independent.
    """

    def __init__(self, seed: Seed, *, stratified: bool = False) -> None:
        self._rng = seed.numpy()
        self._start = self._rng.random(3) if stratified else None
        self._n_drawn = 0

    def draw(self, n: int) -> F64:
        """The next (n, 3)."""
        if self._start is None:
            return self._rng.random((n, 3))
        index = np.arange(self._n_drawn, self._n_drawn + n)[:, None]
        self._n_drawn += n
        return (self._start + index * _R3) % 1.0


def unit_vectors(u: F64) -> F64:
    """(N, 3) directions, all equally likely, from two of (N, 3) random numbers each."""
    z = 1.0 - 2.0 * u[:, 0]
    radius, angle = np.sqrt(1.0 - z * z), 2.0 * np.pi * u[:, 1]
    return np.stack([radius * np.cos(angle), radius * np.sin(angle), z], axis=1)
