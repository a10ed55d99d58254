"""Locks between processes that the operating system releases with their holder.

A killed process leaves the file but not the lock, so nothing has to guess whether a holder still
lives. Where the file system knows no locks (some network mounts) everyone gets one.
"""

from __future__ import annotations

import errno
import os
import platform
import sys
from dataclasses import dataclass
from datetime import datetime
from pathlib import Path

_NO_LOCKS_HERE = frozenset({errno.ENOLCK, errno.ENOSYS, errno.EOPNOTSUPP, errno.EINVAL})
_LOCKED_BYTE = 1 << 20  # far beyond the text: Windows keeps others from reading what is locked


@dataclass(frozen=True)
class FileLock:
    """A lock that this process holds.

    Attributes:
        path: Its file, which says who holds it.
    """

    path: Path
    _descriptor: int

    def release(self) -> None:
        """Gives the lock back and takes its file away."""
        if sys.platform == "win32":  # where open files can't be removed; others keep theirs open
            os.close(self._descriptor)
            _remove(self.path)
        else:  # while it is held, so that nobody can lock a file that is about to go
            _remove(self.path)
            os.close(self._descriptor)


def acquire_lock(path: Path) -> FileLock | None:
    """Locks a file, which is made where it is missing, or gives None if another holds it.

    Raises:
        OSError: The file can't be made.
    """
    while True:
        descriptor = os.open(path, os.O_RDWR | os.O_CREAT, 0o644)
        if not _try_lock(descriptor):
            os.close(descriptor)
            return None
        if _is_still(path, descriptor):
            os.truncate(descriptor, 0)
            os.write(descriptor, _who_am_i().encode())
            return FileLock(path, descriptor)
        os.close(descriptor)  # its last holder removed it between our two steps


def lock_holder(path: Path) -> str:
    """Who holds a lock, in words; empty where the file doesn't tell."""
    try:
        return path.read_text(encoding="utf-8", errors="replace").strip()
    except OSError:
        return ""


def _try_lock(descriptor: int) -> bool:
    try:
        if sys.platform == "win32":
            import msvcrt

            os.lseek(descriptor, _LOCKED_BYTE, os.SEEK_SET)
            msvcrt.locking(descriptor, msvcrt.LK_NBLCK, 1)
            os.lseek(descriptor, 0, os.SEEK_SET)
        else:
            import fcntl

            fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError as error:
        return error.errno in _NO_LOCKS_HERE
    return True


def _is_still(path: Path, descriptor: int) -> bool:
    """Whether the open file is the one that has the name."""
    try:
        return os.path.samestat(os.fstat(descriptor), path.stat())
    except FileNotFoundError:
        return False


def _who_am_i() -> str:
    now = datetime.now().astimezone().isoformat(sep=" ", timespec="seconds")
    return f"process {os.getpid()} on {platform.node() or 'this machine'} since {now}\n"


def _remove(path: Path) -> None:
    try:
        path.unlink(missing_ok=True)
    except PermissionError:  # Windows: another process is just asking for it
        return
