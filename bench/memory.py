"""How does the memory of a bake grow with the lightmap's size?

    python bench/memory.py [--scene SCENE] [--resolution PX ...] [--samples 16] [--threads N]

Each bake is the command line in a fresh process; its peak is the highest resident size that the system
saw. The first bake, at the smallest size, is not counted: it fills the caches. Finished bakes are kept
(out/bench), so that the benchmark can be stopped and taken up.
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))

from irradia.core.device import available_threads
from irradia.core.files import write_text_atomic
from support.bake_command import Run, facts, run_bake_once
from support.kept import Kept

RESULT = Path(__file__).parent / "results" / "memory.md"
_RESOLUTIONS_PX = (1024, 2048, 4096)
_MIB = 1 << 20


def main() -> None:
    """Bakes, prints and writes the table."""
    arguments = _parse()
    common = ["--samples", str(arguments.samples), "--no-report", "--threads", str(arguments.threads)]
    steps = Kept("memory", {"scene": arguments.scene, "common": common})
    run_bake_once(steps, "first", arguments.scene, *common, "--resolution", str(min(arguments.resolution)))
    rows = []
    for resolution in arguments.resolution:
        size = ["--resolution", str(resolution)]
        run = run_bake_once(steps, f"at {resolution}", arguments.scene, *common, *size)
        rows.append(_row(resolution, run))
        print(rows[-1], file=sys.stderr)
    notes = facts("bench/memory.py", arguments.threads)
    text = "\n".join([*_head(arguments.scene, arguments.samples), *rows, "", *notes, ""])
    write_text_atomic(RESULT, text)
    print(text)


def _head(scene: str, samples: int) -> list[str]:
    return [
        f"# Peak memory of a bake against resolution: {scene}",
        "",
        f"{samples} samples a texel, denoised, no report. The peak is of the whole process: the scene, its",
        "acceleration structure, libraries and compiled kernels are in it.",
        "",
        "| page, px | texels | peak, MiB | bytes a texel | bake, s |",
        "|---:|---:|---:|---:|---:|",
    ]


def _row(resolution: int, run: Run) -> str:
    peak = run.result["peak_memory_bytes"]
    if peak is None:
        sys.exit("this system doesn't tell a process's peak memory")
    n_texels = run.lightmap["n_texels"]
    return (
        f"| {resolution} | {n_texels:,} | {peak / _MIB:,.0f} | {peak / n_texels:,.0f} "
        f"| {run.result['bake_s']:.1f} |"
    )


def _parse() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--scene", default="builtin:atrium")
    parser.add_argument("--resolution", nargs="+", type=int, default=_RESOLUTIONS_PX, metavar="PX")
    parser.add_argument("--samples", type=int, default=16)
    parser.add_argument("--threads", type=int, default=available_threads())
    return parser.parse_args()


if __name__ == "__main__":
    main()
