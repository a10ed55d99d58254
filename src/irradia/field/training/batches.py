"""Random batches that depend on the seed and the step alone, not on what was drawn before.

So a training that goes on from a checkpoint sees the batches that it would have seen, and threads have
no say. Rows are drawn with replacement. What fits into memory is drawn from as a whole
(:class:`MemorySource`); a larger file through a window (:mod:`irradia.field.training.windows`).
"""

from __future__ import annotations

from abc import ABC, abstractmethod

import numpy as np
from numpy.typing import NDArray

from irradia.core.rng import Seed
from irradia.field.backend import Batch
from irradia.field.training.rows import BatchMemory, Rows


class BatchSource(ABC):
    """Where batches come from."""

    @property
    @abstractmethod
    def n_rows(self) -> int:
        """Rows that may be drawn in the course of a training."""

    @abstractmethod
    def batch(self, step: int, size: int, seed: Seed) -> Batch:
        """The batch of a step; the same arguments give the same batch, which is good until the next."""


class MemorySource(BatchSource):
    """Draws from rows that are all in memory."""

    def __init__(self, rows: Rows) -> None:
        self._rows = rows
        self._memory = LastMemory()

    @property
    def n_rows(self) -> int:
        """All of them."""
        return len(self._rows)

    def batch(self, step: int, size: int, seed: Seed) -> Batch:
        """See :class:`BatchSource`."""
        packed, has_normals = self._rows.packed, self._rows.has_normals
        memory = self._memory.of(size, packed.shape[1], has_normals=has_normals)
        return memory.take(packed, draw(len(packed), step, size, seed))


class LastMemory:
    """Memory for batches of the size that was asked for last."""

    def __init__(self) -> None:
        self._last: BatchMemory | None = None

    def of(self, size: int, n_columns: int, *, has_normals: bool) -> BatchMemory:
        """Memory for batches of that size."""
        if self._last is None or len(self._last.picked) != size:
            self._last = BatchMemory(size, n_columns, has_normals=has_normals)
        return self._last


def draw(n: int, step: int, size: int, seed: Seed) -> NDArray[np.int64]:
    """``size`` numbers below n for one step, by a counter-based generator (Philox; Salmon et al. 2011)."""
    generator = np.random.Philox(key=seed.uint32(), counter=[0, 0, 0, step])
    return np.random.Generator(generator).integers(0, n, size)
