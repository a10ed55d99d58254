"""Sines and cosines in Dr.Jit; :mod:`irradia.field.encodings.frequency` says which."""

from __future__ import annotations

import math
from types import ModuleType

import drjit as dr

from irradia.field.backends.drjit_encoding import DrJitEncoding, Lookup
from irradia.field.backends.drjit_tiles import F
from irradia.field.encodings.frequency import Frequency


class DrJitFrequency(DrJitEncoding[Frequency]):
    """A block is a sine and a cosine: that of a coordinate and an octave."""

    block_size = 2

    def __init__(self, encoding: Frequency, jit: ModuleType, first: int) -> None:
        super().__init__(encoding, jit, first)
        self.n_blocks = 3 * encoding.n_frequencies

    def features(self, at: Lookup, parameters: F) -> list[F]:
        """See the base class."""
        n_frequencies = self.encoding.n_frequencies
        octave = at.block % n_frequencies
        power = self.jit.Float(self.jit.UInt(1) << octave)
        half_turns = at.coordinate(at.block // n_frequencies) * power  # exact, and so is the next line
        half_turns -= 2.0 * dr.round(0.5 * half_turns)
        return list(dr.sincos(math.pi * half_turns))
