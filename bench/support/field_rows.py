"""Rows of a long benchmark, each on disk as soon as it is known."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

Row = dict[str, Any]


class Rows:
    """A file of JSON lines; a row is known by its scene and name.

    Args:
        path: The file; need not exist.
    """

    def __init__(self, path: Path) -> None:
        self._path = path

    def all(self) -> list[Row]:
        """Every row; of several with the same scene and name the last."""
        if not self._path.exists():
            return []
        found = {}
        for line in self._path.read_text(encoding="utf-8").splitlines():
            row = json.loads(line)
            found[row["scene"], row["name"]] = row
        return list(found.values())

    def has(self, scene: str, name: str, settings: Row) -> bool:
        """Whether it was measured under the same settings."""
        wanted = (scene, name, settings)
        return any((row["scene"], row["name"], row["settings"]) == wanted for row in self.all())

    def add(self, row: Row) -> None:
        """Appends one."""
        self._path.parent.mkdir(parents=True, exist_ok=True)
        with self._path.open("a", encoding="utf-8") as stream:
            stream.write(json.dumps(row) + "\n")
