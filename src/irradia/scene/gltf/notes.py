"""What the user should know about an import that went well."""

from __future__ import annotations


class ImportNotes:
    """Collects remarks, those that repeat as one line with a count."""

    def __init__(self) -> None:
        self._lines: dict[str, None] = {}
        self._tallies: dict[str, tuple[int, str]] = {}

    def add(self, text: str) -> None:
        """A remark that stands for itself; said once however often it is added."""
        self._lines[text] = None

    def tally(self, text: str, where: str, count: int = 1) -> None:
        """Counts ``text``, which reads on from a number: "3 triangles without area dropped"."""
        total, first = self._tallies.get(text, (0, where))
        self._tallies[text] = (total + count, first)

    def lines(self) -> tuple[str, ...]:
        """All remarks, tallies last."""
        tallies = (f"{count} {text}, first at {where}" for text, (count, where) in self._tallies.items())
        return (*self._lines, *tallies)
