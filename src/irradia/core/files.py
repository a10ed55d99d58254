"""Files that are either whole or absent: written under a temporary name, then renamed."""

from __future__ import annotations

import errno
import os
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import IO

from irradia.core.errors import InputError

_DISK_PROBLEMS = {
    errno.ENOSPC: "the disk is full",
    errno.EDQUOT: "the disk quota is used up",
    errno.EFBIG: "the file is larger than the system allows",
    errno.EROFS: "the disk can only be read",
    errno.EIO: "the disk reports an error",
}
_PLACE_PROBLEMS = {
    errno.EACCES: "it may not be read or written",
    errno.EPERM: "it may not be read or written",
    errno.ENOTDIR: "a file stands where a folder is needed",
    errno.EEXIST: "a file stands where a folder is needed",
    errno.EISDIR: "a folder stands where a file is needed",
}


@contextmanager
def write_atomic(path: Path | str) -> Iterator[IO[bytes]]:
    """Opens a binary file that takes the name ``path`` only if the block ends without an error.

    Raises:
        OSError: It can't be written; the error names ``path``.
    """
    target = Path(path)
    temporary = None
    try:
        target.parent.mkdir(parents=True, exist_ok=True)
        handle, temporary = tempfile.mkstemp(prefix=f".{target.name}.", dir=target.parent)
        with os.fdopen(handle, "wb") as stream:
            yield stream
        Path(temporary).chmod(0o644)
        Path(temporary).replace(target)
    except BaseException as error:
        if temporary is not None:
            Path(temporary).unlink(missing_ok=True)
        if isinstance(error, OSError) and error.filename is None:
            error.filename = str(target)
        raise


def write_text_atomic(path: Path | str, text: str) -> None:
    """Writes UTF-8 text; see :func:`write_atomic`."""
    with write_atomic(path) as stream:
        stream.write(text.encode("utf-8"))


def disk_problem(error: OSError, where: Path | str | None = None) -> InputError | None:
    """What to tell the user of a disk that takes no more, or None if the error is of another kind.

    Args:
        error: From writing.
        where: The place to name; by default the error's own file.
    """
    reason = _DISK_PROBLEMS.get(error.errno or 0)
    if reason is None:
        return None
    return InputError(
        f"{reason}: nothing was written, and what was there is as it was",
        where=str(where or error.filename or "") or None,
        fix="Make room there, or choose another place with -o.",
    )


def place_problem(error: OSError) -> InputError | None:
    """What to tell the user of a name that can't be used, or None if the error is of another kind."""
    reason = _PLACE_PROBLEMS.get(error.errno or 0)
    if reason is None or not error.filename:
        return None
    return InputError(reason, where=str(error.filename), fix="Choose another name or place.")
