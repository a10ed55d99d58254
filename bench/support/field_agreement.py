"""Do both sides of the field benchmark compute the same thing?"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from support.field_sides import Worker

OUTPUT_TOLERANCE = 1e-4
GRADIENT_TOLERANCE = 2e-3  # sines of 2⁹ π x in floats, as PyTorch takes them, are up to 1e-4 off
LOSS_TOLERANCE = 1e-3
N_STEPS = 5


@dataclass(frozen=True)
class Agreement:
    """How far apart two sides are that start alike; each relative, by root mean squares.

    Attributes:
        outputs: Of the network before training.
        gradients: Of the worst array of parameters, from Adam's first moments after one step.
        loss: The greatest over the first steps.
    """

    outputs: float
    gradients: float
    loss: float

    @property
    def good(self) -> bool:
        """Whether it is worth while to time them."""
        return (
            self.outputs < OUTPUT_TOLERANCE
            and self.gradients < GRADIENT_TOLERANCE
            and self.loss < LOSS_TOLERANCE
        )


def compare(first: Worker, second: Worker) -> Agreement:
    """Runs both for a few steps from the task's parameters, and sets both back to them."""
    workers = (first, second)
    for worker in workers:
        worker.ask("start")
    outputs = [worker.outputs() for worker in workers]
    losses = [worker.ask("step", n=1)["losses"] for worker in workers]
    states = [worker.state() for worker in workers]
    losses = [
        a + worker.ask("step", n=N_STEPS - 1)["losses"] for a, worker in zip(losses, workers, strict=True)
    ]
    for worker in workers:
        worker.ask("start")
    moments = [name for name in states[0] if name.startswith("first/")]
    return Agreement(
        outputs=relative_error(*outputs),
        gradients=max(relative_error(states[0][name], states[1][name]) for name in moments),
        loss=max(abs(a - b) / abs(b) for a, b in zip(*losses, strict=True)),
    )


def relative_error(a: np.ndarray, b: np.ndarray) -> float:
    """RMS of the difference over RMS of the second."""
    a, b = a.astype(np.float64), b.astype(np.float64)
    return float(np.sqrt(np.mean((a - b) ** 2) / np.mean(b**2)))
