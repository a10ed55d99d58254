"""Progress for anything that can take over two seconds, on stderr, with rate and time left.

Stages nest nowhere: a command runs one after another and each records its wall time, which the
report then shows.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import Protocol, TextIO


class Stage(Protocol):
    """One running stage."""

    def advance(self, amount: float = 1.0) -> None:
        """Adds to the work done."""
        ...

    def note(self, text: str) -> None:
        """Shows a short remark behind the bar."""
        ...


@dataclass
class Progress:
    """Shows stages and keeps their times.

    Attributes:
        stream: Where bars go; ``None`` keeps silent.
        seconds: Wall time per finished stage, in order.
    """

    stream: TextIO | None = None
    seconds: dict[str, float] = field(default_factory=dict)

    @contextmanager
    def stage(self, name: str, total: float | None = None, unit: str = "") -> Iterator[Stage]:
        """Runs one stage; ``total`` is in ``unit``, or None where the end is not known."""
        bar = _Bar(self.stream, name, total, unit)
        start = time.perf_counter()
        bar.draw(force=True)
        try:
            yield bar
        except BaseException:
            bar.close("stopped")
            raise
        elapsed = time.perf_counter() - start
        self.seconds[name] = self.seconds.get(name, 0.0) + elapsed
        bar.close("done")

    def say(self, text: str) -> None:
        """Prints one line between stages."""
        if self.stream is not None:
            print(text, file=self.stream, flush=True)


def silent_progress() -> Progress:
    """A progress that shows nothing but still keeps times."""
    return Progress(stream=None)


def stderr_progress() -> Progress:
    """The progress of the command line."""
    return Progress(stream=sys.stderr)


class _Bar:
    """A stage's line: redrawn in place on a terminal, printed at start and end elsewhere."""

    def __init__(self, stream: TextIO | None, name: str, total: float | None, unit: str) -> None:
        self._stream = stream
        self._name = name
        self._total = total
        self._unit = unit
        self._done = 0.0
        self._note = ""
        self._start = time.perf_counter()
        self._drawn = 0.0
        self._live = stream is not None and stream.isatty()

    def advance(self, amount: float = 1.0) -> None:
        self._done += amount
        self.draw()

    def note(self, text: str) -> None:
        self._note = text
        self.draw()

    def draw(self, force: bool = False) -> None:
        if self._stream is None:
            return
        now = time.perf_counter()
        interval = 0.1 if self._live else 5.0
        if not force and now - self._drawn < interval:
            return
        if force and not self._live:
            self._drawn = now
            return
        self._drawn = now
        end = "" if self._live else "\n"
        lead = "\r\x1b[2K" if self._live else ""
        print(f"{lead}{self._line(now - self._start)}", end=end, file=self._stream, flush=True)

    def close(self, word: str) -> None:
        if self._stream is None:
            return
        elapsed = time.perf_counter() - self._start
        lead = "\r\x1b[2K" if self._live else ""
        note = f"  {self._note}" if self._note else ""
        print(f"{lead}{self._name:<28} {word} in {elapsed:.1f} s{note}", file=self._stream, flush=True)

    def _line(self, elapsed: float) -> str:
        note = f"  {self._note}" if self._note else ""
        if not self._total:
            return f"{self._name:<28} {elapsed:5.0f} s{note}"
        share = min(self._done / self._total, 1.0)
        filled = round(share * 24)
        bar = "█" * filled + "·" * (24 - filled)
        rate = self._done / elapsed if elapsed > 0 else 0.0
        left = (self._total - self._done) / rate if rate > 0 else float("inf")
        left_text = f"{left:.0f} s left" if left < 1e5 else ""
        return f"{self._name:<28} {bar} {share:4.0%}  {_si(rate)}{self._unit}/s  {left_text}{note}"


def _si(value: float) -> str:
    for factor, suffix in ((1e9, "G"), (1e6, "M"), (1e3, "k")):
        if value >= factor:
            return f"{value / factor:.1f} {suffix}"
    return f"{value:.1f} "
