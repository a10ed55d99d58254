"""Runs Irradia's own bakes, each in a process of its own."""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path

import numpy as np

BENCH = Path(__file__).resolve().parents[1]


@dataclass(frozen=True)
class IrradiaBake:
    """One bake.

    Attributes:
        pages: (P, H, W, 3) E/π as traced, row 0 at the top.
        clear: (N,) which texels have no part inside something.
        bake_s: Wall time from scene and layout in memory to the finished map.
        setup_s: Wall time of starting and reading the scene.
        tracing_s: The part of ``bake_s`` that traced.
    """

    pages: np.ndarray
    clear: np.ndarray
    bake_s: float
    setup_s: float
    tracing_s: float


def bake_with_irradia(
    scene: Path,
    samples: int,
    *,
    seed: int,
    threads: int,
    cold: bool = False,
) -> IrradiaBake:
    """Bakes with the cached gather in a fresh process.

    Args:
        scene: From :func:`support.bench_scene.save_bench_scene`.
        samples: Per texel.
        seed: Root of the random numbers.
        threads: Of the CPU.
        cold: Without the kernels that earlier runs left on disk, as right after an installation.
    """
    with tempfile.TemporaryDirectory() as folder:
        result = Path(folder) / "result.npz"
        command = [sys.executable, "-m", "support.irradia_bake", str(scene), str(result)]
        command += ["--samples", str(samples), "--seed", str(seed)]
        command += ["--threads", str(threads)]
        environment = dict(os.environ)
        if cold:
            # Dr.Jit keeps compiled kernels in the home folder; ours keep to the usual place.
            environment["HOME"] = environment["LOCALAPPDATA"] = folder
            environment["IRRADIA_CACHE"] = str(_cache())
        done = subprocess.run(
            command, capture_output=True, text=True, check=False, cwd=BENCH, env=environment
        )
        if done.returncode != 0:
            raise SystemExit(f"Irradia failed:\n{done.stderr[-4000:]}")
        with np.load(result) as file:
            return IrradiaBake(
                pages=file["pages"],
                clear=file["clear"],
                bake_s=float(file["bake_s"]),
                setup_s=float(file["setup_s"]),
                tracing_s=float(file["tracing_s"]),
            )


def trace_reference(
    scene: Path, chosen: np.ndarray, samples: int, *, seed: int, threads: int
) -> tuple[np.ndarray, np.ndarray]:
    """(M, 3) E/π and (M,) clearness of chosen texels; see :mod:`support.reference_bake`."""
    with tempfile.TemporaryDirectory() as folder:
        places, result = Path(folder) / "chosen.npy", Path(folder) / "result.npz"
        np.save(places, chosen)
        command = [sys.executable, "-m", "support.reference_bake", str(scene), str(places), str(result)]
        command += ["--samples", str(samples), "--threads", str(threads), "--seed", str(seed)]
        _run(command, dict(os.environ))
        with np.load(result) as file:
            return file["irradiance_over_pi"], file["clear"]


def _run(command: list[str], environment: dict[str, str]) -> None:
    done = subprocess.run(command, capture_output=True, text=True, check=False, cwd=BENCH, env=environment)
    if done.returncode != 0:
        raise SystemExit(f"Irradia failed:\n{done.stderr[-4000:]}")


def _cache() -> Path:
    from irradia.core.cache import cache_dir

    return cache_dir()
