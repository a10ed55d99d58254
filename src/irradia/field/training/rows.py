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
_MEASURED_ROWS = 1 << 20
_TOP_PERCENTILE = 99.9

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

    def batch(self, index: NDArray[np.int64]) -> Batch:
        """The rows of that index, each array contiguous."""
        return split(self.packed.take(index, axis=0), self.has_normals)


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
    """The file's box, and a power of two near the 99.9th percentile of its values' magnitude.

    Raises:
        InputError: A value isn't finite.
    """
    values = np.abs(samples.values[spread(len(samples), _MEASURED_ROWS)])
    if not np.isfinite(values).all():
        raise InputError("expected finite values, found NaN or infinity", where=str(samples.path))
    top = float(np.percentile(values, _TOP_PERCENTILE))
    scale = 2.0 ** round(math.log2(top)) if top > 0.0 else 1.0
    return FieldFrame(samples.aabb, scale, samples.info.quantity)


def pack(rows: F32, n_values: int, frame: FieldFrame) -> F32:
    """Brings rows (n, columns) to the field's units, in place; see :class:`Rows`. Returns them."""
    rows[:, :3] = frame.to_unit(rows[:, :3])
    rows[:, -1 - n_values : -1] *= np.float32(1.0 / frame.scale)
    return rows


def split(packed: F32, has_normals: bool) -> Batch:
    """Packed rows as a batch."""
    first = 6 if has_normals else 3
    normal = np.ascontiguousarray(packed[:, 3:6]) if has_normals else None
    return Batch(np.ascontiguousarray(packed[:, :3]), normal, np.ascontiguousarray(packed[:, first:-1]))


def spread(n: int, at_most: int) -> NDArray[np.int64]:
    """Numbers of rows, at most so many, evenly spread over n."""
    if n <= at_most:
        return np.arange(n)
    return np.arange(at_most) * n // at_most


def _hash(number: NDArray[np.uint64], key: int) -> NDArray[np.float64]:
    """Numbers in [0, 1): splitmix64's finaliser (Steele, Lea and Flood 2014) on number and key."""
    z = number + np.uint64((key * 0x9E3779B97F4A7C15 + 0x9E3779B97F4A7C15) & 0xFFFFFFFFFFFFFFFF)
    z = (z ^ (z >> np.uint64(30))) * np.uint64(0xBF58476D1CE4E5B9)
    z = (z ^ (z >> np.uint64(27))) * np.uint64(0x94D049BB133111EB)
    return ((z ^ (z >> np.uint64(31))) >> np.uint64(11)).astype(np.float64) * 2.0**-53
