"""Steps of a long benchmark, each on disk as soon as it is done, so that it can be stopped and taken up."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from irradia.core import write_text_atomic

BENCH = Path(__file__).resolve().parents[1]
_SOURCES = ("core", "scene", "transport", "bake", "metrics")  # packages that a bake's light and time hang on

Arrays = dict[str, np.ndarray]


class Kept:
    """A folder of finished steps under ``out/bench``, which git ignores.

    What was measured under other settings or by other code is not found, but done again.

    Args:
        name: The benchmark.
        settings: All that its steps hang on, fit for JSON.
        root: Where the folder is made.
    """

    def __init__(
        self, name: str, settings: dict[str, Any], root: Path = BENCH.parent / "out" / "bench"
    ) -> None:
        told = json.dumps({"settings": settings, "code": _code()}, sort_keys=True, default=str)
        self.folder = root / f"{name}-{hashlib.sha256(told.encode()).hexdigest()[:12]}"
        self.folder.mkdir(parents=True, exist_ok=True)

    def value(self, step: str, measure: Callable[[], Any]) -> Any:
        """What a step gave, if it was done before; else it is done. Fit for JSON."""
        path = self.folder / f"{_file_name(step)}.json"
        if not path.exists():
            write_text_atomic(path, json.dumps(measure()))
        return json.loads(path.read_text(encoding="utf-8"))

    def arrays(self, step: str, measure: Callable[[], Arrays]) -> Arrays:
        """The same for arrays by name."""
        path = self.folder / f"{_file_name(step)}.npz"
        if not path.exists():
            unfinished = path.with_suffix(".unfinished.npz")
            np.savez(unfinished, **measure())  # type: ignore[arg-type]
            unfinished.replace(path)
        with np.load(path) as file:
            return dict(file)


def _file_name(step: str) -> str:
    return "".join(c if c.isalnum() else "-" for c in step)


def _code() -> str:
    """Of the source files that matter."""
    digest = hashlib.sha256()
    source = BENCH.parent / "src" / "irradia"
    for package in _SOURCES:
        for path in sorted((source / package).rglob("*.py")):
            digest.update(path.relative_to(source).as_posix().encode() + b"\0" + path.read_bytes())
    return digest.hexdigest()
