"""Bakes a kept scene with Irradia in a fresh process, as ``cycles_bake.py`` does with Cycles.

    python -m support.irradia_bake SCENE.pickle RESULT.npz --samples 64 ...

RESULT.npz holds ``pages`` (P, H, W, 3), E/π as traced, ``clear`` (N,), which texels have no part inside
something, and the same times: ``bake_s`` from scene and layout in memory to the finished map (texels, BVH,
kernels, tracing), ``setup_s`` before that.
"""

from __future__ import annotations

import argparse
import time
from pathlib import Path

_START = time.perf_counter()

import numpy as np  # noqa: E402

from irradia.bake.lightmap import BakeOptions, bake_lightmap  # noqa: E402
from irradia.transport import use_device  # noqa: E402


def main() -> None:
    """Reads, bakes, writes."""
    arguments = _parse()
    use_device("cpu", arguments.threads)
    # Loads libraries, as importing bpy does for the peer; compiling kernels is part of the bake.
    import irradia.bake.rasterise
    import irradia.transport.texel_light  # noqa: F401
    from support.bench_scene import read_bench_scene

    scene, layout = read_bench_scene(arguments.scene)
    options = BakeOptions(samples=arguments.samples, seed=arguments.seed, denoise=False)
    setup_s = time.perf_counter() - _START
    start = time.perf_counter()
    result = bake_lightmap(scene, layout, options)
    bake_s = time.perf_counter() - start
    np.savez(
        arguments.result,
        pages=result.raw_pages,
        clear=result.hidden_share == 0.0,
        bake_s=bake_s,
        setup_s=setup_s,
        tracing_s=result.stats["tracing_seconds"],
    )


def _parse() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description="Bakes a kept scene with Irradia.")
    parser.add_argument("scene", type=Path)
    parser.add_argument("result")
    parser.add_argument("--samples", type=int, required=True)
    parser.add_argument("--threads", type=int, required=True)
    parser.add_argument("--seed", type=int, required=True)
    return parser.parse_args()


if __name__ == "__main__":
    main()
