"""The report's drawings, as inline SVG that takes its colours from the page's style."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from html import escape

from irradia.report import text
from irradia.report.data import Convergence

_WIDTH, _HEIGHT = 640, 240
_LEFT, _RIGHT, _TOP, _BOTTOM = 64, 16, 16, 40
_TOLERANCE = 0.01  # the band drawn about a ratio of one
_MOST_STAGES, _LEAST_SHARE = 8, 0.02  # of a bar: more rows than that say no more
_SHADES = 6  # classes shade-0 … shade-5 in the style sheet


def stage_bar(stage_s: Mapping[str, float]) -> str:
    """Wall time by stage: one bar cut in proportion, with a legend that holds the numbers.

    The longest have a row each, in the order in which they ran; the others have one together.
    """
    total = sum(stage_s.values())
    if total <= 0:
        return '<p class="quiet">No times were taken.</p>'
    parts, rows = [], []
    for index, (name, seconds) in enumerate(_longest(stage_s, total).items()):
        shade = f"shade-{index % _SHADES}"
        title = f"{escape(name)}: {text.duration(seconds)}"
        parts.append(f'<span class="{shade}" style="flex-grow:{seconds / total:.5f}" title="{title}"></span>')
        rows.append(
            f'<tr><td><i class="{shade}"></i>{escape(name)}</td>'
            f"<td>{text.duration(seconds)}</td><td>{seconds / total:.0%}</td></tr>"
        )
    table = f'<table class="numbers">{"".join(rows)}</table>'
    return f'<div class="bar" role="img" aria-label="Time by stage">{"".join(parts)}</div>{table}'


def _longest(stage_s: Mapping[str, float], total: float) -> dict[str, float]:
    """Stages worth a row, and the sum of the rest where that is of several."""
    ranked = sorted(stage_s, key=lambda name: -stage_s[name])[:_MOST_STAGES]
    kept = {name for name in ranked if stage_s[name] >= _LEAST_SHARE * total}
    rest = [seconds for name, seconds in stage_s.items() if name not in kept]
    if len(rest) < 2:
        return dict(stage_s)
    long = {name: seconds for name, seconds in stage_s.items() if name in kept}
    return long | {f"{len(rest)} shorter stages": sum(rest)}


def mean_ratio_plot(convergence: Convergence) -> str:
    """Mean ratio over samples, the latter by powers of two, with a band of one per cent."""
    xs = [math.log2(s) for s in convergence.samples]
    reach = max(2 * _TOLERANCE, *(abs(r - 1) * 1.15 for r in convergence.mean_ratio))
    low, high = min(xs), max(xs) if max(xs) > min(xs) else min(xs) + 1

    def px(x: float) -> float:
        return _LEFT + (x - low) / (high - low) * (_WIDTH - _LEFT - _RIGHT)

    def py(ratio: float) -> float:
        return _TOP + (1 + reach - ratio) / (2 * reach) * (_HEIGHT - _TOP - _BOTTOM)

    points = [(px(x), py(r)) for x, r in zip(xs, convergence.mean_ratio, strict=True)]
    line = " ".join(f"{x:.1f},{y:.1f}" for x, y in points)
    dots = "".join(
        f'<circle cx="{x:.1f}" cy="{y:.1f}" r="3"><title>{s} samples: {r:.5f}</title></circle>'
        for (x, y), s, r in zip(points, convergence.samples, convergence.mean_ratio, strict=True)
    )
    band = (
        f'<rect class="band" x="{_LEFT}" width="{_WIDTH - _LEFT - _RIGHT}" '
        f'y="{py(1 + _TOLERANCE):.1f}" height="{py(1 - _TOLERANCE) - py(1 + _TOLERANCE):.1f}"/>'
    )
    axes = "".join(_level(py(r), f"{r:.3f}") for r in (1 - reach, 1.0, 1 + reach))
    ticks = "".join(_tick(px(math.log2(s)), str(s)) for s in _sparse(convergence.samples))
    label = f"Mean over {convergence.against}, by samples per texel; the band is ±1 %"
    return (
        f'<svg class="plot" viewBox="0 0 {_WIDTH} {_HEIGHT}" role="img" aria-label="{escape(label)}">'
        f'{band}{axes}{ticks}<polyline points="{line}"/>{dots}'
        f'<text class="axis" x="{(_LEFT + _WIDTH - _RIGHT) / 2}" y="{_HEIGHT - 4}">samples per texel</text>'
        f"</svg>"
        f'<p class="quiet">{escape(label)}.</p>'
    )


def _level(y: float, label: str) -> str:
    return (
        f'<line class="grid" x1="{_LEFT}" x2="{_WIDTH - _RIGHT}" y1="{y:.1f}" y2="{y:.1f}"/>'
        f'<text class="left" x="{_LEFT - 8}" y="{y + 4:.1f}">{label}</text>'
    )


def _tick(x: float, label: str) -> str:
    return f'<text class="below" x="{x:.1f}" y="{_HEIGHT - _BOTTOM + 16}">{label}</text>'


def _sparse(samples: Sequence[int], at_most: int = 8) -> Sequence[int]:
    """Few enough labels that they don't touch, the first and last among them."""
    step = -(-len(samples) // at_most)
    return [s for i, s in enumerate(samples) if (len(samples) - 1 - i) % step == 0]
