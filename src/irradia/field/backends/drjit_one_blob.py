"""Soft one-hot vectors in Dr.Jit; :mod:`irradia.field.encodings.one_blob` says what they are."""

from __future__ import annotations

from types import ModuleType

import drjit as dr

from irradia.field.backends.drjit_encoding import DrJitEncoding, Lookup
from irradia.field.backends.drjit_tiles import F
from irradia.field.encodings.one_blob import OneBlob


class DrJitOneBlob(DrJitEncoding[OneBlob]):
    """A block is a bin of a coordinate."""

    def __init__(self, encoding: OneBlob, jit: ModuleType, first: int) -> None:
        super().__init__(encoding, jit, first)
        self.n_blocks = encoding.n_outputs

    def features(self, at: Lookup, parameters: F) -> list[F]:
        """See the base class."""
        n_bins = self.encoding.n_bins
        edge = self.jit.Float(at.block % n_bins)
        # The distance from a bin's edge is rounded once, however many bins there are.
        below = dr.fma(at.coordinate(at.block // n_bins), -float(n_bins), edge)
        return [_quartic_cdf(below + 1.0) - _quartic_cdf(below)]


def _quartic_cdf(u: F) -> F:
    """∫ 15/16 (1 − u²)² from −1; 0 below and 1 above ±1."""
    u = dr.clip(u, -1.0, 1.0)
    square = u * u
    return 0.5 + 15.0 / 16.0 * u * (1.0 - 2.0 / 3.0 * square + 0.2 * square * square)
