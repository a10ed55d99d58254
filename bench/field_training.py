"""How fast do fields train and evaluate? Irradia against PyTorch with fused Adam, on the same cores.

    python bench/field_training.py                          all, in about eight minutes
    python bench/field_training.py --model triplane --rounds 3
    python bench/field_training.py --device cuda            our Dr.Jit backend against PyTorch on the GPU

Both sides get the same architecture, parameters, batches, loss and Adam, and each runs in a process of
its own that is warm before it is timed. In this order, for each field:

1. Both start alike, and outputs, loss, gradients and the losses of a few steps are compared.
2. Rounds: in each, PyTorch does some steps, then Irradia, then both evaluate batches; a side that isn't
   timed waits. A round's figure is the median of its calls, and what is reported are medians over the
   rounds with the slowest and fastest. Ratios are taken within a round.

The machine's own limits are measured at the end: multiply-adds in registers, and a triad over memory.

PyTorch's own gradient of a table sorts all indices, so hash grids are measured once more against a gradient
written for them in PyTorch (``-own``).

PyTorch runs in an environment of its own, made on the first run; set IRRADIA_BENCH_TORCH_PYTHON to use
another. Results go to ``bench/results/field_training.md``.
"""

from __future__ import annotations

import argparse
import platform
import shlex
import sys
import tempfile
import time
from pathlib import Path

from irradia.core import write_text_atomic
from irradia.core.device import available_threads, cpu_name
from irradia.core.provenance import source_commit
from irradia.core.rng import Seed
from peers.field_worker import write_task
from support.field_agreement import compare
from support.field_models import MODELS, Model, make_task
from support.field_rounds import Measured, measure
from support.field_sides import irradia_worker, torch_worker
from support.field_table import markdown
from support.machine_limits import measure_limits

RESULTS = Path(__file__).parent / "results"
BACKENDS = {"cpu": "numba", "cuda": "drjit"}


def main() -> None:
    """Checks, measures, prints and writes the table."""
    arguments = _parse()
    versions: dict[str, None] = {}
    measured = [measure_model(MODELS[name], arguments, versions) for name in arguments.model]
    limits = measure_limits(arguments.threads) if arguments.device == "cpu" else None
    text = markdown(measured, limits, _facts(arguments, list(versions)))
    suffix = "" if arguments.device == "cpu" else f"-{arguments.device}"
    write_text_atomic(RESULTS / f"field_training{suffix}.md", text)
    print(text)


def measure_model(model: Model, arguments: argparse.Namespace, versions: dict[str, None]) -> Measured:
    """One field from its task to its figures; stops where the sides disagree."""
    task = make_task(
        model,
        batch=arguments.batch,
        n_batches=arguments.batches,
        average=arguments.average,
        seed=Seed(arguments.seed),
        threads=arguments.threads,
        device=arguments.device,
    )
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "task.npz"
        write_task(path, task)
        with torch_worker(path) as peer, irradia_worker(path, BACKENDS[arguments.device]) as ours:
            agreement = compare(ours, peer)
            print(f"{model.name}: {agreement}", file=sys.stderr, flush=True)
            if not agreement.good:
                raise SystemExit(f"{model.name}: the sides compute different things")
            versions.update((side.ask("version")["version"], None) for side in (ours, peer))
            step, infer = (
                measure(ours, peer, work, n_rounds=arguments.rounds, round_s=arguments.round_s)
                for work in ("step", "infer")
            )
    return Measured(model, agreement, arguments.batch, step, infer)


def _facts(arguments: argparse.Namespace, versions: list[str]) -> list[str]:
    average = f"running mean {arguments.average:g}" if arguments.average else "no running mean"
    return [
        f"Machine: {cpu_name()}, threads: {arguments.threads}, {platform.system()},"
        f" Python {platform.python_version()}",
        f"Sides: {'; '.join(versions)}",
        f"Commit: {source_commit()}; date: {time.strftime('%Y-%m-%d')}",
        f"Batch: {arguments.batch} samples, uniform in the cube; {arguments.batches} batches in turn;"
        f" relative L2; Adam moves every value on both sides; {average}; seed {arguments.seed}",
        f"Runs: {arguments.rounds} rounds of {arguments.round_s:g} s a side in turns; medians of the rounds'"
        " medians, with the extreme rounds",
        f"Command: `{shlex.join(['python', 'bench/field_training.py', *sys.argv[1:]])}`",
    ]


def _parse() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description="Irradia against PyTorch: training and evaluating fields.")
    parser.add_argument("--model", nargs="+", choices=MODELS, default=list(MODELS))
    parser.add_argument("--batch", type=int, default=65_536)
    parser.add_argument("--batches", type=int, default=4, help="different ones, taken in turn")
    parser.add_argument("--average", type=float, default=0.0, help="decay of a running mean on both sides")
    parser.add_argument("--rounds", type=int, default=7)
    parser.add_argument("--round-s", type=float, default=2.0, help="of each side")
    parser.add_argument("--threads", type=int, default=available_threads())
    parser.add_argument("--device", choices=BACKENDS, default="cpu")
    parser.add_argument("--seed", type=int, default=1)
    return parser.parse_args()


if __name__ == "__main__":
    main()
