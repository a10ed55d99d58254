"""Drawings on logarithmic axes: dots with their Pareto front, and families of curves, as inline SVG."""

from __future__ import annotations

import math
from collections.abc import Collection, Iterable, Sequence
from dataclasses import dataclass
from html import escape

_WIDTH, _HEIGHT = 640, 400
_LEFT, _RIGHT, _TOP, _BOTTOM = 70, 16, 34, 46
_N_SHADES = 6  # classes shade-0 … shade-5 of the style sheet
_DOT_PX = 4.5
_MOST_POINTS = 40  # of a curve
_NAMES_PX, _NAME_LETTERS, _LINE_PX = 170, 24, 14.0  # of names beside curves
# Ticks within a decade of an axis that spans fewer decades than this.
_TICKS = (
    (0.35, (1, 1.1, 1.25, 1.5, 1.75, 2, 2.25, 2.5, 3, 3.5, 4, 4.5, 5, 6, 7, 8, 9)),
    (0.8, (1, 1.5, 2, 3, 4, 5, 6, 8)),
    (2.5, (1, 2, 5)),
    (math.inf, (1,)),
)


@dataclass(frozen=True)
class Dot:
    """One result; both values are above 0.

    Attributes:
        x, y: Less is better.
        name: Shown when pointed at.
        group: What its colour stands for.
    """

    x: float
    y: float
    name: str
    group: str


@dataclass(frozen=True)
class Curve:
    """One course; points whose y isn't above 0 are left out."""

    name: str
    group: str
    points: Sequence[tuple[float, float]]


@dataclass(frozen=True)
class _Axis:
    """A logarithmic axis from ``low`` to ``high``, both powers of ten's logarithms, onto pixels."""

    low: float
    high: float
    start_px: float
    end_px: float

    def __call__(self, value: float) -> float:
        share = (math.log10(value) - self.low) / (self.high - self.low)
        return self.start_px + share * (self.end_px - self.start_px)

    def ticks(self) -> list[float]:
        """Powers of ten, and round numbers between them where they would be few."""
        decades = range(math.floor(self.low), math.ceil(self.high) + 1)
        between = next(factors for span, factors in _TICKS if self.high - self.low < span)
        every = [factor * 10.0**decade for decade in decades for factor in between]
        return [v for v in every if self.low - 1e-9 <= math.log10(v) <= self.high + 1e-9]


def pareto_front(dots: Sequence[Dot]) -> list[Dot]:
    """Those that none beats in both values, by rising x."""
    front: list[Dot] = []
    for dot in sorted(dots, key=lambda dot: (dot.x, dot.y)):
        if not front or dot.y < front[-1].y:
            front.append(dot)
    return front


def scatter_plot(dots: Sequence[Dot], x_label: str, y_label: str) -> str:
    """Dots in their groups' colours, and the Pareto front through the best."""
    px, py = _axes([dot.x for dot in dots], [dot.y for dot in dots])
    front = pareto_front(dots)
    best = {dot.name for dot in front}
    groups = _groups(dot.group for dot in dots)
    line = " ".join(f"{px(dot.x):.1f},{py(dot.y):.1f}" for dot in front)
    marks = "".join(
        f'<circle class="dot-{groups[dot.group]}{" front" if dot.name in best else ""}" '
        f'cx="{px(dot.x):.1f}" cy="{py(dot.y):.1f}" r="{_DOT_PX}">'
        f"<title>{escape(dot.name)}: {dot.x:.4g}, {dot.y:.3g}</title></circle>"
        for dot in dots
    )
    return _frame(px, py, x_label, y_label, groups, f'<polyline points="{line}"/>{marks}')


def curves_plot(curves: Sequence[Curve], x_label: str, y_label: str, strong: Collection[str] = ()) -> str:
    """Curves in their groups' colours, each evened so that its course is seen through its noise.

    Args:
        curves: Courses.
        x_label: Of the horizontal axis.
        y_label: Of the vertical one.
        strong: Names of those that stand out, and are named where they end; the others stay faint.
    """
    drawn = [Curve(curve.name, curve.group, evened(curve.points)) for curve in curves]
    drawn = sorted((curve for curve in drawn if curve.points), key=lambda curve: curve.name in strong)
    if not drawn:
        return ""
    every = [point for curve in drawn for point in curve.points]
    right = _NAMES_PX if any(curve.name in strong for curve in drawn) else _RIGHT
    px, py = _axes([x for x, _ in every], [y for _, y in every], right)
    groups = _groups(curve.group for curve in drawn)
    lines = "".join(
        f'<polyline class="line-{groups[curve.group]}{" strong" if curve.name in strong else ""}" '
        f'points="{" ".join(f"{px(x):.1f},{py(y):.1f}" for x, y in curve.points)}">'
        f"<title>{escape(curve.name)}</title></polyline>"
        for curve in drawn
    )
    names = _names([(curve, py(curve.points[-1][1])) for curve in drawn if curve.name in strong])
    return _frame(px, py, x_label, y_label, groups, lines + names)


