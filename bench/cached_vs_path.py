"""Does the cached gather converge to what the unbiased path tracer converges to?

    python bench/cached_vs_path.py [--scene SCENE ...] [--resolution 256] [--samples N] [--path-samples N]

For each scene: the mean ratio over growing sample counts, and the relMSE between the two methods'
truths. Two bakes of each method with different seeds let the noise of all four be taken out
(irradia.metrics.relmse_between_means), so what is left is the bias. Nothing is timed here.
"""

from __future__ import annotations

import argparse
import sys
from dataclasses import dataclass
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))

import numpy as np
from numpy.typing import NDArray

from irradia.bake.lightmap import BakeOptions, bake_lightmap
from irradia.core import Progress, write_text_atomic
from irradia.core.progress import stderr_progress
from irradia.core.provenance import source_commit
from irradia.metrics import relmse_between_means
from irradia.scene.layout import LightmapLayout
from irradia.scene.types import Scene
from support.bench_scene import load_bench_scene

SCENES = ("builtin:cornell", "builtin:foliage", "builtin:atrium")
RESULTS = Path(__file__).parent / "results"


@dataclass(frozen=True)
class Outcome:
    """One scene.

    Attributes:
        ratios: Mean of the cached bake over the path tracer's, by samples per texel.
        relmse: Between the truths of both, noise removed.
        worst: 99th percentile over texels of what is left after averaging both pairs, in percent of
            the map's mean; holds noise, so it is an upper bound.
    """

    scene: str
    texels: int
    ratios: dict[int, float]
    relmse: float
    worst: float


def main() -> None:
    """Measures, prints and writes the table and the plot."""
    arguments = _parse()
    outcomes = [_measure(spec, arguments, stderr_progress()) for spec in arguments.scene]
    _plot(outcomes, RESULTS / "cached_vs_path.svg")
    text = _markdown(outcomes, arguments)
    write_text_atomic(RESULTS / "cached_vs_path.md", text)
    print(text)


def _parse() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--scene", nargs="+", default=SCENES)
    parser.add_argument("--resolution", type=int, default=256, help="page edge in texels")
    parser.add_argument("--samples", type=int, default=1024, help="of the converged cached bakes")
    parser.add_argument("--path-samples", type=int, default=4096, help="of the path-traced bakes")
    return parser.parse_args()


def _measure(spec: str, arguments: argparse.Namespace, progress: Progress) -> Outcome:
    scene, layout = load_bench_scene(spec, arguments.resolution)
    progress.say(f"== {spec}")
    paths = [_bake(scene, layout, "path", arguments.path_samples, seed, progress) for seed in (1, 2)]
    cached = [_bake(scene, layout, "cached", arguments.samples, seed, progress) for seed in (3, 4)]
    truth = 0.5 * (paths[0] + paths[1])
    ratios = {}
    samples = 4
    while samples < arguments.samples:
        ratios[samples] = _ratio(_bake(scene, layout, "cached", samples, 5, progress), truth)
        samples *= 4
    converged = 0.5 * (cached[0] + cached[1])
    ratios[arguments.samples] = _ratio(converged, truth)
    rest = np.abs(converged - truth).mean(axis=-1) / truth.mean()
    return Outcome(
        scene=spec,
        texels=len(truth),
        ratios=ratios,
        relmse=relmse_between_means((cached[0], cached[1]), (paths[0], paths[1])),
        worst=100.0 * float(np.percentile(rest, 99)),
    )


def _bake(
    scene: Scene, layout: LightmapLayout, integrator: str, samples: int, seed: int, progress: Progress
) -> NDArray[np.float64]:
    """E/π of valid texels, (N, 3), as traced."""
    progress.say(f"{integrator}, {samples} samples, seed {seed}")
    options = BakeOptions(samples=samples, integrator=integrator, seed=seed, denoise=False)  # type: ignore[arg-type]
    result = bake_lightmap(scene, layout, options, progress)
    return result.irradiance_over_pi[result.valid].astype(np.float64)


def _ratio(test: NDArray[np.float64], truth: NDArray[np.float64]) -> float:
    return float(test.mean() / truth.mean())


def _plot(outcomes: list[Outcome], path: Path) -> None:
    import matplotlib as mpl

    mpl.use("svg")
    mpl.rcParams["svg.hashsalt"] = "irradia"
    from matplotlib import pyplot as plt

    figure, axes = plt.subplots(figsize=(6.4, 3.4))
    axes.axhspan(-1, 1, color="#eeeeee", zorder=0)
    for outcome in outcomes:
        deviation = [100.0 * (ratio - 1.0) for ratio in outcome.ratios.values()]
        axes.plot(list(outcome.ratios), deviation, marker="o", markersize=3, label=outcome.scene)
    axes.set(xscale="log", xlabel="samples per texel", ylabel="mean against path, %", ylim=(-3, 3))
    axes.legend(frameon=False)
    figure.tight_layout()
    path.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(path, metadata={"Date": None})
    plt.close(figure)


def _markdown(outcomes: list[Outcome], arguments: argparse.Namespace) -> str:
    counts = sorted({count for outcome in outcomes for count in outcome.ratios})
    head = "| scene | texels | relMSE, noise removed | " + " | ".join(f"mean ratio at {c}" for c in counts)
    rows = [
        f"| {o.scene} | {o.texels:,} | {o.relmse:.1e} | "
        + " | ".join(f"{o.ratios[c]:.4f}" if c in o.ratios else "–" for c in counts)
        + f" | {o.worst:.1f} % |"
        for o in outcomes
    ]
    commit = source_commit() or "unknown"
    lines = [
        "# The cached gather against the path tracer",
        "",
        f"{head} | 99 % of texels within |",
        "|" + "---|" * (len(counts) + 4),
        *rows,
        "",
        "![mean ratio over samples](cached_vs_path.svg)",
        "",
        "The last column is of the map's mean and still holds both sides' noise.",
        "",
        f"`python bench/cached_vs_path.py --resolution {arguments.resolution} --samples {arguments.samples} "
        f"--path-samples {arguments.path_samples}`, commit {commit}, seeds 1 to 5.",
        "",
    ]
    return "\n".join(lines)


if __name__ == "__main__":
    main()
