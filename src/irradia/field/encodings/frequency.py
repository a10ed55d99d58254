"""Sines and cosines of doubling frequency (Mildenhall et al. 2020, equation 4)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from irradia.core.errors import InputError
from irradia.field.encoding import Array, Encoding


@dataclass(frozen=True)
class Frequency(Encoding):
    """sin and cos of 2^k · π · x, for k from 0; coordinate by coordinate, then by k, then sin before cos.

    The order and the π are tiny-cuda-nn's. With ``include_identity`` x, y and z come before all of them.

    Attributes:
        n_frequencies: Of each coordinate.
        include_identity: Whether the coordinates themselves are features too.
    """

    name: ClassVar[str] = "frequency"

    n_frequencies: int = 10
    include_identity: bool = False

    def __post_init__(self) -> None:
        if not 1 <= self.n_frequencies <= 24:
            raise InputError(f"expected 1–24 frequencies, found {self.n_frequencies}")

    @property
    def n_outputs(self) -> int:
        """3 · 2 · frequencies, and 3 for the identity."""
        return 6 * self.n_frequencies + 3 * self.include_identity

    def forward(self, x: Array, parameters: Array) -> Array:
        """Waves (N, n_outputs).

        The argument is brought into ±π while it still is a multiple of π: doubling a float is exact and so is
        taking the nearest even number away, while 2^k · π · x in floats would be off by 2^k roundings.
        """
        half_turns = x[:, :, None] * np.exp2(np.arange(self.n_frequencies)).astype(x.dtype)
        half_turns -= 2.0 * np.rint(0.5 * half_turns)
        angle = np.pi * half_turns.astype(np.float64)
        waves = np.stack([np.sin(angle), np.cos(angle)], axis=-1).reshape(len(x), 6 * self.n_frequencies)
        if self.include_identity:
            waves = np.concatenate([x, waves], axis=1)
        return waves.astype(parameters.dtype)
