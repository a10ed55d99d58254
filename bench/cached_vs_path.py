"""Does the cached gather converge to what the unbiased path tracer converges to?

    python bench/cached_vs_path.py                            cornell, foliage and the atrium
    python bench/cached_vs_path.py --scene builtin:atrium     one of them

The cached gather bakes all texels. The path tracer, which is slower by an order of magnitude, traces a
random choice of those that don't lie partly inside something. Two bakes of each method with seeds of their
own let the noise of all four be taken out (irradia.metrics.relmse_between_means): what is left is the bias,
known as well as its standard error says. Where that is near the limit, compare more texels. Nothing is
timed here.

Every bake is kept as soon as it is done (out/bench), so that the benchmark can be stopped and taken up.
Results go to ``bench/results/cached_vs_path-SCENE.md`` and ``.svg``.
"""

from __future__ import annotations

import argparse
import functools
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))

import numpy as np

from irradia.bake.setup import cover
from irradia.core import write_text_atomic
from irradia.core.device import available_threads
from irradia.core.provenance import source_commit
from irradia.metrics import mean_ratio, relmse_between_means
from irradia.metrics.pixelwise import EPSILON, reference_mean
from support.bench_scene import load_bench_scene, save_bench_scene
from support.irradia import bake_with_irradia, trace_reference
from support.kept import Kept

RESULTS = Path(__file__).parent / "results"
PAGES_PX = {"builtin:cornell": 256, "builtin:foliage": 512, "builtin:atrium": 1024}
PATH_SEEDS, CACHED_SEEDS, CURVE_SEED = (1001, 1002), (1, 2), 3
MAX_RATIO_ERROR, MAX_RELMSE = 0.01, 1e-3
N_WORST, MIN_TEXELS, N_DRAWS = 3, 20, 200
RARE = 1e-3


@dataclass(frozen=True)
class Outcome:
    """One scene.

    Attributes:
        n_texels, n_compared: How many are baked, and how many of them compared.
        ratios: Mean of the cached bake over the path tracer's, by samples per texel.
        relmse: Between the truths of both, and the standard error of that.
        rare: How much of it one texel in a thousand makes.
        path_noise: relMSE of the mean of both path-traced maps: what is taken out.
        worst: Objects with the highest relMSE, that, and its standard error.
    """

    scene: str
    resolution: int
    n_texels: int
    n_compared: int
    ratios: dict[int, float]
    relmse: tuple[float, float]
    rare: float
    path_noise: float
    worst: tuple[tuple[str, float, float], ...]

    @property
    def passed(self) -> bool:
        """Whether both limits hold."""
        return abs(list(self.ratios.values())[-1] - 1.0) < MAX_RATIO_ERROR and self.relmse[0] < MAX_RELMSE


def main() -> None:
    """Measures, prints and writes a page and a plot for each scene."""
    arguments = _parse()
    failed = []
    for spec in arguments.scene:
        with tempfile.TemporaryDirectory() as folder:
            outcome = _measure(spec, arguments, Path(folder) / "scene.pickle")
        name = f"cached_vs_path-{spec.removeprefix('builtin:')}"
        _plot(outcome, RESULTS / f"{name}.svg")
        text = _markdown(outcome, arguments, f"{name}.svg")
        write_text_atomic(RESULTS / f"{name}.md", text)
        print(text, flush=True)
        failed += [] if outcome.passed else [spec]
    if failed:
        raise SystemExit(f"biased beyond the limits: {', '.join(failed)}")


def _parse() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--scene", nargs="+", default=list(PAGES_PX))
    parser.add_argument("--resolution", type=int, help="page edge in texels; as suits the scene by default")
    parser.add_argument("--texels", type=int, default=4000, help="that are compared")
    parser.add_argument("--samples", type=int, default=256, help="of the converged cached bakes")
    parser.add_argument("--path-samples", type=int, default=4096, help="of the path-traced texels")
    parser.add_argument("--threads", type=int, default=available_threads())
    return parser.parse_args()


