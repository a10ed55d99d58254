"""Runs both sides of the field benchmark, each in a process and an environment of its own."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
from contextlib import AbstractContextManager
from pathlib import Path
from typing import Any, Self

import numpy as np

BENCH = Path(__file__).resolve().parents[1]
PEER = BENCH / "peers" / "torch"
PYTHON_VARIABLE = "IRRADIA_BENCH_TORCH_PYTHON"  # a Python that has torch, to use instead of ours


def peer_python() -> Path:
    """The peer's interpreter; made on the first call, which downloads PyTorch."""
    if PYTHON_VARIABLE in os.environ:
        return Path(os.environ[PYTHON_VARIABLE])
    environment = PEER / ".venv"
    python = environment / ("Scripts/python.exe" if os.name == "nt" else "bin/python")
    if not python.exists():
        subprocess.run([sys.executable, "-m", "venv", str(environment)], check=True)
        install = [str(python), "-m", "pip", "install", "-q", "-r", str(PEER / "requirements.txt")]
        subprocess.run(install, check=True)
    return python


class Worker(AbstractContextManager["Worker"]):
    """A side that answers requests; see ``peers/field_worker.py`` for what may be asked."""

    def __init__(self, name: str, command: list[str]) -> None:
        self.name = name
        self._process = subprocess.Popen(
            command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True, cwd=BENCH
        )

    def ask(self, do: str, **details: Any) -> dict[str, Any]:
        """Sends a request and waits for its answer.

        Raises:
            SystemExit: The side ended; what it said stands on standard error.
        """
        if self._process.stdin is None or self._process.stdout is None:
            raise RuntimeError("a worker is asked through pipes")
        try:
            self._process.stdin.write(json.dumps({"do": do, **details}) + "\n")
            self._process.stdin.flush()
        except BrokenPipeError:
            raise SystemExit(f"{self.name} ended before {do!r}") from None
        answer = self._process.stdout.readline()
        if not answer:
            raise SystemExit(f"{self.name} ended at {do!r}")
        return json.loads(answer)

    def outputs(self) -> np.ndarray:
        """Outputs for the first batch."""
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "outputs.npy"
            self.ask("outputs", to=str(path))
            return np.load(path)

    def state(self) -> dict[str, np.ndarray]:
        """Parameters, and first moments as ``first/NAME``."""
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "state.npz"
            self.ask("state", to=str(path))
            with np.load(path) as file:
                return {name: file[name] for name in file.files}

    def __exit__(self, *_: object) -> None:
        """Ends the process."""
        if self._process.stdin is not None:
            self._process.stdin.close()
        if self._process.stdout is not None:
            self._process.stdout.close()
        self._process.wait()

    def __enter__(self) -> Self:
        return self


def torch_worker(task: Path) -> Worker:
    """The peer."""
    return Worker("PyTorch", [str(peer_python()), "-m", "peers.torch_field", str(task)])


def irradia_worker(task: Path, backend: str) -> Worker:
    """Ours."""
    command = [sys.executable, "-m", "support.irradia_field", str(task), "--backend", backend]
    return Worker("Irradia", command)
