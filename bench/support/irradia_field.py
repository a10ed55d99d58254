"""Our side of the field benchmark.

python -m support.irradia_field TASK.npz [--backend NAME]    and requests, see peers/field_worker.py
"""

from __future__ import annotations

import argparse

import numpy as np

from irradia.field.backend import AdamOptions, Batch, Rates, StepOptions, TrainState
from irradia.field.backends import backend
from irradia.field.registry import spec_from_dict
from peers.field_worker import Side, Task, read_task, serve


class IrradiaSide(Side):
    """One of our backends in the benchmark."""

    def __init__(self, task: Task, name: str) -> None:
        settings = task.settings
        self.task = task
        self.spec = spec_from_dict(settings["spec"])
        self.backend = backend(name, self.spec, settings["threads"])
        self.options = StepOptions(
            loss=settings["loss"],
            encoding_adam=AdamOptions(**settings["encoding_adam"]),
            network_adam=AdamOptions(**settings["network_adam"]),
            average=settings["average"],
        )
        self.rates = Rates(**settings["rates"])
        self.batches = [
            Batch(task.x[i], None if task.normal is None else task.normal[i], task.target[i])
            for i in range(task.n_batches)
        ]

    def start(self) -> None:
        """Makes stepper and evaluator anew."""
        parameters = self.task.parameters
        zeros = {name: np.zeros_like(value) for name, value in parameters.items()}
        average = zeros if self.options.average else {}
        state = TrainState(parameters, average, zeros, zeros, step=0)
        self.stepper = self.backend.stepper(self.spec, state, self.options)
        self.evaluator = self.backend.evaluator(self.spec, parameters)

    def step(self, batch: int) -> float:
        """One step."""
        return self.stepper.step(self.batches[batch], self.rates)

    def infer(self, batch: int) -> np.ndarray:
        """Outputs of a batch by the task's parameters."""
        return self.evaluator(self.batches[batch].x, self.batches[batch].normal)

    def state(self) -> dict[str, np.ndarray]:
        """Parameters and first moments."""
        state = self.stepper.state()
        return state.parameters | {f"first/{name}": value for name, value in state.first.items()}

    def version(self) -> str:
        """Which backend."""
        return f"Irradia's {self.backend.name}"


def main() -> None:
    """Reads the task and serves."""
    parser = argparse.ArgumentParser()
    parser.add_argument("task")
    parser.add_argument("--backend", default="auto")
    arguments = parser.parse_args()
    task = read_task(arguments.task)
    serve(IrradiaSide(task, arguments.backend), task.n_batches)


if __name__ == "__main__":
    main()
