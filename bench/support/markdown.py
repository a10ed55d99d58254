"""The results as Markdown tables."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from support.convergence import Point, error_floor, time_to_error

Curves = Mapping[str, Sequence[Point]]


@dataclass(frozen=True)
class Agreement:
    """A converged map against the reference.

    Attributes:
        name: The method, as among the curves.
        mean_ratio: 1 without bias.
        bias: The relative RMSE that isn't noise, of either side.
    """

    name: str
    samples: int
    mean_ratio: float
    bias: float


def markdown(
    title: str,
    plot: str,
    curves: Curves,
    agreement: Sequence[Agreement],
    targets: Sequence[float],
    cold_s: float,
    facts: Sequence[str],
) -> str:
    """One page: times to each error, agreement, both curves, and what it was measured on.

    Args:
        title: Scene, size, threads.
        plot: File name of the picture.
        curves: ``Cycles`` and ``Irradia``.
        agreement: Of each.
        targets: Relative RMSEs.
        cold_s: What Irradia's first run after installation takes longer.
        facts: Machine, commit, seeds, command.
    """
    parts = [
        [f"# Time to a clean lightmap: {title}"],
        [f"![Relative RMSE over time]({plot})"],
        _speed_table(curves, targets, cold_s),
        _agreement_table(agreement, curves),
        _curve_table(curves),
        [f"- {fact}" for fact in facts],
    ]
    return "\n\n".join("\n".join(part) for part in parts) + "\n"


def _speed_table(curves: Curves, targets: Sequence[float], cold_s: float) -> list[str]:
    lines = [
        f"| relative RMSE | Cycles | Irradia | ratio | ratio on the first run ever (+{cold_s:.1f} s) |",
        "|---|---|---|---|---|",
    ]
    for target in targets:
        theirs, ours = (time_to_error(curves[name], target) for name in ("Cycles", "Irradia"))
        warm, cold = "–", "–"
        if theirs is not None and ours is not None:
            warm, cold = f"{theirs / ours:.1f}×", f"{theirs / (ours + cold_s):.1f}×"
        lines.append(f"| {target:.0%} | {_seconds(theirs)} | {_seconds(ours)} | {warm} | {cold} |")
    return lines


def _seconds(value: float | None) -> str:
    return "not reached" if value is None else f"{value:.2f} s"


def _agreement_table(agreement: Sequence[Agreement], curves: Curves) -> list[str]:
    lines = [
        "| converged | samples | mean ratio to `path` | bias in relative RMSE | floor of its curve |",
        "|---|---|---|---|---|",
    ]
    for row in agreement:
        floor = error_floor(curves[row.name])
        lines.append(f"| {row.name} | {row.samples} | {row.mean_ratio:.4f} | {row.bias:.2%} | {floor:.2%} |")
    return lines


def _curve_table(curves: Curves) -> list[str]:
    lines = [
        "| | samples | median time | fastest – slowest | relative RMSE | mean ratio |",
        "|---|---|---|---|---|---|",
    ]
    for name, curve in curves.items():
        for p in curve:
            spread = f"{min(p.seconds):.2f} – {max(p.seconds):.2f} s"
            lines.append(
                f"| {name} | {p.samples} | {p.time_s:.2f} s | {spread} | {p.error:.2%} | {p.mean_ratio:.4f} |"
            )
    return lines
