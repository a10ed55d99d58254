"""The fast version of :class:`irradia.field.encodings.Composite`."""

from __future__ import annotations

from irradia.field.backends.numba_adam import Adam, Learned
from irradia.field.backends.numba_encoding import F32, NumbaEncoding, accelerate
from irradia.field.backends.numba_team import Team
from irradia.field.encodings import Composite


class NumbaComposite(NumbaEncoding[Composite]):
    """Has the fast version of each part write to rows of its own."""

    def __init__(self, encoding: Composite, team: Team) -> None:
        super().__init__(encoding, team)
        self._parts = [(accelerate(part, team), own, rows.start) for part, own, rows in encoding.slices()]

    def forward(self, points: F32, parameters: F32, features: F32, row: int) -> None:
        """As the base says."""
        for part, own, first in self._parts:
            part.forward(points, parameters[own], features, row + first)

    def learn(self, points: F32, gradients: F32, row: int, learned: Learned, adam: Adam) -> None:
        """As the base says."""
        for part, own, first in self._parts:
            if part.encoding.n_parameters:
                part.learn(points, gradients, row + first, learned.part(own.start, own.stop), adam)
