"""Times both sides of the field benchmark in turns."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from statistics import median
from typing import Literal

from support.field_agreement import Agreement
from support.field_models import Model
from support.field_sides import Worker

Work = Literal["step", "infer"]


@dataclass(frozen=True)
class Rounds:
    """Seconds of one kind of work, a figure a round for each side.

    Attributes:
        ours, peer: Medians of a round's calls.
    """

    ours: tuple[float, ...]
    peer: tuple[float, ...]

    @property
    def ratios(self) -> tuple[float, ...]:
        """How many times faster we are, by round."""
        return tuple(peer / ours for ours, peer in zip(self.ours, self.peer, strict=True))


@dataclass(frozen=True)
class Measured:
    """One field's figures.

    Attributes:
        batch: Samples a call.
        step, infer: Training steps, and evaluations of as many points.
    """

    model: Model
    agreement: Agreement
    batch: int
    step: Rounds
    infer: Rounds


def measure(ours: Worker, peer: Worker, work: Work, *, n_rounds: int, round_s: float) -> Rounds:
    """Has both do ``work`` in turns, the peer first, each for about ``round_s`` a round."""
    turns = [_turn(worker, work, round_s) for worker in (peer, ours)]
    seconds = [[turn() for turn in turns] for _ in range(n_rounds)]
    return Rounds(ours=tuple(s[1] for s in seconds), peer=tuple(s[0] for s in seconds))


def _turn(worker: Worker, work: Work, round_s: float) -> Callable[[], float]:
    """Warms a side up; what comes back gives the median of one round."""
    warm = median(worker.ask(work, n=3)["seconds"])
    n_calls = max(3, round(round_s / warm))

    def turn() -> float:
        # The first call finds the caches full of the other side's data.
        return median(worker.ask(work, n=n_calls + 1)["seconds"][1:])

    return turn
