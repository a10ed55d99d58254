"""Which samples a training is judged by."""

from __future__ import annotations

from collections.abc import Generator

import numpy as np
from numpy.typing import NDArray

from irradia.core.errors import InputError
from irradia.field.spec import FieldFrame
from irradia.field.training.events import Judges, Remark, Working
from irradia.field.training.figures import judge
from irradia.field.training.rows import HELD_OUT_SHARE, HeldOut
from irradia.formats.sample_origin import check_same_light
from irradia.formats.samples import SampleFile

_CHUNK_ROWS = 1 << 20


def find_judges(
    samples: SampleFile, validation: SampleFile | None, kept_back: HeldOut, frame: FieldFrame
) -> Generator[Working | Remark, None, Judges]:
    """Reads the samples to judge by.

    Args:
        samples: That are trained on.
        validation: Made for validation; None takes rows that are held out.
        kept_back: Which those are.
        frame: Of the field.

    Yields:
        Progress and remarks.

    Raises:
        InputError: The validation samples hold other things, or there are too few samples.
    """
    single, in_blocks = yield from _held_out_rows(samples, kept_back)
    blocks = judge(samples, in_blocks, frame) if len(in_blocks) else None
    if validation is not None:
        _check_alike(samples, validation)
        return Judges(judge(validation, np.arange(len(validation)), frame), blocks)
    if not len(single):
        raise InputError(
            f"{len(samples)} samples are too few to hold some out",
            where=str(samples.path),
            fix="Give --validation.",
        )
    yield Remark(
        f"No samples for validation: {HELD_OUT_SHARE:.0%} of the rows are held out. "
        "They are as noisy as the rest; irradia sample makes better ones."
    )
    return Judges(judge(samples, single, frame), blocks)


def _held_out_rows(
    samples: SampleFile, kept_back: HeldOut
) -> Generator[Working, None, tuple[NDArray[np.int64], NDArray[np.int64]]]:
    """Numbers of the single rows, and of those in blocks."""
    single, in_blocks = [np.zeros(0, np.int64)], [np.zeros(0, np.int64)]
    if kept_back.rows or kept_back.blocks:
        for first in range(0, len(samples), _CHUNK_ROWS):
            yield Working("Hold samples out", first, len(samples), "rows")
            number = np.arange(first, min(first + _CHUNK_ROWS, len(samples)))
            in_block = np.zeros(len(number), bool)
            if kept_back.blocks:
                in_block = kept_back.in_blocks(samples.positions[first : first + len(number)])
            in_blocks.append(number[in_block])
            single.append(number[kept_back.rows_of(number) & ~in_block])
    return np.concatenate(single), np.concatenate(in_blocks)


def _check_alike(samples: SampleFile, validation: SampleFile) -> None:
    here, there = samples.info, validation.info
    for name in ("n_coefficients", "quantity", "has_normals"):
        if getattr(here, name) != getattr(there, name):
            raise InputError(
                f"expected validation samples of {name} {getattr(here, name)}, as of those to train from, "
                f"found {getattr(there, name)}",
                where=str(validation.path),
            )
    check_same_light(here, there, str(validation.path))
