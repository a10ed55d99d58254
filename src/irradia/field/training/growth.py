"""Training from a dataset that is still being sampled.

What is drawn then depends on how fast samples come, so such a training can't be repeated bit by bit.
"""

from __future__ import annotations

import time
from collections.abc import Generator
from dataclasses import replace

from irradia.core.errors import InputError
from irradia.field.training.batches import BatchSource
from irradia.field.training.events import Remark, Working
from irradia.field.training.prepare import DataPlan, prepare
from irradia.formats.samples import SampleFile, is_being_written

FACTOR = 1.5  # rows are read again when there are so many times as many, so all in all about thrice
LOOK_EVERY_S = 2.0
_WAIT_S = 0.25


def wait_for_rows(samples: SampleFile, wanted: int) -> Generator[Working, None, SampleFile]:
    """Waits until a growing dataset has enough rows to start with, or grows no more.

    Raises:
        InputError: It was given up before its first row.
    """
    while not samples.finished and len(samples) < wanted and grows(samples):
        yield Working("Wait for samples", len(samples), wanted, "rows")
        time.sleep(_WAIT_S)
        samples = samples.grown()
    samples = samples.grown()  # whoever wrote may have ended between the look at the rows and that at him
    if not len(samples):
        raise InputError(
            "expected samples, found none, and nobody writes any",
            where=str(samples.path),
            fix="Sample again.",
        )
    return samples


def grows(samples: SampleFile) -> bool:
    """Whether a process still writes it."""
    return not samples.finished and is_being_written(samples.path.with_suffix(""))


def latest(samples: SampleFile) -> SampleFile:
    """With the rows that have come since; as it was where the file has gone, whose rows stay readable."""
    try:
        return samples.grown()
    except (InputError, OSError):
        return samples


class Growth:
    """The source of batches of a dataset that may grow; of a finished one it stays the same.

    Args:
        samples: As read.
        source: Made of them.
        plan: To make the next one with.
    """

    def __init__(self, samples: SampleFile, source: BatchSource, plan: DataPlan) -> None:
        self.samples, self.source = samples, source
        self._plan = plan
        self._looked = time.monotonic()
        self._ended = False

    def follow(self) -> Generator[Remark, None, None]:
        """Takes in what has come, where that is worth it.

        Yields:
            A remark about it.
        """
        now = time.monotonic()
        if self.samples.finished or self._ended or now - self._looked < LOOK_EVERY_S:
            return
        self._looked = now
        try:
            grown = self.samples.grown()
        except (InputError, OSError) as error:  # what has been read stays readable
            self._ended = True
            why = str(error).splitlines()[0]
            yield Remark(f"No more samples can be read; training goes on with {len(self.samples):,}: {why}.")
            return
        if not grown.finished and len(grown) < FACTOR * len(self.samples):
            return
        most = self._plan.most_rows(grown.info.n_columns)
        state = "all there are" if grown.finished else "so far"
        if most is not None and len(grown) > most:
            self._ended = True
            grown = replace(grown, rows=grown.rows[: max(most, len(self.samples))])
            state = "as many as --memory holds with what smoothing and jitter need of it"
        if len(grown) > len(self.samples):
            self.source = _drained(prepare(grown, self._plan))
        self.samples = grown
        yield Remark(f"Training from {len(grown):,} samples, {state}.")


def _drained(preparing: Generator[object, None, BatchSource]) -> BatchSource:
    """What a generator returns; what it tells is of no interest in the middle of a training."""
    while True:
        try:
            next(preparing)
        except StopIteration as end:
            return end.value
