"""The figures of the field benchmark as Markdown."""

from __future__ import annotations

from collections.abc import Sequence
from statistics import median

from support.field_costs import Cost, inference_cost, step_cost
from support.field_rounds import Measured, Rounds
from support.machine_limits import Limits


def markdown(measured: Sequence[Measured], limits: Limits | None, facts: Sequence[str]) -> str:
    """One page: speeds against the peer, shares of the machine, agreement, and what it was measured on.

    Args:
        measured: The fields.
        limits: Of the machine; None leaves shares out.
        facts: Machine, commit, seed, command.
    """
    parts = [
        ["# Training and evaluating fields"],
        ["Training steps: forward, loss, backward, Adam.", "", *_speed_table(measured, "step")],
        ["Evaluation of as many points, network and head.", "", *_speed_table(measured, "infer")],
    ]
    if limits is not None:
        parts.append(_limits_table(measured, limits))
    parts += [_agreement_table(measured), [f"- {fact}" for fact in facts]]
    return "\n\n".join("\n".join(part) for part in parts) + "\n"


def _speed_table(measured: Sequence[Measured], work: str) -> list[str]:
    unit = "M samples/s" if work == "step" else "M queries/s"
    wanted = " wanted |" if work == "step" else ""
    lines = [
        f"| field | PyTorch | Irradia | {unit} | times as fast | slowest – fastest |{wanted}",
        "|---" * (7 if wanted else 6) + "|",
    ]
    for row in measured:
        rounds: Rounds = getattr(row, work)
        ratios = rounds.ratios
        line = (
            f"| {row.model.name} | {_ms(rounds.peer)} | {_ms(rounds.ours)} | "
            f"{row.batch / median(rounds.ours) / 1e6:.2f} | **{median(ratios):.1f}×** | "
            f"{min(ratios):.1f} – {max(ratios):.1f} |"
        )
        aim = "–" if row.model.wanted is None else f"≥ {row.model.wanted:g}×"
        lines.append(line + (f" {aim} |" if wanted else ""))
    return lines


def _ms(seconds: Sequence[float]) -> str:
    """Median, and the range where it says something."""
    low, middle, high = (1e3 * s for s in (min(seconds), median(seconds), max(seconds)))
    return f"{middle:.1f} ms ({low:.1f} – {high:.1f})"


def _limits_table(measured: Sequence[Measured], limits: Limits) -> list[str]:
    lines = [
        f"Limits of this machine, measured in the same run: {limits.flops / 1e9:.0f} GFLOP/s of multiply-adds"
        f" in registers, {limits.bytes_per_s / 1e9:.1f} GB/s in a triad over memory. Bytes are those"
        " that gathers, scatters and Adam touch, in caches too, so their share"
        " may pass 100 %.",
        "",
        "| field | MFLOP | share of FLOP/s | MB | share of bytes/s | both, one after the other |",
        "|---|---|---|---|---|---|",
    ]
    for row in measured:
        if row.model.own_backward:
            continue  # the same field again, against another peer
        for name, cost, rounds in (
            ("step", step_cost(row.model.spec, row.batch), row.step),
            ("evaluation", inference_cost(row.model.spec, row.batch), row.infer),
        ):
            lines.append(f"| {row.model.name}, {name} |{_shares(cost, median(rounds.ours), limits)}")
    return lines


def _shares(cost: Cost, seconds: float, limits: Limits) -> str:
    flop_s, byte_s = cost.flops / limits.flops, cost.bytes / limits.bytes_per_s
    return (
        f" {cost.flops / 1e6:.0f} | {flop_s / seconds:.0%} | {cost.bytes / 1e6:.0f} |"
        f" {byte_s / seconds:.0%} | {(flop_s + byte_s) / seconds:.0%} |"
    )


def _agreement_table(measured: Sequence[Measured]) -> list[str]:
    lines = [
        "Before timing, from the same parameters (relative differences between both sides):",
        "",
        "| field | outputs | gradients, worst array | loss, first steps |",
        "|---|---|---|---|",
    ]
    for row in measured:
        found = row.agreement
        lines.append(f"| {row.model.name} | {found.outputs:.1e} | {found.gradients:.1e} | {found.loss:.1e} |")
    return lines
