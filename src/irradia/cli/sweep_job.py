"""A whole sweep: runs, table, page."""

from __future__ import annotations

import time
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from irradia.cli.sweep_grid import SweepRun
from irradia.cli.sweep_pictures import PictureJob, Viewpoint, look_once, score_all
from irradia.cli.sweep_runs import Record, SweepJob, finished, train_all
from irradia.cli.sweep_table import Row, check_parquet, make_row, write_tables
from irradia.core import provenance
from irradia.core.errors import InputError
from irradia.core.interrupt import asks_first
from irradia.core.lock import acquire_lock, lock_holder
from irradia.core.progress import Progress

if TYPE_CHECKING:
    from irradia.formats.samples import SampleFile

PAGE = "sweep.html"
_LOCK = ".irradia-sweep.lock"
_MANY_CURVES = 120  # more would be a blur


@dataclass(frozen=True)
class Sweep:
    """What is asked for.

    Attributes:
        data: Samples.
        out: Folder for everything.
        grid: Its name or file.
        runs: Of the grid.
        pictures: A camera to show fields from; None shows none.
        jobs: Trainings at a time.
        only_list: Says what there is to do, and does nothing.
    """

    data: Path
    out: Path
    grid: str
    runs: tuple[SweepRun, ...]
    pictures: PictureJob | None
    jobs: int
    seed: int
    device: str
    threads: int | None
    only_list: bool


@dataclass
class _Board:
    """What is known of each run so far.

    Attributes:
        results: As `irradia train` printed them.
        costs: Of queries, and FLIP.
        pictures: By name, linear radiance.
    """

    job: SweepJob
    runs: tuple[SweepRun, ...]
    results: dict[str, Record] = field(default_factory=dict)
    costs: dict[str, Record] = field(default_factory=dict)
    pictures: dict[str, NDArray[np.float32]] = field(default_factory=dict)

    def take(self, run: SweepRun, result: Record) -> None:
        """Notes that a run has ended."""
        self.results[run.name] = result
        self.costs[run.name] = _formula_cost(self.job.field(run)) if result.get("ok") else {}

    def rows(self) -> list[Row]:
        """Of the runs that have ended, in the grid's order."""
        ended = (run for run in self.runs if run.name in self.results)
        return [make_row(run, self.results[run.name], self.costs[run.name]) for run in ended]

    def fields(self) -> dict[str, Path]:
        """Files of the fields that there are."""
        return {r.name: self.job.field(r) for r in self.runs if self.results.get(r.name, {}).get("ok")}


def run_sweep(sweep: Sweep, progress: Progress) -> dict[str, Any]:
    """Trains what is still to train, and writes table and page.

    Raises:
        InputError: The samples or an option are wrong, or another process sweeps into the folder.
    """
    from irradia.formats.samples import open_samples

    check_parquet()
    samples = open_samples(sweep.data)
    job = _share(sweep, samples, progress)
    board = _Board(job, sweep.runs)
    for run in sweep.runs:
        result = finished(job, run)
        if result is not None:
            board.take(run, result)
    if sweep.only_list:
        return _summary(sweep, board, complete=True)
    sweep.out.mkdir(parents=True, exist_ok=True)
    lock = acquire_lock(sweep.out / _LOCK)
    if lock is None:
        raise InputError(f"another sweep writes here: {lock_holder(sweep.out / _LOCK)}", where=str(sweep.out))
    try:
        return _run(sweep, board, samples, progress)
    finally:
        lock.release()


