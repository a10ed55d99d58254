r"""``.samples``: points of a scene and the light there, to train fields from; streams in both directions.

Little-endian::

    0    8 bytes  magic, "\x93SAMPLES"
    8    u32      version, 1
    12   u32      columns C of a row
    16   u64      rows N, or 2⁶⁴ − 1 while the file grows
    24   u32      where rows begin, a multiple of 4096
    28   u32      bytes of JSON
    32   JSON     SampleInfo; then zeros to where rows begin
    …    N × C    f32

A row is one sample (:mod:`irradia.formats.sample_rows`), so that one read fetches a sample drawn at random.

A file grows as ``NAME.part`` and takes its name when it is whole, so that what had the name before stays
until then. :func:`open_samples` reads either: whole rows of a growing file are good as they stand.
"""

from __future__ import annotations

import os
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from irradia.core.errors import InputError
from irradia.formats.sample_header import GROWING, HEADER_BYTES, MAGIC, read_header
from irradia.formats.sample_rows import F32, SampleInfo, check_rows
from irradia.formats.sample_writer import SampleWriter, is_being_written, part_path

if TYPE_CHECKING:
    from irradia.formats.samples_bin import BinOptions

CHECKED_ROWS = 1 << 20  # at a time

__all__ = [
    "SampleFile",
    "SampleInfo",
    "SampleWriter",
    "check_rows",
    "count_samples",
    "is_being_written",
    "open_samples",
    "part_path",
    "validation_path",
]


@dataclass(frozen=True)
class SampleFile:
    """Samples on disk or in memory.

    Attributes:
        path: Whence they come; ``NAME.part`` of a file that grew when it was opened.
        info: What they are.
        rows: (N, n_columns) float32, a memory map where it can be.
        finished: No more rows will come.
    """

    path: Path
    info: SampleInfo
    rows: F32
    finished: bool = True

    def __len__(self) -> int:
        return len(self.rows)

    @property
    def aabb(self) -> F32:
        """(2, 3) minimum and maximum, metres."""
        return np.array(self.info.aabb, np.float32)

    @property
    def positions(self) -> F32:
        """(N, 3) metres."""
        return self.rows[:, :3]

    @property
    def normals(self) -> F32 | None:
        """(N, 3) unit; None of SH."""
        return self.rows[:, 3:6] if self.info.has_normals else None

    @property
    def values(self) -> F32:
        """(N, 3, 12 or 27): E, or coefficients of radiance."""
        return self.rows[:, -1 - self.info.n_values : -1]

    @property
    def variance(self) -> F32:
        """(N,) estimated variance of E, averaged over channels, in its unit squared; 0 unknown."""
        return self.rows[:, -1]

    def grown(self) -> SampleFile:
        """The same file with the rows that have come since; only those are checked.

        Raises:
            InputError: It has gone, or another has taken its place.
        """
        if self.finished:
            return self
        try:
            now = _open(self.path, len(self))
        except FileNotFoundError:  # it has its name by now
            now = _open(self.path.with_suffix(""), len(self))
        if now.info != self.info or len(now) < len(self):
            raise InputError("another dataset has taken the place of this one", where=str(self.path))
        return now


def open_samples(path: Path | str, bin_options: BinOptions | None = None) -> SampleFile:
    """Opens a dataset; where ``path`` isn't there yet but ``path.part`` is, what has been written of it.

    Args:
        path: A ``.samples`` file, or a ``.bin`` of the Unity project.
        bin_options: What a ``.bin`` doesn't say of itself.

    Raises:
        InputError: It isn't there, is damaged, or holds numbers that can't be samples.
    """
    if Path(path).suffix.lower() == ".bin" and not _has_our_magic(Path(path)):
        from irradia.formats.samples_bin import read_samples_bin

        return read_samples_bin(path, bin_options)
    for candidate in (Path(path), part_path(Path(path))):
        if candidate.is_file():
            return _open(candidate)
    raise InputError("there is no such file", where=str(path), fix="Make one with `irradia sample`.")


def count_samples(path: Path | str) -> int:
    """How many rows a finished dataset says that it has, none of which is read.

    0 where there is none of the name, or one that is damaged.
    """
    try:
        with Path(path).open("rb") as stream:
            start = stream.read(HEADER_BYTES)
            if Path(path).suffix.lower() == ".bin" and not start.startswith(MAGIC):
                return int.from_bytes(start[:4], "little")  # the Unity project's begins with it
            n_rows = read_header(start, stream, str(path))[1]
    except (OSError, InputError):
        return 0
    return 0 if n_rows == GROWING else n_rows


def validation_path(path: Path) -> Path:
    """Where the samples lie by which a field trained from ``path`` is judged: NAME.validation.samples."""
    return path.with_name(f"{path.stem}.validation{path.suffix}")


def _has_our_magic(path: Path) -> bool:
    try:
        with path.open("rb") as stream:
            return stream.read(len(MAGIC)) == MAGIC
    except OSError:
        return False


def _open(path: Path, n_checked: int = 0) -> SampleFile:
    """See :func:`open_samples`; the first ``n_checked`` rows have been checked before."""
    with path.open("rb") as stream:
        start = stream.read(HEADER_BYTES)
        info, n_rows, offset = read_header(start, stream, str(path))
        n_bytes = max(os.fstat(stream.fileno()).st_size - offset, 0)
        count = _n_rows(n_rows, n_bytes, info, str(path))
        shape = (count, info.n_columns)
        rows = np.memmap(stream, "<f4", "r", offset, shape) if count else np.zeros(shape, np.float32)
    for first in range(n_checked, count, CHECKED_ROWS):
        check_rows(rows[first : first + CHECKED_ROWS], info, str(path), first)
    return SampleFile(path, info, rows, finished=n_rows != GROWING)


def _n_rows(n_rows: int, n_bytes: int, info: SampleInfo, where: str) -> int:
    """Whole rows in ``n_bytes``, which must be all that the header tells of."""
    row_bytes = 4 * info.n_columns
    if n_rows == GROWING:
        return n_bytes // row_bytes
    if n_bytes != n_rows * row_bytes:
        raise InputError(
            f"expected {n_rows} rows of {row_bytes} bytes, found {n_bytes} bytes",
            where=where,
            fix="The file is damaged; sample it again.",
        )
    if n_rows == 0:
        raise InputError("expected samples, found none", where=where, fix="Sample the scene again.")
    return n_rows
