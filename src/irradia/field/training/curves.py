"""A training's curves as an SVG of its own: loss and PSNR over steps."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from html import escape
from pathlib import Path

from irradia.core.files import write_text_atomic
from irradia.field.training.log import LogRow

_WIDTH, _PANEL = 640, 220
_LEFT, _RIGHT, _TOP, _BOTTOM = 72, 16, 28, 36
_STYLE = """
svg { font: 12px system-ui, sans-serif; background: #fff }
text { fill: #555 } .title { fill: #111; font-weight: 600 }
.grid { stroke: #e4e4e4 } polyline { fill: none; stroke: #2a6fdb; stroke-width: 1.5 }
circle { fill: #2a6fdb } .end { text-anchor: end } .middle { text-anchor: middle }
"""


def write_curves(path: Path, rows: Sequence[LogRow], title: str) -> None:
    """Writes the plot.

    Args:
        path: Of the SVG.
        rows: Of the log.
        title: Above it.
    """
    loss = [(row.step, math.log10(row.loss)) for row in rows if row.loss > 0.0 and math.isfinite(row.loss)]
    psnr = [(row.step, row.psnr_db) for row in rows if row.psnr_db is not None and math.isfinite(row.psnr_db)]
    panels = (
        _panel(f"{title}: loss", loss, lambda y: f"{10.0**y:.2g}", top=0, dots=False),
        _panel("Validation PSNR, dB", psnr, lambda y: f"{y:.1f}", top=_PANEL, dots=True),
    )
    size = f'width="{_WIDTH}" height="{2 * _PANEL}" viewBox="0 0 {_WIDTH} {2 * _PANEL}"'
    svg = f'<svg xmlns="http://www.w3.org/2000/svg" {size} role="img"><style>{_STYLE}</style>'
    write_text_atomic(path, svg + "".join(panels) + "</svg>\n")


def _panel(
    title: str,
    points: Sequence[tuple[float, float]],
    label: Callable[[float], str],
    top: float,
    *,
    dots: bool,
) -> str:
    """One plot with five levels and five steps marked, ``top`` pixels from above."""
    heading = f'<text class="title" x="{_LEFT}" y="{top + 18}">{escape(title)}</text>'
    if not points:
        return heading
    xs, ys = zip(*points, strict=True)
    (x0, x1), (y0, y1) = _range(xs), _range(ys)

    def px(x: float) -> float:
        return _LEFT + (x - x0) / (x1 - x0) * (_WIDTH - _LEFT - _RIGHT)

    def py(y: float) -> float:
        return top + _TOP + (y1 - y) / (y1 - y0) * (_PANEL - _TOP - _BOTTOM)

    bottom = top + _PANEL - _BOTTOM
    levels = "".join(
        f'<line class="grid" x1="{_LEFT}" x2="{_WIDTH - _RIGHT}" y1="{py(y):.1f}" y2="{py(y):.1f}"/>'
        f'<text class="end" x="{_LEFT - 8}" y="{py(y) + 4:.1f}">{label(y)}</text>'
        for y in _fifths(y0, y1)
    )
    steps = "".join(
        f'<text class="middle" x="{px(x):.1f}" y="{bottom + 16}">{x:,.0f}</text>' for x in _fifths(x0, x1)
    )
    line = " ".join(f"{px(x):.1f},{py(y):.1f}" for x, y in points)
    marks = "".join(
        f'<circle cx="{px(x):.1f}" cy="{py(y):.1f}" r="3"><title>{x:,}: {label(y)}</title></circle>'
        for x, y in points
        if dots
    )
    return f'{heading}{levels}{steps}<polyline points="{line}"/>{marks}'


def _range(values: Sequence[float]) -> tuple[float, float]:
    low, high = min(values), max(values)
    return (low, high) if high > low else (low - 0.5, high + 0.5)


def _fifths(low: float, high: float) -> list[float]:
    return [low + (high - low) * i / 4 for i in range(5)]