def _share(sweep: Sweep, samples: SampleFile, progress: Progress) -> SweepJob:
    from irradia.core.device import available_threads

    with progress.stage("Hash samples"):
        data_hash = provenance.sha256_file(samples.path)
    threads = max((sweep.threads or available_threads()) // sweep.jobs, 1)
    return SweepJob(sweep.data, data_hash, sweep.out, sweep.seed, threads, sweep.jobs)


def _run(sweep: Sweep, board: _Board, samples: SampleFile, progress: Progress) -> dict[str, Any]:
    start = time.perf_counter()
    complete = _train(sweep, board, progress)
    if board.fields():
        _measure(board, progress)
        if sweep.pictures is not None:
            _look(sweep, sweep.pictures, board, samples, progress)
    _write(sweep, board, progress, time.perf_counter() - start)
    return _summary(sweep, board, complete)


def _train(sweep: Sweep, board: _Board, progress: Progress) -> bool:
    """Trains the rest of the grid; whether it came to its end."""
    to_do = [run for run in sweep.runs if run.name not in board.results]
    if board.results:
        progress.say(f"{len(board.results)} of {len(sweep.runs)} runs are done already.")
    stopped = [False]

    def ask() -> None:
        stopped[0] = True

    with asks_first(ask, progress.say), progress.stage("Train fields", len(to_do), "fields") as stage:

        def done(run: SweepRun, result: Record) -> None:
            board.take(run, result)
            write_tables(sweep.out, board.rows())
            stage.advance()
            stage.note(f"  {run.name}")

        train_all(board.job, to_do, done, lambda: stopped[0])
    return not stopped[0]


def _measure(board: _Board, progress: Progress) -> None:
    """Queries a second of every field, one after another, when nothing else runs."""
    from irradia.field.backends import backend
    from irradia.field.evaluation import queries_per_second
    from irradia.field.files import load_field

    files = board.fields()
    with progress.stage("Time queries", len(files), "fields") as stage:
        for name, path in files.items():
            shown = load_field(path)
            evaluator = backend("auto", shown.spec, board.job.threads).evaluator(shown.spec, shown.parameters)
            speed = queries_per_second(evaluator, directional=shown.spec.mode == "irradiance")
            board.costs[name]["queries_per_s"] = speed
            stage.advance()


def _look(sweep: Sweep, pictures: PictureJob, board: _Board, samples: SampleFile, progress: Progress) -> None:
    from irradia.transport import use_device

    use_device(sweep.device, sweep.threads)  # type: ignore[arg-type]
    view: Viewpoint = look_once(pictures, samples.info.quantity, sweep.seed, progress)
    board.pictures["reference"] = view.reference.mean

    def keep(name: str, flip: float) -> None:
        board.costs[name]["flip"] = flip

    board.pictures.update(score_all(board.fields(), view, progress, keep))


def _write(sweep: Sweep, board: _Board, progress: Progress, wall_s: float) -> None:
    from irradia.core.colour import automatic_exposure_ev
    from irradia.report.sweep import SweepData, write_sweep

    rows = board.rows()
    write_tables(sweep.out, rows)
    reference = board.pictures.get("reference")
    inputs = {sweep.data.name: board.job.data_hash}
    config = {"grid": Path(sweep.grid).name, "runs": len(sweep.runs), "jobs": sweep.jobs}
    made = provenance.record("sweep", config, seed=sweep.seed, inputs=inputs, device=None, wall_s=wall_s)
    n_done = sum(row["status"] == "done" for row in rows)
    notes = [] if len(rows) == len(sweep.runs) else [f"{len(sweep.runs) - len(rows)} runs are still to do."]
    data = SweepData(
        title=f"Sweep of {sweep.data.stem}",
        subtitle=f"{n_done} fields, grid {Path(sweep.grid).stem}",
        rows=rows,
        losses=_losses(board),
        pictures=board.pictures,
        exposure_ev=0.0 if reference is None else automatic_exposure_ev(reference),
        provenance=made.to_dict(),
        notes=notes,
    )
    with progress.stage("page"):
        write_sweep(sweep.out / PAGE, data)


def _losses(board: _Board) -> dict[str, list[tuple[int, float]]]:
    from irradia.field.training.log import read_log

    curves = {}
    for name, path in list(board.fields().items())[:_MANY_CURVES]:
        log = path.parent / "field.training.csv"
        if log.is_file():
            curves[name] = [(row.step, row.loss) for row in read_log(log, 1 << 62)]
    return curves


def _formula_cost(path: Path) -> Record:
    """What a query costs by formula."""
    from irradia.cli.eval_files import query_record
    from irradia.field.files import read_field

    return dict(query_record(read_field(path)))


def _summary(sweep: Sweep, board: _Board, complete: bool) -> dict[str, Any]:
    rows = board.rows()
    failed = [
        {"name": row["name"], "error": row["error"], "exit_code": board.results[row["name"]].get("exit_code")}
        for row in rows
        if row["status"] == "failed"
    ]
    return {
        "out": str(sweep.out),
        "grid": sweep.grid,
        "complete": complete,
        "n_runs": len(sweep.runs),
        "runs": [run.name for run in sweep.runs],
        "rows": rows,
        "failed": failed,
    }


def _score(relmse: float | None) -> str:
    return "–" if relmse is None else f"{relmse:.3e}"


def describe(result: dict[str, Any]) -> str:
    """What came of a sweep, best first."""
    from irradia.report.sweep import error_of

    done = [row for row in result["rows"] if row["status"] == "done"]
    lines = [f"{len(done)} of {result['n_runs']} fields in {result['out']}"]
    best = sorted(done, key=error_of)[:5]
    lines += [
        f"  {row['name']:<40} {row['bytes']:>10,} bytes  relMSE {_score(row['relmse'])}" for row in best
    ]
    lines += [f"  {row['name']} failed: {row['error']}" for row in result["failed"]]
    if not result["complete"]:
        lines.append("Stopped; the same command goes on.")
    elif done:
        lines.append(f"Open {result['out']}/{PAGE} in a browser.")
    return "\n".join(lines)
