"""Path-traces a few texels of a kept scene very long: the reference, in a process of its own.

    python -m support.reference_bake SCENE.pickle CHOSEN.npy RESULT.npz --samples 49152 ...

CHOSEN.npy lists texels by their place among the covered ones. RESULT.npz holds their
``irradiance_over_pi`` (M, 3), and ``clear`` (M,): which of them have no part inside something. The
error of a map is as well known from ten thousand of its texels as from all, at a fraction of the cost.
"""

from __future__ import annotations

import argparse
from pathlib import Path

import numpy as np

from irradia.bake.lightmap import BakeOptions, Selection, start_bake
from irradia.transport import use_device
from support.bench_scene import read_bench_scene


def main() -> None:
    """Reads, traces, writes."""
    arguments = _parse()
    use_device("cpu", arguments.threads)
    scene, layout = read_bench_scene(arguments.scene)
    chosen = np.load(arguments.chosen)
    options = BakeOptions(samples=arguments.samples, integrator="path", seed=arguments.seed, denoise=False)
    bake = start_bake(scene, layout, options, selection=Selection(covered=chosen))
    for _ in bake.passes():
        pass
    values = bake.light.to_host(bake.bake.estimate())[chosen]
    clear = bake.footprints.hidden_share[chosen] == 0.0
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
