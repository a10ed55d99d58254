"""A folder of results that appears whole or not at all, and that one process at a time writes to.

While it works, a process keeps everything in a hidden folder inside the target, so that the last step
renames within one file system even where the target is a mount of its own:

    .irradia-staging/lock         held by the process; the system releases it when that dies
    .irradia-staging/files/       results on their way
    .irradia-staging/ready.json   there from when they are complete until all stand in their place

Who finds the folder without its lock held finishes or clears away what a killed process left.
"""

from __future__ import annotations

import json
import shutil
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

from irradia.core.errors import InputError
from irradia.core.files import disk_problem, write_text_atomic
from irradia.core.lock import FileLock, acquire_lock, lock_holder

STAGING = ".irradia-staging"
_LOCK, _FILES, _READY = "lock", "files", "ready.json"


@contextmanager
def staged_folder(target: Path, stale: Sequence[str] = ()) -> Iterator[Path]:
    """Gives a temporary folder whose files move to ``target`` if the block ends without an error.

    Other files in ``target`` stay, but those that match a pattern of ``stale`` and were not made
    again are removed: results of an earlier run must not stand beside those of this one. After an
    error nothing is left behind, not even folders that were made for it; if a process is killed,
    the next one clears up after it.

    Raises:
        InputError: If ``target`` can't be a folder that we may write to, if another process is
            writing to it, or if its disk is full.
    """
    made = _make_folders(target)
    try:
        with _only_one_at_a_time(target) as staging:
            _deliver(staging, target)  # what was ready when its process was killed
            files = staging / _FILES
            shutil.rmtree(files, ignore_errors=True)
            files.mkdir()
            yield files
            _declare_ready(staging, target, stale)
            _deliver(staging, target)
    except OSError as error:
        _remove_empty(made)
        problem = disk_problem(error, target)
        if problem is None:
            raise
        raise problem from error
    except BaseException:
        _remove_empty(made)
        raise


def _make_folders(target: Path) -> list[Path]:
    """Makes the folder and those above it; returns those that are new, the innermost first."""
    if target.exists() and not target.is_dir():
        raise InputError("expected a folder, found a file", where=str(target), fix="Choose another -o.")
    whole = target.absolute()
    missing = [folder for folder in (whole, *whole.parents) if not folder.exists()]
    try:
        whole.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise _not_ours("can't make this folder", target, error) from error
    return missing


@contextmanager
def _only_one_at_a_time(target: Path) -> Iterator[Path]:
    """The staging folder, locked; afterwards it is gone, unless it holds undelivered results."""
    staging = target / STAGING
    lock = _lock(target, staging)
    try:
        yield staging
    finally:
        if not (staging / _READY).exists():
            shutil.rmtree(staging / _FILES, ignore_errors=True)
        lock.release()
        _remove_empty([staging])


def _lock(target: Path, staging: Path) -> FileLock:
    while True:
        try:
            staging.mkdir(exist_ok=True)
            lock = acquire_lock(staging / _LOCK)
        except FileNotFoundError:  # its last user took it away between our two steps
            continue
        except OSError as error:
            raise disk_problem(error, target) or _not_ours("can't write here", target, error) from error
        if lock is not None:
            return lock
        holder = lock_holder(staging / _LOCK)
        raise InputError(
            f"another bake is writing to this folder{f' ({holder})' if holder else ''}",
            where=str(target),
            fix="Wait until it is done, or choose another -o.",
        )


def _declare_ready(staging: Path, target: Path, stale: Sequence[str]) -> None:
    made = {path.name for path in (staging / _FILES).iterdir()}
    matching = {path.name for pattern in stale for path in target.glob(pattern)}
    write_text_atomic(staging / _READY, json.dumps({"obsolete": sorted(matching - made)}))


def _deliver(staging: Path, target: Path) -> None:
    """Moves complete results to their place; goes on where a killed process stopped."""
    ready = staging / _READY
    if not ready.exists():
        return
    for path in sorted((staging / _FILES).iterdir()):
        path.replace(target / path.name)
    for name in json.loads(ready.read_text(encoding="utf-8"))["obsolete"]:
        (target / name).unlink(missing_ok=True)
    ready.unlink()


def _not_ours(message: str, target: Path, error: OSError) -> InputError:
    return InputError(f"{message}: {error.strerror}", where=str(target), fix="Choose another -o.")


def _remove_empty(folders: Sequence[Path]) -> None:
    for folder in folders:
        if folder.is_dir() and not any(folder.iterdir()):
            folder.rmdir()
