"""One side of the field benchmark: a process that trains and evaluates on request.

Both sides run this loop, so that both are timed alike. Requests and answers are lines of JSON:

=====================================  ====================================================
``{"do": "start"}``                    back to the parameters of the task
``{"do": "step", "n": 5}``             losses and seconds of so many steps
``{"do": "infer", "n": 5}``            seconds of so many evaluations of a batch
``{"do": "outputs", "to": "a.npy"}``   the network's outputs for the first batch
``{"do": "state", "to": "a.npz"}``     parameters, and Adam's first moments as ``first/NAME``
``{"do": "version"}``                  what it is, in words
=====================================  ====================================================

This file needs NumPy only: it runs in the peer's environment too.
"""

from __future__ import annotations

import json
import sys
import time
from abc import ABC, abstractmethod
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np


@dataclass(frozen=True)
class Task:
    """What both sides are given.

    Attributes:
        settings: ``spec`` (architecture), ``batch``, ``loss``, ``rates``, Adam's settings, ``threads``,
            ``device``.
        parameters: By the names that a spec gives them.
        x, normal, target: (B, N, ·) batches; normal is None in SH modes.
    """

    settings: dict[str, Any]
    parameters: dict[str, np.ndarray]
    x: np.ndarray
    normal: np.ndarray | None
    target: np.ndarray

    @property
    def n_batches(self) -> int:
        """How many there are before they come round again."""
        return len(self.x)


def write_task(path: Path, task: Task) -> None:
    """Keeps a task for :func:`read_task`."""
    arrays = {f"parameters/{name}": value for name, value in task.parameters.items()}
    arrays |= {"x": task.x, "target": task.target}
    if task.normal is not None:
        arrays["normal"] = task.normal
    np.savez(path, settings=np.array(json.dumps(task.settings)), **arrays)


def read_task(path: str) -> Task:
    """Reads what :func:`write_task` kept."""
    with np.load(path) as file:
        arrays = {name: file[name] for name in file.files}
    prefix = "parameters/"
    return Task(
        settings=json.loads(str(arrays["settings"])),
        parameters={n.removeprefix(prefix): a for n, a in arrays.items() if n.startswith(prefix)},
        x=arrays["x"],
        normal=arrays.get("normal"),
        target=arrays["target"],
    )


class Side(ABC):
    """What is compared: something that trains the task's field."""

    @abstractmethod
    def start(self) -> None:
        """Goes back to the task's parameters, moments at zero."""

    @abstractmethod
    def step(self, batch: int) -> float:
        """One whole training step on a batch; the loss before it, on the host."""

    @abstractmethod
    def infer(self, batch: int) -> np.ndarray:
        """Outputs (N, n_outputs) after the head, on the host."""

    @abstractmethod
    def state(self) -> dict[str, np.ndarray]:
        """Parameters by name, and ``first/NAME`` for Adam's first moments."""

    @abstractmethod
    def version(self) -> str:
        """What it is, for the table's foot."""


def serve(side: Side, n_batches: int) -> None:
    """Answers requests from standard input until it ends."""
    side.start()
    batch = 0
    for line in sys.stdin:
        request = json.loads(line)
        match request["do"]:
            case "start":
                side.start()
                batch, answer = 0, {}
            case "step":
                losses, seconds = [], []
                for _ in range(request["n"]):
                    begin = time.perf_counter()
                    losses.append(side.step(batch))
                    seconds.append(time.perf_counter() - begin)
                    batch = (batch + 1) % n_batches
                answer = {"losses": losses, "seconds": seconds}
            case "infer":
                answer = {"seconds": [_timed(side, i % n_batches) for i in range(request["n"])]}
            case "outputs":
                np.save(request["to"], side.infer(0))
                answer = {}
            case "state":
                np.savez(request["to"], **side.state())
                answer = {}
            case "version":
                answer = {"version": side.version()}
            case unknown:
                raise SystemExit(f"unknown request {unknown!r}")
        print(json.dumps(answer), flush=True)


def _timed(side: Side, batch: int) -> float:
    begin = time.perf_counter()
    side.infer(batch)
    return time.perf_counter() - begin
