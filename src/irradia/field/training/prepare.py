"""From a dataset to a source of batches: reading, smoothing, jitter."""

from __future__ import annotations

from collections.abc import Generator
from dataclasses import dataclass

import numpy as np

from irradia.core.errors import InputError
from irradia.core.rng import Seed
from irradia.field.backend import F32
from irradia.field.spec import FieldFrame
from irradia.field.training.batches import BatchSource, MemorySource
from irradia.field.training.events import Remark, Working
from irradia.field.training.jitter import Visibility, jittered_in_space, jittered_on_surfaces
from irradia.field.training.options import DataOptions
from irradia.field.training.rows import HeldOut, Rows, pack
from irradia.field.training.smoothing import smoothed
from irradia.field.training.windows import WindowSource
from irradia.formats.samples import SampleFile

_CHUNK_ROWS = 1 << 18

Preparing = Generator[Working | Remark, None, BatchSource]


@dataclass(frozen=True)
class DataPlan:
    """How a dataset becomes batches.

    Attributes:
        frame: Units of the field.
        kept_back: What training must not see.
        options: What is done to samples.
        batch_size: Of training.
        seed: Of the training.
        visible: Test by rays between points, where there is one.
    """

    frame: FieldFrame
    kept_back: HeldOut
    options: DataOptions
    batch_size: int
    seed: Seed
    visible: Visibility | None = None

    def most_rows(self, n_columns: int) -> int | None:
        """Samples that memory takes where all must be in it; None where any number is read in windows."""
        options = self.options
        if not (options.smooth_k or options.jitter_copies):
            return None
        return options.memory_bytes // (4 * n_columns * (1 + options.jitter_copies))


def prepare(samples: SampleFile, plan: DataPlan) -> Preparing:
    """Makes a source of batches.

    Yields:
        Progress and remarks.

    Returns:
        The source.

    Raises:
        InputError: Samples that don't fit into memory can't be smoothed or jittered, those in space
            can't be jittered without a test by rays, or nothing is left to learn from.
    """
    options = plan.options
    copies = 1 + options.jitter_copies
    if 4 * samples.info.n_columns * len(samples) * copies > options.memory_bytes:
        return (yield from _windows(samples, plan))
    rows = yield from _read(samples, plan.kept_back)
    if not len(rows):
        raise InputError("no sample is left to learn from", where=str(samples.path))
    if options.smooth_k:
        yield from _smooth(rows, samples, options)
    if options.jitter_copies:
        rows = yield from _jitter(rows, samples, plan)
    for first in range(0, len(rows), _CHUNK_ROWS):
        pack(rows[first : first + _CHUNK_ROWS], samples.info.n_values, plan.frame)
    return MemorySource(Rows(rows, samples.info.has_normals))


def _windows(samples: SampleFile, plan: DataPlan) -> Preparing:
    options = plan.options
    if options.smooth_k or options.jitter_copies:
        raise InputError(
            f"smoothing and jitter need all samples in {options.memory_bytes / 2**20:,.0f} MiB of memory",
            where=str(samples.path),
            fix="Give --memory more, or take fewer copies or samples.",
        )
    yield Remark(f"{len(samples):,} samples are more than --memory holds: they are read in shuffled windows.")
    seed = plan.seed.child("windows")
    return WindowSource(samples, plan.frame, plan.kept_back, options.memory_bytes, seed, plan.batch_size)


def _read(samples: SampleFile, kept_back: HeldOut) -> Generator[Working, None, F32]:
    """Rows (n, columns) that training may see, as in the file."""
    n = len(samples)
    rows = np.empty((n, samples.info.n_columns), np.float32)
    filled = 0
    for first in range(0, n, _CHUNK_ROWS):
        yield Working("Read samples", first, n, "rows")
        chunk = samples.rows[first : first + _CHUNK_ROWS]
        chunk = chunk[kept_back.learned(np.arange(first, first + len(chunk)), chunk[:, :3])]
        rows[filled : filled + len(chunk)] = chunk
        filled += len(chunk)
    return rows[:filled]


def _smooth(rows: F32, samples: SampleFile, options: DataOptions) -> Generator[Working, None, None]:
    """Smoothes the values of rows in place."""
    normals = rows[:, 3:6] if samples.info.has_normals else None
    values = rows[:, -1 - samples.info.n_values : -1]
    threshold = options.smooth_normal_threshold
    values[...] = yield from smoothed(rows[:, :3], normals, values, options.smooth_k, threshold)


def _jitter(rows: F32, samples: SampleFile, plan: DataPlan) -> Generator[Working | Remark, None, F32]:
    """Rows with their displaced copies behind them."""
    copies, radius_m, seed = (
        plan.options.jitter_copies,
        plan.options.jitter_radius_m,
        plan.seed.child("jitter"),
    )
    position = rows[:, :3]
    normal = rows[:, 3:6] if samples.info.has_normals else None
    if samples.info.kind == "surface" and normal is not None:
        made = jittered_on_surfaces(position, normal, copies, radius_m, seed, plan.visible)
    elif plan.visible is not None:
        made = jittered_in_space(position, normal, copies, radius_m, seed, plan.visible)
    else:
        raise InputError(
            f"{samples.info.kind} samples don't know where walls are, so copies could end up behind them",
            where="--jitter-copies",
            fix="Name the scene with --jitter-scene, or leave out --jitter-copies.",
        )
    source, place = yield from made
    lost = copies * len(rows) - len(source)
    if lost:
        yield Remark(f"{lost:,} of {copies * len(rows):,} copies found no place on their own side of a wall.")
    copied = rows[source]
    copied[:, :3] = place
    return np.concatenate([rows, copied])
