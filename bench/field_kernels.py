"""Where does the time of a training step go? Milliseconds of each kernel, and what the machine could do.

    python bench/field_kernels.py                        all four fields of field_training.py
    python bench/field_kernels.py --model hash-16x19 --steps 40 --batch 65536

For tuning, so without a peer: field_training.py compares. Beside each part of a step stands what the machine
would take for it at its limits: multiply-adds in registers for the perceptron, a triad over memory for what
encodings gather, scatter and have swept by Adam. Caches may hold some of that, so this limit can be beaten.
"""

from __future__ import annotations

import argparse
import sys
import time
from collections import defaultdict
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from statistics import median
from typing import Any

import numpy as np

sys.path.insert(0, str(Path(__file__).parent))

from irradia.core.device import available_threads
from irradia.core.rng import Seed
from irradia.field.backend import Batch, Rates, StepOptions
from irradia.field.backends.numba_backend import NumbaBackend
from irradia.field.backends.numba_team import Team
from irradia.field.cost import query_cost
from irradia.field.init import new_state
from irradia.field.spec import FieldSpec
from support.field_costs import step_cost
from support.field_models import MODELS, RATES
from support.machine_limits import Limits, measure_limits

WARM_UP = 3  # steps


class TimedTeam(Team):
    """Notes how long every call of a kernel took, in seconds."""

    def __init__(self, n_threads: int | None = None) -> None:
        super().__init__(n_threads)
        self.seconds: dict[str, list[float]] = defaultdict(list)

    def run(self, kernel: Callable[..., None], *arguments: Any) -> None:
        """As the base."""
        start = time.perf_counter()
        super().run(kernel, *arguments)
        module = kernel.__module__.rpartition(".")[2].removeprefix("numba_")
        self.seconds[f"{module} {kernel.__name__.strip('_')}"].append(time.perf_counter() - start)


@dataclass(frozen=True)
class Times:
    """Seconds, of a step unless it says otherwise.

    Attributes:
        kernels: Means over the steps, in the order in which they run.
        step: Median of whole steps.
        evaluation: Median of evaluating a batch.
    """

    kernels: dict[str, float]
    step: float
    evaluation: float


def main() -> None:
    """Times and prints."""
    models = [name for name, model in MODELS.items() if not model.own_backward]  # of the peer
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--model", action="append", choices=models)
    parser.add_argument("--batch", type=int, default=65536)
    parser.add_argument("--steps", type=int, default=20)
    parser.add_argument("--threads", type=int, default=available_threads())
    arguments = parser.parse_args()
    limits = measure_limits(arguments.threads)
    print(f"limits: {limits.flops / 1e9:.0f} GFLOP/s, {limits.bytes_per_s / 1e9:.1f} GB/s")
    for name in arguments.model or models:
        spec = MODELS[name].spec
        times = time_kernels(spec, arguments.batch, arguments.steps, arguments.threads)
        print(f"\n{MODELS[name].name}, batch {arguments.batch}, {arguments.threads} threads")
        print("\n".join(table(spec, arguments.batch, times, limits)))


def time_kernels(spec: FieldSpec, batch: int, steps: int, threads: int) -> Times:
    """Trains and evaluates on random points."""
    backend = NumbaBackend(threads)
    backend.team = team = TimedTeam(threads)
    rng = Seed(0).child("samples").numpy()
    normal = rng.standard_normal((batch, 3), np.float32)
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    target = rng.random((batch, spec.n_outputs), np.float32)
    data = Batch(rng.random((batch, 3), np.float32), normal if spec.direction else None, target)
    state = new_state(spec, Seed(0))
    stepper = backend.stepper(spec, state, StepOptions())
    evaluator = backend.evaluator(spec, state.parameters)
    step = _median_seconds(lambda: stepper.step(data, Rates(**RATES)), steps, team)
    kernels = {name: sum(calls) / steps for name, calls in team.seconds.items()}
    return Times(kernels, step, _median_seconds(lambda: evaluator(data.x, data.normal), steps, team))


def _median_seconds(call: Callable[[], object], repeats: int, team: TimedTeam) -> float:
    for _ in range(WARM_UP):
        call()
    team.seconds.clear()
    seconds = []
    for _ in range(repeats):
        start = time.perf_counter()
        call()
        seconds.append(time.perf_counter() - start)
    return median(seconds)


def table(spec: FieldSpec, batch: int, times: Times, limits: Limits) -> list[str]:
    """Lines: kernels, then the parts of a step with their share of the limit that binds them."""
    names = list(times.kernels)
    perceptron = names.index("perceptron train")
    seconds = list(times.kernels.values())
    query, step = query_cost(spec), step_cost(spec, batch)
    gathered = batch * query.encoding_bytes(32)
    parts = {
        "encode": (sum(seconds[:perceptron]), gathered / limits.bytes_per_s),
        "perceptron": (
            seconds[perceptron],
            (step.flops - 2 * batch * query.encoding_flops) / limits.flops,
        ),
        "learn": (sum(seconds[perceptron + 1 :]), (step.bytes - gathered) / limits.bytes_per_s),
        "step": (times.step, step.flops / limits.flops + step.bytes / limits.bytes_per_s),
        "evaluation": (
            times.evaluation,
            batch * query.flops / limits.flops + gathered / limits.bytes_per_s,
        ),
    }
    lines = [f"  {name:<32} {1e3 * took:8.2f} ms" for name, took in times.kernels.items()]
    for name, (took, least) in parts.items():
        rate = f"{batch / took / 1e6:8.2f} M samples/s"
        lines.append(f"  = {name:<30} {1e3 * took:8.2f} ms {rate}  limit {1e3 * least:6.2f} ms")
    return lines


if __name__ == "__main__":
    main()
