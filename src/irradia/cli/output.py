"""What a command says: text or one JSON object on stdout, progress on stderr."""

from __future__ import annotations

import json
import os
import sys
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, redirect_stdout
from typing import IO, Any

import click

INTERRUPTED = 130  # what shells report for a program ended by Ctrl-C

_reserved: list[IO[bytes]] = []


@contextmanager
def reserve_stdout() -> Iterator[None]:
    """Keeps stdout for :func:`write_json`: until the block ends, what others print goes to stderr.

    The file descriptor is moved as well as ``sys.stdout``, since C++ libraries print past the latter.
    """
    sys.stdout.flush()
    with os.fdopen(os.dup(1), "wb", buffering=0) as kept, redirect_stdout(sys.stderr):
        os.dup2(2, 1)
        _reserved.append(kept)
        try:
            yield
        finally:
            _reserved.pop()
            os.dup2(kept.fileno(), 1)


def write_json(value: Mapping[str, Any]) -> None:
    """Writes the command's one JSON object. NaN and infinity, which JSON lacks, become null."""
    text = json.dumps(_finite(value), indent=2, allow_nan=False, default=_plain) + "\n"
    if _reserved:
        rest = memoryview(text.encode("utf-8"))
        while rest:
            rest = rest[_reserved[-1].write(rest) :]
    else:
        click.echo(text, nl=False)


def finish(as_json: bool, result: Mapping[str, Any], text: str, code: int = 0) -> int:
    """Ends a command: the result as JSON, or the text for people; returns the exit code.

    Every command's JSON says alike how it ended: ``ok`` where it exits with 0, and ``interrupted`` where
    Ctrl-C has ended it early. What an interrupted run tells of its results is good as far as it goes.
    """
    if as_json:
        write_json({**result, **outcome(code)})
    else:
        click.echo(text)
    return code


def outcome(code: int) -> dict[str, bool]:
    """What an exit code says, as it stands in every command's JSON."""
    return {"ok": code == 0, "interrupted": code == INTERRUPTED}


def code_of(complete: bool) -> int:
    """The exit code of a run that came to its end, or that Ctrl-C ended with usable results."""
    return 0 if complete else INTERRUPTED


def _finite(value: Any) -> Any:
    if isinstance(value, float):
        return value if value == value and abs(value) != float("inf") else None
    if isinstance(value, Mapping):
        return {str(k): _finite(v) for k, v in value.items()}
    if isinstance(value, (list, tuple)):
        return [_finite(v) for v in value]
    return value


def _plain(value: Any) -> Any:
    """NumPy scalars and arrays, paths."""
    if hasattr(value, "tolist"):
        return _finite(value.tolist())
    if isinstance(value, os.PathLike):
        return os.fspath(value)
    raise TypeError(f"{type(value).__name__} has no JSON form")
