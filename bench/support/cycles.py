"""Runs the peer Blender Cycles in an environment of its own."""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path

import numpy as np

PEERS = Path(__file__).resolve().parents[1] / "peers"
ENVIRONMENT = PEERS / "cycles" / ".venv"
PYTHON_VARIABLE = "IRRADIA_BENCH_BPY_PYTHON"  # a Python that has bpy, to use instead of ours


@dataclass(frozen=True)
class CyclesBake:
    """One bake.

    Attributes:
        pages: (P, H, W, 3) E/π, row 0 at the top.
        bake_s: Wall time of the bake operator: sync, BVH, tracing, read-back.
        setup_s: Wall time of starting Blender and building its scene.
    """

    pages: np.ndarray
    bake_s: float
    setup_s: float


def peer_version() -> str:
    """What the peer calls itself."""
    command = [str(peer_python()), "-c", "import bpy; print(bpy.app.version_string)"]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    return f"Blender {done.stdout.split()[-1]}"


def peer_python() -> Path:
    """The peer's interpreter; made on the first call, which downloads Blender (370 MB).

    Raises:
        SystemExit: This Python is not the version that the peer's wheel is for.
    """
    if PYTHON_VARIABLE in os.environ:
        return Path(os.environ[PYTHON_VARIABLE])
    python = ENVIRONMENT / ("Scripts/python.exe" if os.name == "nt" else "bin/python")
    if python.exists():
        return python
    if sys.version_info[:2] != (3, 11):
        raise SystemExit(f"bpy needs Python 3.11: set {PYTHON_VARIABLE} to one that has it")
    subprocess.run([sys.executable, "-m", "venv", str(ENVIRONMENT)], check=True)
    requirements = PEERS / "cycles" / "requirements.txt"
    subprocess.run([str(python), "-m", "pip", "install", "-q", "-r", str(requirements)], check=True)
    return python


def bake_with_cycles(task: Path, samples: int, *, seed: int, threads: int) -> CyclesBake:
    """Bakes a task in a fresh process, so that every figure includes what a user waits for."""
    with tempfile.TemporaryDirectory() as folder:
        result = Path(folder) / "result.npz"
        command = [str(peer_python()), str(PEERS / "cycles_bake.py"), str(task), str(result)]
        command += ["--samples", str(samples), "--threads", str(threads), "--seed", str(seed)]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        if done.returncode != 0 or not result.exists():
            raise SystemExit(f"Cycles failed:\n{done.stdout[-2000:]}\n{done.stderr[-4000:]}")
        with np.load(result) as file:
            return CyclesBake(
                pages=file["pages"],
                bake_s=float(file["bake_s"]),
                setup_s=float(file["setup_s"]),
            )
