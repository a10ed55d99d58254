"""A folder of results that appears whole or not at all."""

from __future__ import annotations

import shutil
import tempfile
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

from irradia.core.errors import InputError


@contextmanager
def staged_folder(target: Path, stale: Sequence[str] = ()) -> Iterator[Path]:
    """Gives a temporary folder whose files move to ``target`` if the block ends without an error.

    Other files in ``target`` stay, but those that match a pattern of ``stale`` and were not made
    again are removed: results of an earlier run must not stand beside those of this one. After an
    error nothing is left behind, not even folders above ``target`` that were made for it.

    Raises:
        InputError: If ``target`` can't be a folder that we may write to.
    """
    made = _make_parents(target)
    try:
        work = Path(tempfile.mkdtemp(prefix=f".{target.name}.", dir=target.parent))
        try:
            yield work
            _deliver(work, target, stale)
        finally:
            shutil.rmtree(work, ignore_errors=True)
    except BaseException:
        for folder in made:
            _remove_if_empty(folder)
        raise


def _make_parents(target: Path) -> list[Path]:
    """Makes the folders above ``target``; returns those that are new, the innermost first."""
    if target.exists() and not target.is_dir():
        raise InputError("expected a folder, found a file", where=str(target), fix="Choose another -o.")
    missing = [folder for folder in target.absolute().parents if not folder.exists()]
    try:
        target.absolute().parent.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InputError(f"can't make this folder: {error.strerror}", where=str(target)) from error
    return missing


def _deliver(work: Path, target: Path, stale: Sequence[str]) -> None:
    target.mkdir(exist_ok=True)
    made = sorted(path.name for path in work.iterdir())
    for name in made:
        (work / name).replace(target / name)
    for pattern in stale:
        for path in target.glob(pattern):
            if path.name not in made:
                path.unlink()


def _remove_if_empty(folder: Path) -> None:
    if folder.is_dir() and not any(folder.iterdir()):
        folder.rmdir()
