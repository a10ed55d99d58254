"""How long to a clean lightmap: Irradia against Blender Cycles on the same cores.

    python bench/bake_vs_cycles.py                           cornell, all steps
    python bench/bake_vs_cycles.py --scene builtin:atrium --resolution 256
    python bench/bake_vs_cycles.py --check-only              only whether the two agree

Both bake the same triangles, lightmap uvs, matte materials and lights: diffuse, direct and
indirect, without colour, without denoising. In this order:

1. Cycles is held to answers on paper (sun, point light, rectangle, environment, furnace).
2. Converged maps of both, and of the cached gather, are compared with Irradia's ``path``.
3. Error over time of both against a ``path`` reference. Each bake is a process of its own; its
   time runs from the scene in memory to the map in memory, so it holds what each does before its
   first ray: BVH, scene upload, kernels. Starting, loading and unwrapping are reported apart.

Both bake all texels. Compared is a random choice of those that lie wholly in a chart, reflect, are
opaque, and that no other surface cuts (no part of them lies inside something): elsewhere bakers differ
by choice, not by speed.

Results go to ``bench/results/``; the reference is kept under ``out/bench`` for the next run.
"""

from __future__ import annotations

import argparse
import platform
import shlex
import sys
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from irradia.bake.setup import cover
from irradia.core.device import available_threads, cpu_name
from irradia.core.provenance import sha256_bytes, source_commit
from irradia.metrics import mean_ratio, relmse_between_means
from support.bake_task import write_task
from support.bench_scene import load_bench_scene, save_bench_scene
from support.convergence import Point, Reference, measure_curve
from support.cycles import bake_with_cycles, peer_version
from support.irradia import bake_with_irradia, trace_reference
from support.markdown import Agreement, markdown
from support.peer_check import check_peer, inner_texels
from support.plot import plot_curves

ROOT = Path(__file__).resolve().parents[1]
RESULTS = ROOT / "bench" / "results"
KEPT = ROOT / "out" / "bench"
TARGETS = (0.30, 0.10, 0.05, 0.02)
REFERENCE_SEEDS = (1001, 1002)


@dataclass(frozen=True)
class Setting:
    """One scene at one size on so many threads.

    Attributes:
        scene: Scene and layout for our side.
        task: The same for the peer.
        pixel: (N,) flat index on the pages of the texels that are compared.
        n_texels: How many are baked.
    """

    scene: Path
    task: Path
    threads: int
    pixel: np.ndarray
    n_texels: int

    def cycles(self, samples: int, seed: int) -> tuple[np.ndarray, float]:
        """Values on the compared texels, and seconds."""
        baked = bake_with_cycles(self.task, samples, seed=seed, threads=self.threads)
        return baked.pages.reshape(-1, 3)[self.pixel], baked.bake_s

    def cached(self, samples: int, seed: int) -> tuple[np.ndarray, float]:
        """As :meth:`cycles`, by the cached gather."""
        baked = bake_with_irradia(self.scene, samples, seed=seed, threads=self.threads)
        return baked.pages.reshape(-1, 3)[self.pixel], baked.bake_s


def main() -> None:
    """Checks, compares, times, writes."""
    arguments = _parse()
    check(arguments.threads)
    with tempfile.TemporaryDirectory() as folder:
        setting, reference = prepare(arguments, Path(folder))
        agreement = compare_converged(setting, reference, arguments.converged_samples)
        if arguments.check_only:
            return
        curves = {
            name: measure_curve(
                bake,
                reference,
                [1 << k for k in range(first, 16)],
                until=TARGETS[-1],
                repeats=arguments.repeats,
                limit_s=arguments.limit_s,
            )
            for name, bake, first in (("Cycles", setting.cycles, 3), ("Irradia", setting.cached, 0))
        }
        cold_s = first_run_overhead(setting, arguments.repeats)
    report(arguments, setting, reference, curves, agreement, cold_s)


def check(threads: int) -> None:
    """Stops unless the peer gives the answers that are known on paper."""
    print("Cycles against answers on paper: relative error of the mean, and of the worst texel")
    failed = []
    for verdict in check_peer(threads):
        word = "ok" if verdict.passed else "WRONG"
        print(
            f"  {verdict.name:<24} {verdict.mean_error:8.3%} {verdict.worst_error:8.2%}  {word}", flush=True
        )
        failed += [] if verdict.passed else [verdict.name]
    if failed:
        raise SystemExit(f"the peer bakes something else than we ask for: {', '.join(failed)}")


def prepare(arguments: argparse.Namespace, folder: Path) -> tuple[Setting, Reference]:
    """Writes the task and bakes the reference, or finds it from an earlier run."""
    scene, layout = load_bench_scene(arguments.scene, arguments.resolution)
    kept, task = folder / "scene.pickle", folder / "task.npz"
    save_bench_scene(kept, scene, layout)
    write_task(task, scene, layout)
    mesh, texels = cover(scene, layout)
    candidates = np.flatnonzero(inner_texels(scene.materials, mesh, texels))
    if len(candidates) == 0:
        raise SystemExit(f"{arguments.scene} has no texel that can be compared at this resolution")
    size = min(arguments.texels, len(candidates))
    chosen = np.sort(np.random.default_rng(0).choice(candidates, size, replace=False))
    halves = [_reference_half(arguments, kept, task, chosen, seed) for seed in REFERENCE_SEEDS]
    # Of a texel that another surface cuts, a part lies inside something: see the top of this file.
    clear = halves[0]["clear"]
    setting = Setting(kept, task, arguments.threads, texels.pixel[chosen[clear]], len(texels.pixel))
    reference = Reference(*(half["values"][clear] for half in halves))
    print(
        f"{arguments.scene}: {scene.n_triangles} triangles, {len(texels.pixel)} texels,"
        f" {clear.sum()} compared; reference noise {reference.relative_rmse:.3%}",
        flush=True,
    )
    return setting, reference