def _measure(spec: str, arguments: argparse.Namespace, kept: Path) -> Outcome:
    resolution = arguments.resolution or PAGES_PX.get(spec, 512)
    scene, layout = load_bench_scene(spec, resolution)
    save_bench_scene(kept, scene, layout)
    mesh, texels = cover(scene, layout)
    n = len(texels.pixel)
    steps = Kept("cached_vs_path", {"scene": spec, "resolution": resolution, "threads": arguments.threads})

    def cached(samples: int, seed: int) -> dict[str, np.ndarray]:
        def bake() -> dict[str, np.ndarray]:
            _say(f"{spec}: cached, {samples} samples on {n} texels")
            baked = bake_with_irradia(kept, samples, seed=seed, threads=arguments.threads)
            return {"light": baked.pages.reshape(-1, 3)[texels.pixel], "clear": baked.clear}

        return steps.arrays(f"cached {samples} {seed}", bake)

    counts = [1 << k for k in range(2, 20, 2) if 1 << k < arguments.samples]
    clear = np.flatnonzero(cached(counts[0], CURVE_SEED)["clear"])
    n_chosen = min(arguments.texels, len(clear))
    chosen = np.sort(np.random.default_rng(1).choice(clear, n_chosen, replace=False))

    def path(seed: int) -> dict[str, np.ndarray]:
        _say(f"{spec}: path, {arguments.path_samples} samples on {n_chosen} texels")
        light, _ = trace_reference(kept, chosen, arguments.path_samples, seed=seed, threads=arguments.threads)
        return {"light": light}

    paths = [
        steps.arrays(f"path {arguments.path_samples} {n_chosen} {seed}", functools.partial(path, seed))[
            "light"
        ]
        for seed in PATH_SEEDS
    ]
    paths = [light.astype(np.float64) for light in paths]
    truth = 0.5 * (paths[0] + paths[1])

    def at_chosen(samples: int, seed: int) -> np.ndarray:
        return cached(samples, seed)["light"][chosen].astype(np.float64)

    ratios = {count: mean_ratio(at_chosen(count, CURVE_SEED), truth) for count in counts}
    converged = [at_chosen(arguments.samples, seed) for seed in CACHED_SEEDS]
    ratios[arguments.samples] = mean_ratio(0.5 * (converged[0] + converged[1]), truth)
    names = np.array([instance.name or f"instance {i}" for i, instance in enumerate(scene.instances)])
    return Outcome(
        scene=spec,
        resolution=resolution,
        n_texels=n,
        n_compared=n_chosen,
        ratios=ratios,
        relmse=_bias(converged, paths),
        rare=_of_rare_texels(converged, paths),
        path_noise=float(np.mean((paths[0] - paths[1]) ** 2 / (truth**2 + 0.01 * truth.mean() ** 2)) / 4),
        worst=_worst(names[mesh.instance[texels.triangle[chosen]]], converged, paths),
    )


def _worst(
    names: np.ndarray, converged: list[np.ndarray], paths: list[np.ndarray]
) -> tuple[tuple[str, float, float], ...]:
    """The objects that differ most, each by the relMSE of its own texels, and its standard error."""
    found = []
    for name in np.unique(names):
        here = names == name
        if here.sum() >= MIN_TEXELS:
            own = ([each[here] for each in pair] for pair in (converged, paths))
            found.append((str(name), *_bias(*own)))
    return tuple(sorted(found, key=lambda item: -item[1])[:N_WORST])


def _bias(converged: list[np.ndarray], paths: list[np.ndarray]) -> tuple[float, float]:
    """The relMSE between the truths of both, and its standard error, found by drawing the texels anew."""
    rng, n = np.random.default_rng(2), len(paths[0])

    def measure(texels: np.ndarray) -> float:
        first, second = ((pair[0][texels], pair[1][texels]) for pair in (converged, paths))
        return relmse_between_means(first, second)

    return measure(np.arange(n)), float(np.std([measure(rng.integers(0, n, n)) for _ in range(N_DRAWS)]))


