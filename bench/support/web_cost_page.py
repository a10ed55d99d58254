"""The results of web_cost.py as a page of Markdown."""

from __future__ import annotations

import statistics
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True)
class Row:
    """One source of light.

    Attributes:
        flops, fetches: Of one evaluation; multiply-adds count as two.
        bytes: On the GPU.
        file_bytes: Of the field's file before it is packed by zstd; None for what lies in the scene.
        ratios: Times of frames over those with the lightmap, round by round, by backend and way.
    """

    name: str
    flops: float
    fetches: float
    bytes: float
    file_bytes: int | None
    ratios: dict[str, dict[str, list[float]]]


@dataclass(frozen=True)
class CostPage:
    """All results.

    Attributes:
        rows: In order.
        answers: Of web/checks/cost.ts, one a backend.
        first: Milliseconds to the first picture, of ``plain`` and ``lit`` pages in turns.
        facts: What it was measured on.
    """

    rows: Sequence[Row]
    answers: Sequence[dict[str, Any]]
    first: dict[str, list[float]]
    facts: Sequence[str]

    def markdown(self) -> str:
        """The page."""
        parts = [
            "# What baked light costs a page",
            "One evaluation, by formula, and what it keeps on the GPU.",
            self._costs(),
            "Times of frames over those with the lightmap: evaluated by the materials (inline), or by a pass "
            "over the screen at full and half resolution.",
            self._times(),
            self._first(),
            "\n".join(f"- {fact}" for fact in self.facts),
        ]
        return "\n\n".join(parts) + "\n"

    def _costs(self) -> str:
        lines = [
            "| source | operations a pixel | fetches a pixel | on the GPU | file |",
            "|---|---|---|---|---|",
        ]
        for row in self.rows:
            file = "–" if row.file_bytes is None else _kilobytes(row.file_bytes)
            lines.append(
                f"| {row.name} | {row.flops:,.0f} | {row.fetches:,.0f} | {_kilobytes(row.bytes)} | {file} |"
            )
        return "\n".join(lines)

    def _times(self) -> str:
        columns = [(a["backend"], how) for a in self.answers for how in ("inline", "full", "half")]
        lines = [
            "| source | " + " | ".join(f"{backend}, {how}" for backend, how in columns) + " |",
            "|---" * (len(columns) + 1) + "|",
        ]
        for row in self.rows:
            cells = [_spread(row.ratios[backend].get(how)) for backend, how in columns]
            lines.append(f"| {row.name} | " + " | ".join(cells) + " |")
        return "\n".join(lines)

    def _first(self) -> str:
        plain, lit = self.first["plain"], self.first["lit"]
        ratios = [b / a for a, b in zip(plain, lit, strict=True)]
        times = f"{statistics.median(plain):.0f} ms with plain three.js, {statistics.median(lit):.0f} ms"
        return (
            "First picture of the same .glb, from the page's address on: "
            f"{times} with its baked light, {_spread(ratios)} as long."
        )


def _spread(ratios: Sequence[float] | None) -> str:
    if not ratios:
        return "–"
    return f"**{statistics.median(ratios):.2f}×** ({min(ratios):.2f} – {max(ratios):.2f})"


def _kilobytes(n_bytes: float) -> str:
    return f"{n_bytes / 1000:,.1f} kB"
