"""Path-traces a few texels of a kept scene very long: the reference, in a process of its own.

    python -m support.reference_bake SCENE.pickle CHOSEN.npy RESULT.npz --samples 49152 ...

CHOSEN.npy lists texels by their place among the covered ones. RESULT.npz holds their
``irradiance_over_pi`` (M, 3), and ``clear`` (M,): which of them have no part inside something. The
error of a map is as well known from ten thousand of its texels as from all, at a fraction of the cost.
"""

from __future__ import annotations

import argparse
from dataclasses import replace
from pathlib import Path

import numpy as np

from irradia.bake.epochs import EpochPlan, run_epochs
from irradia.bake.lightmap import BakeOptions, cover, prepare
from irradia.core import Seed, silent_progress
from irradia.transport import use_device
from support.bench_scene import read_bench_scene


def main() -> None:
    """Reads, traces, writes."""
    arguments = _parse()
    use_device("cpu", arguments.threads)
    scene, layout = read_bench_scene(arguments.scene)
    mesh, texels = cover(scene, layout)
    chosen = np.load(arguments.chosen)
    texels = replace(
        texels,
        pixel=texels.pixel[chosen],
        triangle=texels.triangle[chosen],
        barycentric=texels.barycentric[chosen],
        coverage=texels.coverage[chosen],
        chart=texels.chart[chosen],
    )
    options = BakeOptions(samples=arguments.samples, integrator="path", seed=arguments.seed, denoise=False)
    light = prepare(scene, mesh, layout, texels, options)
    clear = light.drop_hidden_subsamples() == 0.0
    plan = EpochPlan.for_options(options.samples, cached=False)
    values, _, _ = run_epochs(light, plan, options.n_direct, Seed(options.seed), silent_progress())
    np.savez(arguments.result, irradiance_over_pi=values, clear=clear)


def _parse() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description="Path-traces a few texels of a kept scene.")
    for name in ("scene", "chosen", "result"):
        parser.add_argument(name, type=Path)
    parser.add_argument("--samples", type=int, required=True)
    parser.add_argument("--threads", type=int, required=True)
    parser.add_argument("--seed", type=int, required=True)
    return parser.parse_args()


if __name__ == "__main__":
    main()
