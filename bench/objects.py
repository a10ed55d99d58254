"""What do 5,000 objects cost against the same triangles as one object?

    python bench/objects.py [--resolution 2048] [--samples 64] [--repeats 3]

Bakes ``builtin:objects`` and ``builtin:objects-merged`` in turn, each bake a process of its own, and
compares the time of one pass per sample: texels differ in number, since each object has borders of
its own. Both lightmaps' means are compared first. Results go to ``bench/results/objects.md``.
"""

from __future__ import annotations

import argparse
import json
import platform
import subprocess
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path
from statistics import median
from typing import Any

sys.path.insert(0, str(Path(__file__).parent))

import numpy as np

from irradia.core import write_text_atomic
from irradia.core.device import cpu_name
from irradia.core.provenance import source_commit
from irradia.formats.lightmap import read_lightmap

RESULTS = Path(__file__).parent / "results" / "objects.md"
SCENES = ("builtin:objects-merged", "builtin:objects")
SET_UP = ("scene", "unwrap", "pack", "texels", "ray tracing set-up", "hidden texels")  # stages
MAX_RATIO, MAX_MEAN_ERROR = 1.5, 0.02


@dataclass(frozen=True)
class Run:
    """One bake.

    Attributes:
        samples_per_s: Gather rays, their share of next-event rays included.
        set_up_s: Everything before the first ray, by stage.
        mean: Of the lightmap over covered texels.
    """

    texels: int
    samples_per_s: float
    set_up_s: dict[str, float]
    mean: float


def main() -> None:
    """Bakes in turn, prints and writes the table."""
    arguments = _parse()
    runs: dict[str, list[Run]] = {scene: [] for scene in SCENES}
    for _ in range(arguments.repeats):
        for scene in SCENES:
            runs[scene].append(_bake(scene, arguments))
            print(f"{scene}: {runs[scene][-1].samples_per_s / 1e6:.2f} M samples/s", file=sys.stderr)
    merged, single = (median(run.samples_per_s for run in runs[scene]) for scene in SCENES)
    ratio = merged / single
    text = _markdown(runs, ratio, arguments)
    print(text)
    means = [np.mean([run.mean for run in runs[scene]]) for scene in SCENES]
    if abs(means[1] / means[0] - 1.0) > MAX_MEAN_ERROR:
        raise SystemExit(f"the two don't agree: their means are {means[0]:.4g} and {means[1]:.4g}")
    write_text_atomic(RESULTS, text)
    if ratio > MAX_RATIO:
        raise SystemExit(f"a sample among 5,000 objects costs {ratio:.2f} times one in a single object")


def _parse() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--resolution", type=int, default=2048, help="page edge in texels")
    parser.add_argument("--samples", type=int, default=64)
    parser.add_argument("--repeats", type=int, default=3)
    return parser.parse_args()


def _bake(scene: str, arguments: argparse.Namespace) -> Run:
    with tempfile.TemporaryDirectory() as folder:
        out = Path(folder) / "out"
        command = [sys.executable, "-m", "irradia", "bake", scene, "-o", str(out), "--json"]
        command += ["--resolution", str(arguments.resolution), "--samples", str(arguments.samples)]
        command += ["--no-denoise", "--no-report"]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        if done.returncode != 0:
            raise SystemExit(f"Irradia failed:\n{done.stderr[-4000:]}")
        record: dict[str, Any] = json.loads(done.stdout)
        lightmap = read_lightmap(out / "lightmap.exr")
    return Run(
        texels=record["lightmap"]["n_texels"],
        samples_per_s=record["samples_per_second"],
        set_up_s={name: record["stage_s"].get(name, 0.0) for name in SET_UP},
        mean=float(lightmap.pages[lightmap.covered].mean()),
    )


def _markdown(runs: dict[str, list[Run]], ratio: float, arguments: argparse.Namespace) -> str:
    lines = [
        "# 5,000 objects against the same triangles as one object",
        "",
        f"A sample costs **{ratio:.2f} times** as much; the limit is {MAX_RATIO}.",
        "",
        "| scene | texels | M samples/s, median | lowest – highest | mean E/π | "
        + " | ".join(f"{name}, s" for name in SET_UP)
        + " |",
        "|---" * (5 + len(SET_UP)) + "|",
    ]
    for scene, done in runs.items():
        rates = [run.samples_per_s / 1e6 for run in done]
        stages = [median(run.set_up_s[name] for run in done) for name in SET_UP]
        lines.append(
            f"| {scene} | {done[0].texels:,} | {median(rates):.2f} | {min(rates):.2f} – {max(rates):.2f} "
            f"| {done[0].mean:.4g} | " + " | ".join(f"{seconds:.1f}" for seconds in stages) + " |"
        )
    lines += [
        "",
        "Unwraps may come from the cache.",
        "",
        f"`python bench/objects.py --resolution {arguments.resolution} --samples {arguments.samples} "
        f"--repeats {arguments.repeats}`, {cpu_name()}, {platform.system()}, "
        f"commit {source_commit() or 'unknown'}, seed 0.",
        "",
    ]
    return "\n".join(lines)


if __name__ == "__main__":
    main()
