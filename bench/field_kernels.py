"""Where does the time of a training step go? Milliseconds of each kernel, and its share of the machine.

    python bench/field_kernels.py                        all four fields of field_training.py
    python bench/field_kernels.py --model hash-16x19 --steps 40 --batch 65536

For tuning, so without a peer: field_training.py compares. Times are medians over steps. A kernel's share is
of the limit that binds it: the perceptron of multiply-adds in registers, everything else of a triad over
memory. Gathers and scatters are counted in bytes that they must touch, Adam in what it reads and writes.
"""

from __future__ import annotations

import argparse
import sys
import time
from collections import defaultdict
from collections.abc import Callable
from pathlib import Path
from statistics import median
from typing import Any

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
from support.field_models import MODELS, RATES, make_task
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


def main() -> None:
    """Times and prints."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--model", action="append", choices=list(MODELS))
    parser.add_argument("--batch", type=int, default=65536)
    parser.add_argument("--steps", type=int, default=20)
    parser.add_argument("--threads", type=int, default=available_threads())
    arguments = parser.parse_args()
    limits = measure_limits(arguments.threads)
    print(f"limits: {limits.flops / 1e9:.0f} GFLOP/s, {limits.bytes_per_s / 1e9:.1f} GB/s")
    for name in arguments.model or MODELS:
        spec = MODELS[name].spec
        times, whole = time_kernels(spec, arguments.batch, arguments.steps, arguments.threads)
        print(f"\n{MODELS[name].name}, batch {arguments.batch}, {arguments.threads} threads")
        for line in table(spec, arguments.batch, times, whole, limits):
            print(line)


def time_kernels(
    spec: FieldSpec, batch: int, steps: int, threads: int
) -> tuple[dict[str, float], dict[str, float]]:
    """Seconds of a step by kernel, and of whole training steps and evaluations."""
    backend = NumbaBackend(threads)
    backend.team = team = TimedTeam(threads)
    task = make_task(
        spec, batch=batch, n_batches=1, average=0.99, seed=Seed(0), threads=threads, device="cpu"
    )
    data = Batch(task.x[0], None if task.normal is None else task.normal[0], task.target[0])
    stepper = backend.stepper(spec, new_state(spec, Seed(0)), StepOptions())
    evaluator = backend.evaluator(spec, task.parameters)
    step = _median_seconds(lambda: stepper.step(data, Rates(**RATES)), steps, team)
    kernels = {name: sum(calls) / steps for name, calls in team.seconds.items()}
    evaluation = _median_seconds(lambda: evaluator(data.x, data.normal), steps, team)
    kernels |= {f"evaluation: {name}": sum(calls) / steps for name, calls in team.seconds.items()}
    return kernels, {"step": step, "evaluation": evaluation}


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


def table(
    spec: FieldSpec, batch: int, kernels: dict[str, float], whole: dict[str, float], limits: Limits
) -> list[str]:
    """Lines: name, milliseconds, share of the limit that binds it."""
    query = query_cost(spec)
    training = step_cost(spec, batch)
    bound = {
        "perceptron train": (training.flops - batch * query.encoding_flops * 2) / limits.flops,
        "evaluation: perceptron infer": batch * query.network_flops / limits.flops,
    }
    lines = []
    for name, seconds in kernels.items():
        share = f"{bound[name] / seconds:4.0%} of multiply-adds" if name in bound else ""
        lines.append(f"  {name:<36} {1e3 * seconds:7.2f} ms  {share}")
    in_steps = sum(seconds for name, seconds in kernels.items() if not name.startswith("evaluation"))
    lines.append(f"  {'Python between kernels':<36} {1e3 * (whole['step'] - in_steps):7.2f} ms")
    for name, seconds in whole.items():
        lines.append(f"  whole {name:<30} {1e3 * seconds:7.2f} ms  {batch / seconds / 1e6:.2f} M samples/s")
    touched = training.bytes / limits.bytes_per_s
    lines.append(f"  bytes of a step at the limit         {1e3 * touched:7.2f} ms")
    return lines


if __name__ == "__main__":
    main()
