"""Random batches from a file that is larger than the memory for it.

The file is cut into blocks that are read at once. A pass takes all blocks in a random order, a group of
them at a time; a window of several groups is in memory and batches are drawn from it. Every so many steps
the oldest group makes room for the next. On average each row is drawn once while it is there, so a pass
over the groups is an epoch, and rows that are neighbours in the file meet those of the whole scene.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from irradia.core.rng import Seed
from irradia.field.backend import F32, Batch
from irradia.field.spec import FieldFrame
from irradia.field.training.batches import BatchSource, LastMemory, draw
from irradia.field.training.rows import HeldOut, pack
from irradia.formats.samples import SampleFile

BLOCK_ROWS = 1 << 14  # about half a megabyte
N_GROUPS = 8  # in a window


class WindowSource(BatchSource):
    """Draws from a window that moves over a file.

    Args:
        samples: The file, memory-mapped.
        frame: The field's units.
        kept_back: What training must not see.
        memory_bytes: Of the window.
        seed: Of the order in which blocks come.
        batch_size: Of training, which says when the window moves.
        block_rows: Rows that are read at once.
    """

    def __init__(
        self,
        samples: SampleFile,
        frame: FieldFrame,
        kept_back: HeldOut,
        memory_bytes: int,
        seed: Seed,
        batch_size: int,
        block_rows: int = BLOCK_ROWS,
    ) -> None:
        self._samples, self._frame, self._kept_back, self._seed = samples, frame, kept_back, seed
        self._block_rows = block_rows
        self._n_blocks = -(-len(samples) // block_rows)
        row_bytes = 4 * samples.info.n_columns
        affordable = memory_bytes // (N_GROUPS * block_rows * row_bytes)
        self._group_blocks = int(np.clip(affordable, 1, -(-self._n_blocks // N_GROUPS)))
        self._shift_steps = max(1, round(self._group_blocks * block_rows / batch_size))
        self._memory = LastMemory()
        capacity = self._group_blocks * block_rows
        self._slots = np.empty((N_GROUPS, capacity, samples.info.n_columns), np.float32)  # packed rows
        self._numbers = np.full(N_GROUPS, -1)  # which group is in each slot
        self._counts = np.zeros(N_GROUPS, np.int64)  # and how many rows

    @property
    def n_rows(self) -> int:
        """All rows of the file, those too that are held out."""
        return len(self._samples)

    def batch(self, step: int, size: int, seed: Seed) -> Batch:
        """See :class:`BatchSource`."""
        self._move_to(step // self._shift_steps)
        ends = np.cumsum(self._counts)
        drawn = draw(int(ends[-1]), step, size, seed)
        slot = np.searchsorted(ends, drawn, side="right")
        gaps = np.arange(N_GROUPS) * self._slots.shape[1] - (ends - self._counts)
        info = self._samples.info
        memory = self._memory.of(size, info.n_columns, has_normals=info.has_normals)
        return memory.take(self._slots.reshape(-1, info.n_columns), drawn + gaps[slot])

    def _move_to(self, first: int) -> None:
        """Brings the groups from the ``first``-th on into memory, each to the slot of its number."""
        for number in range(first, first + N_GROUPS):
            slot = number % N_GROUPS
            if self._numbers[slot] != number:
                self._counts[slot] = self._read(number, self._slots[slot])
                self._numbers[slot] = number

    def _read(self, number: int, into: F32) -> int:
        """Reads one group, counted over all passes; returns the number of its rows."""
        filled = 0
        for block in self._blocks(number):
            first = int(block) * self._block_rows
            rows = self._samples.rows[first : first + self._block_rows]
            learned = self._kept_back.learned(np.arange(first, first + len(rows)), rows[:, :3])
            n_learned = int(learned.sum())
            into[filled : filled + n_learned] = rows[learned]
            filled += n_learned
        pack(into[:filled], self._samples.info.n_values, self._frame)
        return filled

    def _blocks(self, number: int) -> NDArray[np.int64]:
        """Which blocks are in a group."""
        groups_per_pass = -(-self._n_blocks // self._group_blocks)
        over, within = divmod(number, groups_per_pass)
        order = self._seed.child(f"pass-{over}").numpy().permutation(self._n_blocks)
        return order[within * self._group_blocks : (within + 1) * self._group_blocks]
