"""The results of field_quality.py as a page of Markdown."""

from __future__ import annotations

import shlex
from collections.abc import Callable, Sequence

import numpy as np

from support.field_rows import Row

PRESET = "hash-200kB"
UNITY = (  # Sponza, 3,975,860 probes, 8000 steps, GPU not named: configuration, MB, MAE of validation
    ("tri-plane 64² × 8, 32 × 2", 0.19, 0.025445),
    ("tri-plane 128² × 16, 64 × 2", 1.52, 0.021155),
    ("tri-plane 256² × 32, 64 × 3", 12.03, 0.016983),
    ("hash 8 levels of 2^17, 16 → 512, 32 × 2", 4.00, 0.022266),
    ("hash 16 levels of 2^19, 16 → 2048, 64 × 2", 32.01, 0.009382),
    ("hash 16 levels of 2^21, 16 → 4096, 64 × 3", 128.02, 0.003095),
)


def quality_page(rows: Sequence[Row], arguments: Sequence[str]) -> str:
    """The whole page; rows that are missing are left out."""
    scenes = list(dict.fromkeys(row["scene"] for row in rows if row["scene"] != "rooms"))
    parts = [
        ["# Light in 50 kB, 200 kB, 1 MB"],
        ["![HDR-FLIP over bytes](field_quality.svg)"],
        _aims(rows, scenes),
        *(_scene(rows, scene) for scene in scenes),
        _sh_mode(rows),
        _facts(rows, arguments),
    ]
    return "\n\n".join("\n".join(part) for part in parts if part) + "\n"


def _aims(rows: Sequence[Row], scenes: Sequence[str]) -> list[str]:
    """What was aimed at, and what was met."""
    lines = ["| aim | limit | measured |", "|---|---|---|"]
    cornell = [r for r in rows if r["scene"] == "cornell" and _is_field(r) and r["n_bytes"] <= 1_400_000]
    if cornell:
        best = min(cornell, key=lambda row: row["flip"])
        anchor = "the Neural Irradiance Volume needs 5.4 MB for 0.05 on a Cornell box that differs from ours"
        lines.append(
            f"| HDR-FLIP on cornell in at most 1.4 MB ({anchor}) | 0.05 | "
            f"{best['flip']:.4f}, {best['name']}, {_kb(best)} |"
        )
    gains = [gain for scene in scenes if (gain := _gain(rows, scene)) is not None]
    if gains:
        each = ", ".join(f"{gain:.1f}×" for gain in gains)
        lines.append(
            f"| MSE in space against SH L2 grids in as many bytes, 200 kB, median of the scenes | 10× less | "
            f"{np.median(gains):.1f}× less ({each}) |"
        )
    rooms = _row(rows, "rooms", PRESET)
    if rooms and rooms["leaks"]["ratio"]:
        lines.append(f"| leak ratio in builtin:rooms | 2 | {rooms['leaks']['ratio']:.2f} |")
    lines += _rounding(rows, scenes)
    return lines


def _gain(rows: Sequence[Row], scene: str) -> float | None:
    """How much less MSE than an SH L2 grid, by the best field of about the same size."""
    grid = _row(rows, scene, f"sh2 beside {PRESET}")
    fields = [
        row for row in rows if row["scene"] == scene and _is_field(row) and row["name"].endswith("200kB")
    ]
    if not grid or not fields:
        return None
    least = min(row["space"]["mse_noise_free"] for row in fields)
    return grid["space"]["mse_noise_free"] / max(least, 1e-12)


def _rounding(rows: Sequence[Row], scenes: Sequence[str]) -> list[str]:
    """What 8 and 4 bits cost."""
    lines = []
    for bits, name, limit in ((8, PRESET, 0.03), (4, f"bits-4 of {PRESET}", 0.10)):
        costs = []
        for scene in scenes:
            exact, coded = _row(rows, scene, f"bits-16 of {PRESET}"), _row(rows, scene, name)
            if exact and coded:
                costs.append((scene, coded["flip"] / exact["flip"] - 1.0))
        if costs:
            each = ", ".join(f"{scene} {cost:+.1%}" for scene, cost in costs)
            lines.append(f"| HDR-FLIP that {bits} bits cost {PRESET} | {limit:.0%} | {each} |")
    return lines


