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
        self._groups: dict[int, F32] = {}  # packed rows by number of the group

    @property
    def n_rows(self) -> int:
        """All rows of the file, those too that are held out."""
        return len(self._samples)

    def batch(self, step: int, size: int, seed: Seed) -> Batch:
        """See :class:`BatchSource`."""
        groups = self._window(step // self._shift_steps)
        ends = np.cumsum([len(group) for group in groups])
        drawn = draw(int(ends[-1]), step, size, seed)
        info = self._samples.info
        memory = self._memory.of(size, info.n_columns, has_normals=info.has_normals)
        _gather(groups, ends, drawn, memory.picked)
        return memory.split()

    def _window(self, first: int) -> list[F32]:
        """The groups in memory from the ``first``-th on, after reading those that are not there yet."""
        wanted = range(first, first + N_GROUPS)
        kept = {number: rows for number, rows in self._groups.items() if number in wanted}
        self._groups = kept  # before others are read, so that no more than one window is in memory
        for number in wanted:
            if number not in kept:
                kept[number] = self._read(number)
        return [kept[number] for number in wanted]

    def _read(self, number: int) -> F32:
        """Packed rows of one group, counted over all passes."""
        pieces = []
        for block in self._blocks(number):
            first = int(block) * self._block_rows
            rows = np.array(self._samples.rows[first : first + self._block_rows])
            learned = self._kept_back.learned(np.arange(first, first + len(rows)), rows[:, :3])
            pieces.append(pack(rows[learned], self._samples.info.n_values, self._frame))
        return np.concatenate(pieces)

    def _blocks(self, number: int) -> NDArray[np.int64]:
        """Which blocks are in a group."""
        groups_per_pass = -(-self._n_blocks // self._group_blocks)
        over, within = divmod(number, groups_per_pass)
        order = self._seed.child(f"pass-{over}").numpy().permutation(self._n_blocks)
        return order[within * self._group_blocks : (within + 1) * self._group_blocks]


def _gather(groups: list[F32], ends: NDArray[np.int64], drawn: NDArray[np.int64], picked: F32) -> None:
    """Fills ``picked`` with rows by their numbers in all groups together."""
    slot = np.searchsorted(ends, drawn, side="right")
    within = drawn - (ends - [len(group) for group in groups])[slot]
    for number, group in enumerate(groups):
        mine = slot == number
        picked[mine] = group[within[mine]]