def evened(points: Sequence[tuple[float, float]]) -> list[tuple[float, float]]:
    """Geometric means over equal parts of the logarithm of x; what isn't above 0 is left out."""
    kept = [(math.log(x), math.log(y)) for x, y in points if x > 0 and y > 0 and math.isfinite(y)]
    if len(kept) <= _MOST_POINTS:
        return [(math.exp(x), math.exp(y)) for x, y in kept]
    low = min(x for x, _ in kept)
    width = (max(x for x, _ in kept) - low) / _MOST_POINTS or 1.0
    parts: dict[int, list[tuple[float, float]]] = {}
    for x, y in kept:
        parts.setdefault(min(int((x - low) / width), _MOST_POINTS - 1), []).append((x, y))
    return [
        (math.exp(sum(x for x, _ in part) / len(part)), math.exp(sum(y for _, y in part) / len(part)))
        for _, part in sorted(parts.items())
    ]


def _names(ends: Sequence[tuple[Curve, float]]) -> str:
    """Names beside where their curves end, moved apart where they would touch."""
    written, free = [], float(_TOP)
    for curve, y in sorted(ends, key=lambda end: end[1]):
        free = max(y + 4.0, free)
        name = curve.name if len(curve.name) <= _NAME_LETTERS else f"{curve.name[: _NAME_LETTERS - 1]}…"
        written.append(
            f'<text class="name" x="{_WIDTH - _NAMES_PX + 6}" y="{free:.1f}">{escape(name)}'
            f"<title>{escape(curve.name)}</title></text>"
        )
        free += _LINE_PX
    return "".join(written)


def _axes(xs: Sequence[float], ys: Sequence[float], right: float = _RIGHT) -> tuple[_Axis, _Axis]:
    x, y = _reach(xs), _reach(ys)
    return _Axis(*x, _LEFT, _WIDTH - right), _Axis(*y, _HEIGHT - _BOTTOM, _TOP)


def _reach(values: Sequence[float]) -> tuple[float, float]:
    low, high = math.log10(min(values)), math.log10(max(values))
    margin = max(0.06 * (high - low), 0.05)
    return low - margin, high + margin


def _groups(names: Iterable[str]) -> dict[str, int]:
    return {name: i % _N_SHADES for i, name in enumerate(sorted(set(names)))}


def _frame(px: _Axis, py: _Axis, x_label: str, y_label: str, groups: dict[str, int], content: str) -> str:
    levels = "".join(
        f'<line class="grid" x1="{_LEFT}" x2="{px.end_px}" y1="{py(v):.1f}" y2="{py(v):.1f}"/>'
        f'<text class="left" x="{_LEFT - 8}" y="{py(v) + 4:.1f}">{_short(v)}</text>'
        for v in py.ticks()
    )
    ticks = "".join(
        f'<text class="below" x="{px(v):.1f}" y="{_HEIGHT - _BOTTOM + 16}">{_short(v)}</text>'
        for v in px.ticks()
    )
    legend = "".join(
        f'<circle class="dot-{shade}" cx="{_LEFT + 6 + 110 * i}" cy="14" r="{_DOT_PX}"/>'
        f'<text x="{_LEFT + 16 + 110 * i}" y="18">{escape(name)}</text>'
        for i, (name, shade) in enumerate(groups.items())
    )
    label = f"{y_label} over {x_label}"
    middle = (px.start_px + px.end_px) / 2
    return (
        f'<svg class="plot" viewBox="0 0 {_WIDTH} {_HEIGHT}" role="img" aria-label="{escape(label)}">'
        f"{levels}{ticks}{legend}{content}"
        f'<text class="axis" x="{middle}" y="{_HEIGHT - 6}">{escape(x_label)}</text>'
        f'<text x="4" y="18">{escape(y_label)}</text></svg>'
    )


def _short(value: float) -> str:
    """A tick: 20k, 1M, 0.05, 1e-5."""
    for factor, unit in ((1e9, "G"), (1e6, "M"), (1e3, "k")):
        if value >= factor * 0.999:
            return f"{value / factor:g}{unit}"
    return f"{value:g}" if value >= 1e-3 else f"{value:.0e}"