def _of_rare_texels(converged: list[np.ndarray], paths: list[np.ndarray]) -> float:
    """What the worst texels add to the relMSE, one in a thousand."""
    error = (converged[0] - paths[0]) * (converged[1] - paths[1])
    mean = 0.5 * (paths[0] + paths[1])
    relative = np.mean(error / (mean**2 + EPSILON * reference_mean(mean) ** 2), axis=1)
    n_worst = max(1, round(RARE * len(relative)))
    return float(np.sort(relative)[-n_worst:].sum() / len(relative))


def _say(text: str) -> None:
    print(text, file=sys.stderr, flush=True)


def _plot(outcome: Outcome, path: Path) -> None:
    import matplotlib as mpl

    mpl.use("svg")
    mpl.rcParams.update({"svg.hashsalt": "irradia", "svg.fonttype": "none"})
    from matplotlib import pyplot as plt

    figure, axes = plt.subplots(figsize=(6.4, 3.2))
    limit = 100.0 * MAX_RATIO_ERROR
    axes.axhspan(-limit, limit, color="#eeeeee", zorder=0)
    deviation = [100.0 * (ratio - 1.0) for ratio in outcome.ratios.values()]
    axes.plot(list(outcome.ratios), deviation, marker="o", markersize=3, color="#2471a3")
    reach = max(1.5 * limit, 1.1 * max(map(abs, deviation)))
    axes.set(xscale="log", xlabel="samples per texel", ylabel="mean against path, %", ylim=(-reach, reach))
    axes.set_xticks(list(outcome.ratios), [str(count) for count in outcome.ratios])
    axes.minorticks_off()
    axes.set_title(f"{outcome.scene}, {outcome.resolution}²", fontsize=10)
    figure.tight_layout()
    path.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(path, metadata={"Date": None})
    plt.close(figure)


def _markdown(outcome: Outcome, arguments: argparse.Namespace, plot: str) -> str:
    o = outcome
    lines = [
        f"# The cached gather against the path tracer: {o.scene}",
        "",
        f"{o.n_texels:,} texels on a page of {o.resolution}², {o.n_compared:,} of them compared, undenoised.",
        "",
        "| | measured | limit |",
        "|---|---|---|",
        f"| mean ratio, {arguments.samples} samples | {list(o.ratios.values())[-1]:.4f} "
        f"| 1 ± {MAX_RATIO_ERROR} |",
        f"| relMSE, the noise of both sides removed | {o.relmse[0]:.1e} ± {o.relmse[1]:.1e} "
        f"| {MAX_RELMSE:.0e} |",
        f"| of it, by the worst texel in a thousand | {o.rare:.1e} | |",
        f"| relMSE of the path tracer's noise, {2 * arguments.path_samples} samples | {o.path_noise:.1e} | |",
        "",
        "| samples per texel | " + " | ".join(map(str, o.ratios)) + " |",
        "|---" * (len(o.ratios) + 1) + "|",
        "| mean ratio | " + " | ".join(f"{ratio:.4f}" for ratio in o.ratios.values()) + " |",
        "",
        f"![mean ratio over samples]({plot})",
        "",
        f"Objects of at least {MIN_TEXELS} compared texels that differ most, by relMSE: "
        + ", ".join(f"{name} {relmse:.1e} ± {error:.1e}" for name, relmse, error in o.worst)
        + ". A gather ray reads the texel that it meets, unfiltered, where light changes within one, "
        "as in gaps narrower than a texel.",
        "",
        f"`python bench/cached_vs_path.py --scene {o.scene} --resolution {o.resolution} --texels "
        f"{arguments.texels} --samples {arguments.samples} --path-samples {arguments.path_samples}`, "
        f"commit {source_commit() or 'unknown'}, seeds {PATH_SEEDS}, {CACHED_SEEDS} and {CURVE_SEED}.",
        "",
    ]
    return "\n".join(lines)


if __name__ == "__main__":
    main()
