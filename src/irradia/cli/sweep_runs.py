"""The runs of a sweep as folders: what is done is kept, what was stopped goes on.

runs/NAME/request.json      what is asked for; another request begins anew
runs/NAME/field.*           the field, its log and its curves, as `irradia train` writes them
runs/NAME/messages.txt      what the training said
runs/NAME/result.json       last; whether the run is done with it, :func:`finished` says

Each training is a process of its own; see :mod:`irradia.cli.sweep_worker`.
"""

from __future__ import annotations

import json
import shutil
import subprocess
import sys
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor, as_completed
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from irradia.cli.sweep_grid import SweepRun
from irradia.core.errors import InputError
from irradia.core.files import write_text_atomic

Record = dict[str, Any]


@dataclass(frozen=True)
class SweepJob:
    """What all runs of a sweep share.

    Attributes:
        data: Samples.
        data_hash: Of their content: other samples, other runs.
        out: The sweep's folder.
        seed: Of each run whose grid says none.
        threads: Of each run.
        jobs: Runs at a time.
    """

    data: Path
    data_hash: str
    out: Path
    seed: int
    threads: int
    jobs: int = 1

    def folder(self, run: SweepRun) -> Path:
        """Where a run's files are."""
        return self.out / "runs" / run.name

    def field(self, run: SweepRun) -> Path:
        """The file of a run's field: packed where its tables are quantised."""
        end = ".safetensors.zst" if "finish" in run.choices else ".safetensors"
        return self.folder(run) / f"field{end}"

    def request(self, run: SweepRun) -> Record:
        """All that decides a run."""
        return {"data": self.data_hash, "seed": self.seed, "choices": run.choices}


def finished(job: SweepJob, run: SweepRun) -> Record | None:
    """The result of a run that is done; None where it is still to do.

    One whose options are wrong has failed for good. One that was killed or met an error of ours is tried
    again, and so is one whose field has gone.
    """
    folder = job.folder(run)
    if _read(folder / "request.json") != job.request(run):
        return None
    result = _read(folder / "result.json") or {}
    lasts = job.field(run).is_file() if result.get("ok") else result.get("exit_code") == InputError.exit_code
    return result if lasts else None


def train_all(
    job: SweepJob, runs: list[SweepRun], done: Callable[[SweepRun, Record], None], stop: Callable[[], bool]
) -> None:
    """Trains runs, ``job.jobs`` at a time; each that ends is handed over, one by one."""
    with ThreadPoolExecutor(job.jobs) as pool:
        waiting = {pool.submit(_train, job, run, stop): run for run in runs}
        for future in as_completed(waiting):
            result = future.result()
            if result is not None:
                done(waiting[future], result)


def _train(job: SweepJob, run: SweepRun, stop: Callable[[], bool]) -> Record | None:
    """Trains one run; None where the sweep was stopped."""
    if stop():
        return None
    folder = job.folder(run)
    if _read(folder / "request.json") != job.request(run):
        shutil.rmtree(folder, ignore_errors=True)
        folder.mkdir(parents=True)
        write_text_atomic(folder / "request.json", json.dumps(job.request(run), indent=2))
    code, text = _call(job, run)
    if code != 0 and stop():
        return None
    result = _result(code, text, folder)
    write_text_atomic(folder / "result.json", json.dumps(result, indent=2))
    return result


def command_line(job: SweepJob, run: SweepRun) -> list[str]:
    """The process that trains a run, or goes on with it where there is a checkpoint."""
    worker = [sys.executable, "-m", "irradia.cli.sweep_worker"]
    train = ["train", str(job.data), "-o", str(job.field(run)), f"--seed={job.seed}", *run.arguments]
    going_on = ["--resume"] if (job.folder(run) / "field.checkpoint.npz").is_file() else []
    return [*worker, *train, *going_on, "--json", "--threads", str(job.threads)]


def _call(job: SweepJob, run: SweepRun) -> tuple[int, str]:
    """Exit code of `irradia train` and what it printed."""
    with (job.folder(run) / "messages.txt").open("wb") as messages:
        process = subprocess.Popen(
            command_line(job, run),
            stdin=subprocess.PIPE,  # stays open while the process lives: see sweep_worker
            stdout=subprocess.PIPE,
            stderr=messages,
            text=True,
        )
        with process:
            text = process.stdout.read() if process.stdout else ""
            return process.wait(), text


def _result(code: int, text: str, folder: Path) -> Record:
    try:
        printed = json.loads(text)
    except ValueError:
        printed = {}
    if code == 0 and printed.get("ok"):
        return printed
    said = printed.get("error", {}).get("message") or f"it ended with {code}; see {folder / 'messages.txt'}"
    return {"ok": False, "exit_code": code, "error": said}


def _read(path: Path) -> Record | None:
    try:
        content = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return None
    return content if isinstance(content, dict) else None
