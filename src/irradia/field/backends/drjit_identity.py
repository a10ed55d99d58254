"""The coordinates themselves, in Dr.Jit."""

from __future__ import annotations

from irradia.field.backends.drjit_encoding import DrJitEncoding, Lookup
from irradia.field.backends.drjit_tiles import F
from irradia.field.encodings.identity import Identity


class DrJitIdentity(DrJitEncoding[Identity]):
    """A block is a coordinate."""

    n_blocks = 3

    def features(self, at: Lookup, parameters: F) -> list[F]:
        """See the base class."""
        return [at.coordinate(at.block)]
