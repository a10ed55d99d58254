"""Several encodings of the same point, side by side."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from irradia.core.errors import InputError
from irradia.field.encoding import Array, Encoding, TensorSlot
from irradia.field.encodings.identity import Identity


@dataclass(frozen=True)
class Composite(Encoding):
    """Concatenates the features of its parts, and their parameters, in order.

    All parts get the same input in [0, 1]³, so here an identity sees a normal as (n + 1) / 2.

    Attributes:
        parts: At least one.
    """

    name: ClassVar[str] = "composite"

    parts: tuple[Encoding, ...] = (Identity(),)

    def __post_init__(self) -> None:
        if not self.parts or not all(isinstance(part, Encoding) for part in self.parts):
            raise InputError("expected at least one part of a composite encoding, and all of them encodings")

    @property
    def n_outputs(self) -> int:
        """Of all parts."""
        return sum(part.n_outputs for part in self.parts)

    def tensors(self) -> tuple[TensorSlot, ...]:
        """Those of the parts, with the part's index before the name."""
        return tuple(
            TensorSlot(f"{i}.{slot.name}", slot.shape)
            for i, part in enumerate(self.parts)
            for slot in part.tensors()
        )

    def init(self, rng: np.random.Generator) -> NDArray[np.float32]:
        """Each part as it likes to start."""
        return np.concatenate([part.init(rng) for part in self.parts])

    def forward(self, x: Array, parameters: Array) -> Array:
        """Features (N, n_outputs) of the parts in order."""
        return np.concatenate(
            [part.forward(x, parameters[own]) for part, own, _ in self.slices()],
            axis=1,
        )

    def backward(self, x: Array, parameters: Array, gradient: Array) -> Array:
        """Gradient (P,) of each part from its own features."""
        return np.concatenate(
            [part.backward(x, parameters[own], gradient[:, out]) for part, own, out in self.slices()]
        )

    def slices(self) -> Iterator[tuple[Encoding, slice, slice]]:
        """Each part with its range of parameters and its range of features."""
        first, column = 0, 0
        for part in self.parts:
            yield (
                part,
                slice(first, first + part.n_parameters),
                slice(column, column + part.n_outputs),
            )
            first += part.n_parameters
            column += part.n_outputs

    def spec(self) -> dict[str, Any]:
        """The specs of the parts within its own."""
        return {"type": self.name, "parts": [part.spec() for part in self.parts]}
