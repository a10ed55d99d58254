"""The coordinates themselves."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from irradia.field.encoding import Array, Domain, Encoding


@dataclass(frozen=True)
class Identity(Encoding):
    """Passes x, y and z on; a normal comes as it is, in [−1, 1]."""

    name: ClassVar[str] = "identity"
    domain: ClassVar[Domain] = "any"

    @property
    def n_outputs(self) -> int:
        """3."""
        return 3

    def forward(self, x: Array, parameters: Array) -> Array:
        """The points (N, 3)."""
        return x.astype(parameters.dtype)
