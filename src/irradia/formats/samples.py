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

import json
import math
import os
import struct
import time
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import IO, TYPE_CHECKING

import numpy as np

from irradia.core.errors import InputError
from irradia.core.files import write_atomic
from irradia.core.lock import FileLock, acquire_lock, lock_holder
from irradia.formats.sample_rows import F32, SampleInfo, check_rows

if TYPE_CHECKING:
    from irradia.formats.samples_bin import BinOptions

VERSION = 1
MAGIC = b"\x93SAMPLES"
BLOCK_BYTES = 4096
MAX_INFO_BYTES = 1 << 24
GROWING = (1 << 64) - 1
CHECKED_ROWS = 1 << 20  # at a time

__all__ = [
    "SampleFile",
    "SampleInfo",
    "SampleWriter",
    "check_rows",
    "is_being_written",
    "open_samples",
    "part_path",
    "validation_path",
]

_HEADER = struct.Struct("<8sIIQII")
_COUNT_AT = 16


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
        """(N,) estimated variance of the value's mean over channels, in its unit squared; 0 unknown."""
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


class SampleWriter:
    """Writes a ``.samples`` file piece by piece; use as a context, or call :meth:`close`.

    Leaving the context by an error keeps ``NAME.part``, which stays readable.

    Args:
        path: The file; ``NAME.part`` beside it grows.
        info: What its rows are.

    Raises:
        InputError: Another process writes the same file.
    """

    def __init__(self, path: Path | str, info: SampleInfo) -> None:
        self.path = Path(path)
        self.info = info
        self.n_rows = 0
        self._part = part_path(self.path)
        self.path.parent.mkdir(parents=True, exist_ok=True)
        self._lock = _lock(self.path)
        with write_atomic(self._part) as stream:  # whole before a reader can see it
            stream.write(encode_header(info, GROWING))
        self._stream: IO[bytes] | None = self._part.open("r+b")
        self._stream.seek(0, os.SEEK_END)

    def append(self, rows: F32) -> None:
        """Adds rows (n, n_columns); readers see them when this returns.

        Raises:
            InputError: They are of another shape, or hold numbers that can't be samples.
        """
        if self._stream is None:
            raise InputError("the file is closed", where=str(self.path))
        if rows.ndim != 2 or rows.shape[1] != self.info.n_columns:
            found = " × ".join(map(str, rows.shape))
            raise InputError(f"expected rows of {self.info.n_columns}, found {found}", where=str(self.path))
        stored = np.ascontiguousarray(rows, "<f4")
        check_rows(stored, self.info, str(self.path), first=self.n_rows)
        self._stream.write(stored.data)
        self._stream.flush()
        self.n_rows += len(stored)

    def close(self) -> None:
        """Ends the file: notes the number of rows and gives it its name. Doing so twice is harmless."""
        if self._stream is None:
            return
        self._stream.seek(_COUNT_AT)
        self._stream.write(struct.pack("<Q", self.n_rows))
        self._release()
        _rename(self._part, self.path)

    def abandon(self) -> None:
        """Stops without ending the file: ``NAME.part`` stays, and readers know it for unfinished."""
        if self._stream is not None:
            self._release()

    def __enter__(self) -> SampleWriter:
        return self

    def __exit__(self, kind: object, *_: object) -> None:
        if kind is None:
            self.close()
        else:
            self.abandon()

    def _release(self) -> None:
        if self._stream is not None:
            self._stream.close()
        self._stream = None
        if self._lock is not None:
            self._lock.release()


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


def part_path(path: Path) -> Path:
    """Where a file grows before it has its name."""
    return path.with_name(path.name + ".part")


def validation_path(path: Path) -> Path:
    """Where the samples lie by which a field trained from ``path`` is judged: NAME.validation.samples."""
    return path.with_name(f"{path.stem}.validation{path.suffix}")


def is_being_written(path: Path | str) -> bool:
    """Whether a process writes the file now; False says that an unfinished file won't grow any more."""
    lock = acquire_lock(_lock_path(Path(path))) if _lock_path(Path(path)).exists() else None
    if lock is not None:
        lock.release()
        return False
    return _lock_path(Path(path)).exists()


def encode_header(info: SampleInfo, n_rows: int) -> bytes:
    """Everything before the rows."""
    text = json.dumps(asdict(info), sort_keys=True, allow_nan=False).encode()
    offset = -(-(_HEADER.size + len(text)) // BLOCK_BYTES) * BLOCK_BYTES
    start = _HEADER.pack(MAGIC, VERSION, info.n_columns, n_rows, offset, len(text))
    return (start + text).ljust(offset, b"\0")


def _has_our_magic(path: Path) -> bool:
    try:
        with path.open("rb") as stream:
            return stream.read(len(MAGIC)) == MAGIC
    except OSError:
        return False


def _open(path: Path, n_checked: int = 0) -> SampleFile:
    """See :func:`open_samples`; the first ``n_checked`` rows have been checked before."""
    with path.open("rb") as stream:
        start = stream.read(_HEADER.size)
        info, n_rows, offset = _read_header(start, stream, str(path))
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


def _read_header(start: bytes, stream: IO[bytes], where: str) -> tuple[SampleInfo, int, int]:
    """Info, number of rows, and where rows begin."""
    if len(start) < _HEADER.size or not start.startswith(MAGIC):
        raise InputError(
            f"expected a dataset, found {_looks_like(start)}",
            where=where,
            fix="Make one with `irradia sample`, or give a .bin of positions and light.",
        )
    _, version, n_columns, n_rows, offset, n_text = _HEADER.unpack(start)
    if version != VERSION:
        raise InputError(f"expected version {VERSION}, found {version}", where=where)
    text = stream.read(min(n_text, MAX_INFO_BYTES))
    header_fits = offset % BLOCK_BYTES == 0 and _HEADER.size + n_text <= offset
    if not header_fits or len(text) != n_text or n_text > MAX_INFO_BYTES:
        raise InputError(f"its header is damaged: {n_text} bytes of JSON before {offset}", where=where)
    info = _info(text, where)
    if n_columns != info.n_columns:
        raise InputError(f"expected {info.n_columns} columns, found {n_columns}", where=where)
    return info, n_rows, offset


def _looks_like(start: bytes) -> str:
    if not start:
        return "an empty file"
    printable = sum(32 <= byte < 127 or byte in b"\t\r\n" for byte in start)
    return "text" if printable == len(start) else f"bytes that begin {start[:8].hex(' ')}"


def _info(text: bytes, where: str) -> SampleInfo:
    try:
        values = json.loads(text)
        low, high = values.pop("aabb")
        return SampleInfo(aabb=(tuple(low), tuple(high)), **values)
    except (ValueError, TypeError, KeyError, AttributeError, RecursionError) as error:
        raise InputError(f"its header is damaged: {error}", where=where) from error
    except InputError as error:
        raise InputError(error.message, where=where) from error


def _lock_path(path: Path) -> Path:
    return path.with_name(f".{path.name}.lock")


def _lock(path: Path) -> FileLock:
    lock = acquire_lock(_lock_path(path))
    if lock is None:
        holder = lock_holder(_lock_path(path)) or "another process"
        raise InputError(f"it is being written by {holder}", where=str(path), fix="Wait, or choose another.")
    return lock


def _rename(part: Path, path: Path) -> None:
    """Gives a file its name; Windows refuses while a reader has it open, so that is tried for a while."""
    for patience in (0.1, 0.3, 1.0, 3.0, math.inf):
        try:
            part.replace(path)
        except PermissionError:
            if patience == math.inf:
                raise
            time.sleep(patience)
        else:
            return
