"""Samples as training wants them: in the field's units, and without those that are kept for validation."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from irradia.core.errors import InputError
from irradia.core.rng import Seed
from irradia.field.backend import F32, Batch
from irradia.field.spec import N_OUTPUTS, FieldFrame, FieldSpec
from irradia.formats.samples import SampleFile

HELD_OUT_SHARE = 0.02  # of the rows, where there are no samples of their own for validation
CELLS_PER_EDGE = 32  # blocks of space, along the longest edge of the box
_MEASURED_BLOCKS, _BLOCK_ROWS = 64, 1 << 14  # a row apart from others costs the disk a page

Keep = Callable[[NDArray[np.int64], F32], NDArray[np.bool_]]


@dataclass(frozen=True)
class Rows:
    """Samples in the field's units, one after another in memory, so that a random row is one fetch.

    Attributes:
        packed: (N, columns) as in the file, but positions in [0, 1]³ and values in units of the frame's
            scale; :func:`pack` makes them so.
        has_normals: Whether there are normals.
    """

    packed: F32
    has_normals: bool

    def __len__(self) -> int:
        return len(self.packed)


class BatchMemory:
    """Memory for one batch at a time.

    A step that asks the system for new pages waits for them longer than for the rows themselves: with
    arrays of their own, batches of 65,536 took 5.7 ms, and take 2 ms like this.

    Args:
        size: Samples of a batch.
        n_columns: Of packed rows.
        has_normals: Whether they have normals.
    """

    def __init__(self, size: int, n_columns: int, *, has_normals: bool) -> None:
        self._n_points = 6 if has_normals else 3
        self.picked = np.empty((size, n_columns), np.float32)  # to be filled by whoever calls split
        self._points = np.empty((self._n_points, size), np.float32)
        self._target = np.empty((size, n_columns - self._n_points - 1), np.float32)

    def take(self, packed: F32, index: NDArray[np.int64]) -> Batch:
        """Packed rows of that index as a batch, which is good until the next one."""
        packed.take(index, axis=0, out=self.picked, mode="clip")  # no index is out of range
        return self.split()

    def split(self) -> Batch:
        """What was picked, as a batch; positions and normals lie coordinate by coordinate in memory."""
        np.copyto(self._points, self.picked[:, : self._n_points].T)
        np.copyto(self._target, self.picked[:, self._n_points : -1])
        normal = self._points[3:].T if self._n_points == 6 else None
        return Batch(self._points[:3].T, normal, self._target)


@dataclass(frozen=True)
class HeldOut:
    """Which rows training never sees: chosen by hashes of their number and place, so by nothing else.

    Attributes:
        rows: Share of rows.
        blocks: Share of the blocks of space.
        aabb: (2, 3) box that the blocks divide.
        key: Of the hashes.
    """

    rows: float
    blocks: float
    aabb: F32
    key: int

    def rows_of(self, number: NDArray[np.int64]) -> NDArray[np.bool_]:
        """Whether each row is one of the single ones that are held out."""
        return _hash(number.astype(np.uint64), self.key) < self.rows

    def in_blocks(self, positions: F32) -> NDArray[np.bool_]:
        """Whether positions (N, 3) in metres lie in a block that is held out."""
        low, high = self.aabb.astype(np.float64)
        edge = max(float(np.max(high - low)), 1e-12) / CELLS_PER_EDGE
        cell = np.clip((positions - low) / edge, 0, CELLS_PER_EDGE - 1).astype(np.uint64)
        number = (cell[:, 0] * CELLS_PER_EDGE + cell[:, 1]) * CELLS_PER_EDGE + cell[:, 2]
        return _hash(number, self.key + 1) < self.blocks

    def learned(self, number: NDArray[np.int64], positions: F32) -> NDArray[np.bool_]:
        """Whether training sees each row, of a number in its file and a position in metres."""
        kept = np.ones(len(number), bool)
        if self.rows > 0.0:
            kept &= ~self.rows_of(number)
        if self.blocks > 0.0:
            kept &= ~self.in_blocks(positions)
        return kept


def held_out(samples: SampleFile, seed: Seed, *, rows: bool, blocks: float) -> HeldOut:
    """What to keep from training.

    Args:
        samples: To train from.
        seed: Of the training.
        rows: Hold out single rows, for want of samples made for validation.
        blocks: Share of blocks of space.
    """
    share = HELD_OUT_SHARE if rows else 0.0
    return HeldOut(share, blocks, samples.aabb, seed.child("held-out").uint32())


def check_fit(samples: SampleFile, spec: FieldSpec) -> None:
    """Refuses samples that the field can't learn from.

    Raises:
        InputError: E for SH coefficients, or of another order.
    """
    if samples.info.n_values != N_OUTPUTS[spec.mode]:
        held = f"{samples.info.kind} samples of {samples.info.n_values} values"
        raise InputError(
            f"expected samples of {spec.n_outputs} values for mode {spec.mode}, found {held}",
            where=str(samples.path),
        )


def frame_of(samples: SampleFile) -> FieldFrame:
    """The file's box, and as scale the power of two nearest to the mean magnitude of its values.

    Losses add ε = 0.01 to squares in these units, so what is darker than a tenth of the mean counts
    absolutely, as in relMSE. Maps take their 99.9th percentile instead; near lamps that is 20 to 40 means,
    and then all but the brightest counts absolutely: tried on Cornell and the atrium (hash 8 × 2^14, 600
    steps of 32,768), display values were 1.6 and 0.3 dB worse and relMSE 1.8 and 1.3 times as large.

    Raises:
        InputError: A value isn't finite.
    """
    values = np.abs(samples.values[_blocks(len(samples))])
    if not np.isfinite(values).all():
        raise InputError("expected finite values, found NaN or infinity", where=str(samples.path))
    mean = float(values.mean(dtype=np.float64))
    return FieldFrame(
        samples.aabb, 2.0 ** round(math.log2(mean)) if mean > 0.0 else 1.0, samples.info.quantity
    )


def pack(rows: F32, n_values: int, frame: FieldFrame) -> F32:
    """Brings rows (n, columns) to the field's units, in place; see :class:`Rows`. Returns them."""
    rows[:, :3] = frame.to_unit(rows[:, :3])
    rows[:, -1 - n_values : -1] *= np.float32(1.0 / frame.scale)
    return rows


def spread(n: int, at_most: int) -> NDArray[np.int64]:
    """Numbers of rows, at most so many, evenly spread over n."""
    if n <= at_most:
        return np.arange(n)
    return np.arange(at_most) * n // at_most


def _blocks(n: int) -> NDArray[np.int64]:
    """Numbers of rows in blocks spread evenly over n; all of few."""
    if n <= _MEASURED_BLOCKS * _BLOCK_ROWS:
        return np.arange(n)
    first = spread(n - _BLOCK_ROWS, _MEASURED_BLOCKS)
    return (first[:, None] + np.arange(_BLOCK_ROWS)).ravel()


def _hash(number: NDArray[np.uint64], key: int) -> NDArray[np.float64]:
    """Numbers in [0, 1): splitmix64's finaliser (Steele, Lea and Flood 2014) on number and key."""
    z = number + np.uint64((key * 0x9E3779B97F4A7C15 + 0x9E3779B97F4A7C15) & 0xFFFFFFFFFFFFFFFF)
    z = (z ^ (z >> np.uint64(30))) * np.uint64(0xBF58476D1CE4E5B9)
    z = (z ^ (z >> np.uint64(27))) * np.uint64(0x94D049BB133111EB)
    return ((z ^ (z >> np.uint64(31))) >> np.uint64(11)).astype(np.float64) * 2.0**-53
