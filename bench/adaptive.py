"""Does spreading rays by noise pay, and does it stay honest?

    python bench/adaptive.py [--scene builtin:atrium builtin:lights] [--resolution 1024] [--time 20]
                             [--reference-samples 512] [--repeats 3]

Bakes with uniform and with adaptive sampling in turn, for the same seconds of tracing, undenoised, in
one process that has compiled its kernels before. Errors are against two long uniform bakes with seeds of
their own, whose noise is taken out (irradia.metrics.unbiased); the means of all texels show whether
choosing by noise has shifted the light. References and comparisons are kept (out/bench), so that the
benchmark can be stopped and taken up. Results go to ``bench/results/adaptive.md``.
"""

from __future__ import annotations

import argparse
import functools
import platform
import shlex
import sys
import time
from dataclasses import dataclass
from pathlib import Path
from statistics import median

sys.path.insert(0, str(Path(__file__).parent))

import numpy as np
from numpy.typing import NDArray

from irradia.bake.lightmap import BakeOptions, LightmapResult, bake_lightmap
from irradia.core import write_text_atomic
from irradia.core.device import cpu_name
from irradia.core.provenance import source_commit
from irradia.metrics.unbiased import relmse_without_reference_noise
from irradia.scene.layout import LightmapLayout
from irradia.scene.types import Scene
from support.bench_scene import load_bench_scene
from support.kept import Kept

RESULT = Path(__file__).parent / "results" / "adaptive.md"
REFERENCE_SEEDS = (1001, 1002)
MAX_MEAN_ERROR = 0.003

Light = NDArray[np.float64]
Values = dict[str, float]


@dataclass(frozen=True)
class Errors:
    """One way of sampling, a value for each repeat.

    Attributes:
        samples: Per texel, on average.
        mse, relmse: Against the truth behind the references.
        mean_ratio: Of all texels' light to the references'.
    """

    samples: list[float]
    mse: list[float]
    relmse: list[float]
    mean_ratio: list[float]


def main() -> None:
    """Measures, prints and writes the table."""
    arguments = _parse()
    rows, shifted = [], []
    for spec in arguments.scene:
        uniform, adaptive, truth_gap = _measure(spec, arguments)
        rows.append(_row(spec, uniform, adaptive, truth_gap))
        print(rows[-1], file=sys.stderr, flush=True)
        if abs(median(adaptive.mean_ratio) - median(uniform.mean_ratio)) > MAX_MEAN_ERROR:
            shifted.append(spec)
    text = "\n".join([*_head(arguments), *rows, "", *_facts(), ""])
    write_text_atomic(RESULT, text)
    print(text)
    if shifted:
        raise SystemExit(f"adaptive sampling shifted the light of {', '.join(shifted)}")


def _measure(spec: str, arguments: argparse.Namespace) -> tuple[Errors, Errors, float]:
    """Errors of uniform and adaptive bakes, and how far apart the references' means are."""
    scene, layout = load_bench_scene(spec, arguments.resolution)
    settings = {"scene": spec, "resolution": arguments.resolution, "references": arguments.reference_samples}
    steps = Kept("adaptive", settings)

    def reference(seed: int) -> dict[str, Light]:
        options = BakeOptions(arguments.reference_samples, denoise=False, seed=seed)
        return {"light": _light(_bake(scene, layout, options))}

    references = tuple(
        steps.arrays(f"reference {seed}", functools.partial(reference, seed))["light"]
        for seed in REFERENCE_SEEDS
    )

    def pair(repeat: int) -> list[Values]:
        _compile(scene, layout)
        both = (
            BakeOptions(None, arguments.time, adaptive=a, seed=repeat, denoise=False) for a in (False, True)
        )
        return [_compare(_bake(scene, layout, options), references) for options in both]

    found = [Errors([], [], [], []), Errors([], [], [], [])]
    for repeat in range(arguments.repeats):
        values = steps.value(f"pair of {arguments.time} s, {repeat}", functools.partial(pair, repeat))
        for errors, each in zip(found, values, strict=True):
            for name, value in each.items():
                getattr(errors, name).append(value)
    gap = float(references[0].mean() / references[1].mean() - 1.0)
    return found[0], found[1], gap


def _compile(scene: Scene, layout: LightmapLayout) -> None:
    """Compiles the kernels of both ways, so that neither pays for it in its time."""
    for adaptive in (False, True):
        _bake(scene, layout, BakeOptions(8, denoise=False, adaptive=adaptive))


def _bake(scene: Scene, layout: LightmapLayout, options: BakeOptions) -> LightmapResult:
    return bake_lightmap(scene, layout, options)


def _light(result: LightmapResult) -> Light:
    """(N, 3) of the valid texels, as traced."""
    return result.irradiance_over_pi[result.valid].astype(np.float64)


def _compare(result: LightmapResult, references: tuple[Light, ...]) -> Values:
    """What :class:`Errors` lists of one bake."""
    (first, second), light = references, _light(result)
    return {
        "samples": result.stats["samples_per_texel"],
        "mse": float(np.mean((light - first) * (light - second))),
        "relmse": relmse_without_reference_noise(light, first, second),
        "mean_ratio": float(2.0 * light.mean() / (first + second).mean()),
    }


def _row(spec: str, uniform: Errors, adaptive: Errors, gap: float) -> str:
    def ratio(a: list[float], b: list[float]) -> str:
        each = [x / y for x, y in zip(a, b, strict=True)]
        return f"**{median(each):.2f}×** ({min(each):.2f} – {max(each):.2f})"

    return (
        f"| {spec} | {median(uniform.samples):.0f} / {median(adaptive.samples):.0f} "
        f"| {ratio(uniform.mse, adaptive.mse)} | {ratio(uniform.relmse, adaptive.relmse)} "
        f"| {median(uniform.mean_ratio):.5f} / {median(adaptive.mean_ratio):.5f} | {abs(gap):.1e} |"
    )


def _head(arguments: argparse.Namespace) -> list[str]:
    return [
        "# Adaptive against uniform sampling at equal time",
        "",
        f"{arguments.time:.0f} s of tracing each, pages of {arguments.resolution}², undenoised; references",
        f"of 2 × {arguments.reference_samples} samples a texel, their noise taken out. Ratios are uniform",
        "over adaptive, so above 1 adaptive is better: median of pairs run in turn, lowest and highest.",
        "",
        "| scene | samples a texel, uniform / adaptive | MSE ratio | relMSE ratio"
        " | mean over the references', uniform / adaptive | references' means differ by |",
        "|---|---|---|---|---|---|",
    ]


def _facts() -> list[str]:
    return [
        f"- Machine: {cpu_name()}, {platform.system()}, Python {platform.python_version()}",
        f"- Commit: {source_commit()}; date: {time.strftime('%Y-%m-%d')}",
        f"- Command: `{shlex.join(['python', 'bench/adaptive.py', *sys.argv[1:]])}`",
    ]


def _parse() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--scene", nargs="+", default=["builtin:atrium", "builtin:lights"])
    parser.add_argument("--resolution", type=int, default=1024)
    parser.add_argument("--time", type=float, default=20.0, help="seconds of tracing of each bake")
    parser.add_argument("--reference-samples", type=int, default=512)
    parser.add_argument("--repeats", type=int, default=3)
    return parser.parse_args()


if __name__ == "__main__":
    main()