def _scene(rows: Sequence[Row], scene: str) -> list[str]:
    lines = [
        f"## {scene}",
        "",
        "| | bytes | HDR-FLIP | PSNR | relMSE, noise removed | MSE in space | leak ratio | steps |",
        "|---|---|---|---|---|---|---|---|",
    ]
    here = [row for row in rows if row["scene"] == scene and row.get("flip") is not None]
    for row in sorted(here, key=lambda row: (not _is_field(row), row["name"].split("-")[0], row["n_bytes"])):
        view = row["views"][0]
        mark = "≈ " if view["flip"]["is_noise"] else ""
        cells = (
            _label(row),
            f"{row['n_bytes']:,}",
            f"{mark}{row['flip']:.4f}",
            f"{view['psnr_db']['value']:.1f}",
            f"{view['relmse_noise_free']:.1e}",
            _maybe(row["space"], lambda space: f"{space['mse_noise_free']:.2e}"),
            _maybe(row["leaks"], lambda leaks: "–" if leaks["ratio"] is None else f"{leaks['ratio']:.2f}"),
            _steps(row),
        )
        lines.append(f"| {' | '.join(cells)} |")
    noise = [row["views"][0]["flip"]["noise"] for row in here]
    if noise:
        lines += ["", f"The reference's own noise is worth an HDR-FLIP of {max(noise):.4f}. {_scored(here)}"]
    return lines


def _steps(row: Row) -> str:
    trained = row.get("trained")
    if not trained:
        return "–"
    return f"{trained['steps']:,} × {trained['batch_size']:,} in {row['settings']['train_s']:g} s"


def _scored(rows: Sequence[Row]) -> str:
    """What figures of pictures are of: rows of before don't say, and counted the backdrop too."""
    of_scene = sum(row.get("pixels") == "scene" for row in rows)
    if of_scene == len(rows):
        return "Figures of pictures are of the pixels that show the scene."
    if of_scene == 0:
        return "Figures of pictures are of whole pictures, the backdrop included."
    return f"Figures of pictures are of the scene in {of_scene} rows, of whole pictures in the others."


def _sh_mode(rows: Sequence[Row]) -> list[str]:
    found = _row(rows, "atrium", "sh-mode")
    if not found:
        return []
    ours = found["trained"]["validation"]
    lines = [
        "## Coefficients of SH, beside the Unity project",
        "",
        "**Another scene**: the project's rows are of Sponza with its own units, ours is of the atrium. They "
        "say that sizes and orders of magnitude agree, no more.",
        "",
        "| | MB | MAE |",
        "|---|---|---|",
        f"| **ours, atrium**: hash 8 levels of 2^17, 16 → 512, 32 × 2 | {found['n_bytes'] / 1e6:.2f} | "
        f"{ours['mae']:.6f} |",
    ]
    return lines + [f"| the project, Sponza: {name} | {mb:.2f} | {mae:.6f} |" for name, mb, mae in UNITY]


def _facts(rows: Sequence[Row], arguments: Sequence[str]) -> list[str]:
    if not rows:
        return []
    commits = ", ".join(dict.fromkeys(str(row["commit"])[:12] for row in rows))
    cpus = ", ".join(dict.fromkeys(row["cpu"] for row in rows))
    settings = rows[-1]["settings"]
    train_s = " or ".join(f"{s:g}" for s in sorted({row["settings"]["train_s"] for row in rows}))
    return [
        "Bytes are those of the file: tables in 8 bits, the perceptron in halves, packed by zstd; "
        "frequencies have no tables, and the largest perceptron that specs allow has about 180 kB.",
        "",
        f"- Command: `{shlex.join(['python', 'bench/field_quality.py', *arguments])}`",
        f"- Training: {train_s} s a point, {settings['samples']:,} samples of {settings['rays']} rays",
        f"- Machine: {cpus}; commits: {commits}",
    ]


def _row(rows: Sequence[Row], scene: str, name: str) -> Row | None:
    return next((row for row in rows if (row["scene"], row["name"]) == (scene, name)), None)


def _is_field(row: Row) -> bool:
    return row.get("flip") is not None and " beside " not in row["name"]


def _label(row: Row) -> str:
    return row["name"] if _is_field(row) else f"{row['label']}, beside {row['name'].split(' beside ')[1]}"


def _maybe(value: Row | None, show: Callable[[Row], str]) -> str:
    return "–" if value is None else show(value)


def _kb(row: Row) -> str:
    return f"{row['n_bytes'] / 1000:.0f} kB"