def _reference_half(
    arguments: argparse.Namespace, scene: Path, task: Path, chosen: np.ndarray, seed: int
) -> dict[str, np.ndarray]:
    """``values`` and ``clear`` of a long ``path`` bake of the chosen texels."""
    key = sha256_bytes(task.read_bytes(), chosen.tobytes(), _tracer_source())[:16]
    kept = KEPT / f"path-{key}-{arguments.reference_samples}-{seed}.npz"
    if not kept.exists():
        values, clear = trace_reference(
            scene, chosen, arguments.reference_samples, seed=seed, threads=available_threads()
        )
        KEPT.mkdir(parents=True, exist_ok=True)
        np.savez(kept, values=values, clear=clear)
    with np.load(kept) as file:
        return dict(file)


def _tracer_source() -> bytes:
    """All that could change a reference."""
    files = sorted(f for part in ("transport", "bake") for f in (ROOT / "src/irradia" / part).glob("*.py"))
    return b"".join(file.read_bytes() for file in files)


def compare_converged(setting: Setting, reference: Reference, samples: int) -> list[Agreement]:
    """Bakes each twice with many samples and takes the noise of both sides out."""
    agreements = []
    for name, bake in (("Cycles", setting.cycles), ("Irradia", setting.cached)):
        pair = (bake(samples, 2001)[0], bake(samples, 2002)[0])
        bias = max(relmse_between_means(pair, (reference.first, reference.second)), 0.0) ** 0.5
        agreement = Agreement(name, samples, mean_ratio(0.5 * (pair[0] + pair[1]), reference.mean), bias)
        print(
            f"  {name}: mean ratio {agreement.mean_ratio:.4f}, bias {bias:.2%} of relative RMSE", flush=True
        )
        if abs(agreement.mean_ratio - 1.0) > 0.01:
            raise SystemExit(f"{name} doesn't converge to the reference: nothing to time")
        agreements.append(agreement)
    return agreements


def first_run_overhead(setting: Setting, repeats: int) -> float:
    """Median seconds that Irradia's first bake after an installation takes longer: its kernels."""
    times = []
    for cold in (True, False):
        runs = [
            bake_with_irradia(
                setting.scene,
                1,
                seed=seed,
                threads=setting.threads,
                cold=cold,
            ).bake_s
            for seed in range(repeats)
        ]
        times.append(float(np.median(runs)))
    return times[0] - times[1]


def report(
    arguments: argparse.Namespace,
    setting: Setting,
    reference: Reference,
    curves: dict[str, list[Point]],
    agreement: list[Agreement],
    cold_s: float,
) -> None:
    """Prints the tables and writes them with the plot."""
    name = f"bake_vs_cycles-{arguments.scene.removeprefix('builtin:')}"
    title = f"{arguments.scene}, {setting.n_texels} texels, {setting.threads} threads"
    seeds = " and ".join(map(str, REFERENCE_SEEDS))
    facts = [
        f"Machine: {cpu_name()}, {setting.threads} threads, {platform.system()},"
        f" Python {platform.python_version()}, {peer_version()}",
        f"Commit: {source_commit()}; date: {time.strftime('%Y-%m-%d')}",
        f"Compared: {len(setting.pixel)} texels of a page of {arguments.resolution} × {arguments.resolution}",
        f"Reference: `path`, 2 × {arguments.reference_samples} samples, seeds {seeds}; noise left in it"
        f" {reference.relative_rmse:.3%}",
        f"Runs: {arguments.repeats} for each point, seeds 1 to {arguments.repeats}; medians",
        f"Command: `{shlex.join(['python', 'bench/bake_vs_cycles.py', *sys.argv[1:]])}`",
    ]
    plot_curves(curves, TARGETS, title, RESULTS / f"{name}.svg")
    text = markdown(title, f"{name}.svg", curves, agreement, TARGETS, cold_s, facts)
    (RESULTS / f"{name}.md").write_text(text, encoding="utf-8")
    print(text)


def _parse() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description="Irradia against Blender Cycles: time to a clean lightmap.")
    parser.add_argument("--scene", default="builtin:cornell")
    parser.add_argument("--resolution", type=int, default=512)
    parser.add_argument("--texels", type=int, default=8192, help="how many are compared, chosen at random")
    parser.add_argument("--reference-samples", type=int, default=49152, help="of each of its two halves")
    parser.add_argument("--converged-samples", type=int, default=256)
    parser.add_argument("--threads", type=int, default=available_threads())
    parser.add_argument("--repeats", type=int, default=3)
    parser.add_argument("--limit-s", type=float, default=600.0, help="stop a curve after a bake this long")
    parser.add_argument("--check-only", action="store_true")
    return parser.parse_args()


if __name__ == "__main__":
    main()
