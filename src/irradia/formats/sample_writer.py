"""Writes ``.samples`` files piece by piece; :mod:`irradia.formats.samples` says how they grow."""

from __future__ import annotations

import math
import os
import struct
import time
from pathlib import Path
from typing import IO

import numpy as np

from irradia.core.errors import InputError
from irradia.core.files import write_atomic
from irradia.core.lock import FileLock, acquire_lock, lock_holder
from irradia.formats.sample_header import COUNT_AT, GROWING, encode_header
from irradia.formats.sample_rows import F32, SampleInfo, check_rows

_PROBES_TAKE_S = (0.01, 0.03, 0.1, 0.3)


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

    def close(self, path: Path | None = None) -> None:
        """Ends the file: notes the number of rows and gives it its name, or another.

        Doing so twice is harmless.
        """
        if self._stream is None:
            return
        self._stream.seek(COUNT_AT)
        self._stream.write(struct.pack("<Q", self.n_rows))
        self._release()
        _rename(self._part, path or self.path)

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


def part_path(path: Path) -> Path:
    """Where a file grows before it has its name."""
    return path.with_name(path.name + ".part")


def is_being_written(path: Path | str) -> bool:
    """Whether a process writes the file now; False says that an unfinished file won't grow any more."""
    lock = acquire_lock(_lock_path(Path(path))) if _lock_path(Path(path)).exists() else None
    if lock is not None:
        lock.release()
        return False
    return _lock_path(Path(path)).exists()


def _lock_path(path: Path) -> Path:
    return path.with_name(f".{path.name}.lock")


def _lock(path: Path) -> FileLock:
    """The writer's lock. Readers that ask whether there is a writer hold it too, for no longer than that."""
    for patience in (*_PROBES_TAKE_S, math.inf):
        lock = acquire_lock(_lock_path(path))
        if lock is not None:
            return lock
        if patience < math.inf:
            time.sleep(patience)
    holder = lock_holder(_lock_path(path)) or "another process"
    raise InputError(f"it is being written by {holder}", where=str(path), fix="Wait, or choose another.")


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
