"""How long does each built-in scene take to one noise?

    python bench/builtin_scenes.py [--scene NAME ...] [--noise 0.05] [--resolution 1024] [--limit-s 300]
                                   [--repeats 3] [--threads N]

Each bake is the command line in a fresh process, without a report. A short one before the clock starts
fills the cache of unwraps and of compiled kernels, as on a user's second bake. Scenes that take longer
than the limit to reach the noise are shown with the noise that they have by then. The table is written
after each scene and finished bakes are kept (out/bench), so that the benchmark can be stopped and taken up.
Thousands of objects need a larger page than the rest.
"""

from __future__ import annotations

import argparse
import statistics
import sys
from collections.abc import Sequence
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))

from irradia.core.device import available_threads
from irradia.core.files import write_text_atomic
from irradia.scene.builtin import NAMES
from support.bake_command import Run, facts, run_bake_once
from support.kept import Kept

RESULT = Path(__file__).parent / "results" / "builtin_scenes.md"
LARGER_PAGE_PX = {"objects": 2048, "objects-merged": 2048}


def main() -> None:
    """Bakes, prints and writes the table."""
    arguments = _parse()
    common = ["--threads", str(arguments.threads), "--no-report"]
    budget = ["--noise", str(arguments.noise), "--time", str(arguments.limit_s)]
    notes = facts("bench/builtin_scenes.py", arguments.threads)
    steps = Kept("builtin_scenes", {"common": common, "budget": budget})
    rows: list[str] = []
    for name in arguments.scene:
        page = ["--resolution", str(max(arguments.resolution, LARGER_PAGE_PX.get(name, 0)))]
        scene, step = f"builtin:{name}", f"{name} at {page[1]}"
        run_bake_once(steps, f"warm {step}", scene, *common, *page, "--samples", "1")
        runs = [
            run_bake_once(steps, f"{step} {i}", scene, *common, *page, *budget)
            for i in range(arguments.repeats)
        ]
        rows.append(_row(name, runs))
        print(rows[-1], file=sys.stderr)
        write_text_atomic(RESULT, "\n".join([*_head(arguments), *rows, "", *notes, ""]))
    print(RESULT.read_text(encoding="utf-8"))


def _head(arguments: argparse.Namespace) -> list[str]:
    edge, limit_s = arguments.resolution, arguments.limit_s
    return [
        f"# Bake times of the built-in scenes at {arguments.noise:.0%} noise",
        "",
        "Noise: 95th percentile over texels of standard error over (mean + 1 % of the map's median).",
        f"One page of {edge} × {edge} (objects: 2048), at most {limit_s:.0f} s of tracing; medians of",
        f"{arguments.repeats}, fastest and slowest beside them. Bake: from opening the scene to finished",
        "pages; tracing is part of it. Whole: the process, files written.",
        "",
        "| scene | texels | samples a texel | noise | bake, s | of it tracing, s | whole, s |",
        "|---|---:|---:|---:|---:|---:|---:|",
    ]


def _row(name: str, runs: Sequence[Run]) -> str:
    middle = sorted(runs, key=lambda run: run.result["bake_s"])[len(runs) // 2].result
    stats = middle["stats"]
    return (
        f"| {name} | {middle['lightmap']['n_texels']:,} | {stats['samples_per_texel']:.0f} "
        f"| {_percent(stats['noise_p95'])} "
        f"| {_spread([run.result['bake_s'] for run in runs])} "
        f"| {_spread([run.result['stats']['tracing_seconds'] for run in runs])} "
        f"| {_spread([run.wall_s for run in runs])} |"
    )


def _percent(share: float | None) -> str:
    """A bake that ends before its pilot does knows no noise."""
    return "unknown" if share is None else f"{share:.1%}"


def _spread(seconds: Sequence[float]) -> str:
    return f"{statistics.median(seconds):.2f} ({min(seconds):.2f} – {max(seconds):.2f})"


def _parse() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--scene", nargs="+", default=NAMES, choices=NAMES, metavar="NAME")
    parser.add_argument("--noise", type=float, default=0.05)
    parser.add_argument("--resolution", type=int, default=1024, help="page edge in texels")
    parser.add_argument("--limit-s", type=float, default=300.0, help="of tracing, for each bake")
    parser.add_argument("--repeats", type=int, default=3)
    parser.add_argument("--threads", type=int, default=available_threads())
    return parser.parse_args()


if __name__ == "__main__":
    main()
