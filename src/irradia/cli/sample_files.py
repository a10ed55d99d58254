"""The files of a sampling: how they grow, and when they take their names."""

from __future__ import annotations

import time
from collections.abc import Mapping
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path
from threading import Event
from typing import TYPE_CHECKING, Any

from irradia.bake.datasets.options import SampleOptions
from irradia.core.interrupt import asks_first
from irradia.core.progress import Progress
from irradia.formats.samples import SampleWriter, count_samples, open_samples, part_path, validation_path
from irradia.formats.samples_bin import write_samples_bin

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from irradia.bake.datasets import Setting

_TRAIN, _VALIDATION = "train", "validation"


@dataclass
class Tally:
    """What has been written to one file.

    Attributes:
        path: The file.
        n_points: Rows in it.
        seconds: Of tracing.
        total, variance: Sums over rows of the first three values, and of the variance.
    """

    path: Path
    n_points: int = 0
    seconds: float = 0.0
    total: float = 0.0
    variance: float = 0.0

    def add(self, rows: NDArray[np.float32], first_value: int) -> None:
        """Counts rows whose values begin at a column."""
        self.n_points += len(rows)
        self.total += float(rows[:, first_value : first_value + 3].mean(axis=1, dtype="f8").sum())
        self.variance += float(rows[:, -1].sum(dtype="f8"))

    def to_dict(self, samples_per_point: int) -> dict[str, Any]:
        """Plain values; a ray is a gather ray or a next-event sample."""
        n, seconds = max(self.n_points, 1), max(self.seconds, 1e-9)
        return {
            "path": str(self.path),
            "points": self.n_points,
            "samples_per_point": samples_per_point,
            "mean": self.total / n,
            "standard_error": (self.variance / n) ** 0.5,
            "points_per_second": self.n_points / seconds,
            "rays_per_second": 2 * samples_per_point * self.n_points / seconds,
        }


def write_datasets(
    out: Path,
    setting: Setting,
    options: SampleOptions,
    n_validation: int,
    origin: Mapping[str, Any],
    progress: Progress,
) -> dict[str, Any]:
    """Writes a dataset to ``out``, and before it NAME.validation.samples; the first Ctrl-C ends it early.

    An earlier dataset of the name stays, with what judges it, until this one is whole. One that is ended
    early replaces only a smaller one; beside a larger it is NAME.stopped.

    Args:
        out: A ``.samples`` or ``.bin``.
        setting: The scene.
        options: Which points.
        n_validation: How many the second file has; 0 for none, also none that an earlier sampling left.
        origin: The files' provenance.
        progress: Shows the stages "samples for validation" and "samples".

    Returns:
        What was made and how fast, plain values.
    """
    stopped = Event()
    with asks_first(stopped.set, progress.say):
        plan = _Plan(setting, origin, progress, stopped)
        made = _write_both(out, options, n_validation, plan)
    return {**made, "complete": not stopped.is_set()}


def _write_both(out: Path, options: SampleOptions, n_validation: int, plan: _Plan) -> dict[str, Any]:
    made: dict[str, Any] = {}
    earlier = count_samples(out)
    with ExitStack() as files:
        judge = None
        if n_validation:
            better = options.for_validation(n_validation)
            judge = files.enter_context(_Growing(_judge_of(out), plan, better))
            made["validation"] = judge.fill(_VALIDATION).to_dict(better.samples)
        if not earlier:
            _settle(judge, out)  # so that a training that follows has it
        if plan.stopped.is_set():
            return made
        train = files.enter_context(_Growing(out, plan, options))
        tally = train.fill(_TRAIN)
        keep = plan.stopped.is_set() and earlier > tally.n_points
        target = out.with_name(f"{out.stem}.stopped{out.suffix}") if keep else out
        made |= tally.to_dict(options.samples) | {"path": str(target)}
        if keep:
            made["kept"] = {"path": str(out), "points": earlier}
        if judge is not None:
            made["validation"]["path"] = str(_judge_of(target))
        _settle(judge, target)
        train.close(target)
    return made


def _judge_of(dataset: Path) -> Path:
    """Where the samples lie that judge fields of a dataset."""
    return validation_path(dataset.with_suffix(".samples"))


def _settle(judge: _Growing | None, dataset: Path) -> None:
    """Puts what judges fields of a dataset beside it; none of an earlier sampling stays in its place."""
    if judge is None:
        _judge_of(dataset).unlink(missing_ok=True)
    else:
        judge.close(_judge_of(dataset))


@dataclass(frozen=True)
class _Plan:
    """What both files of a sampling share."""

    setting: Setting
    origin: Mapping[str, Any]
    progress: Progress
    stopped: Event


class _Growing:
    """A file that grows beside its name.

    Leaving the context unclosed takes it away; after an error what there is of a ``.samples`` stays.
    """

    def __init__(self, path: Path, plan: _Plan, options: SampleOptions) -> None:
        from irradia.bake.datasets.generate import sample_info

        self._path, self._plan, self._options = path, plan, options
        self._info = sample_info(plan.setting, options, plan.origin)
        beside = path.with_name(f"{path.name}.samples") if self._is_bin else path
        self._writer = SampleWriter(beside, self._info)
        self._closed = False

    @property
    def _is_bin(self) -> bool:
        return self._path.suffix.lower() == ".bin"

    def fill(self, name: str) -> Tally:
        """Samples until all points are there, or Ctrl-C asks for an end."""
        from irradia.bake.datasets.generate import expected_points, sample_rows

        plan, tally = self._plan, Tally(self._path)
        first_value = self._info.n_columns - 1 - self._info.n_values
        stage_name = "samples" if name == _TRAIN else f"samples for {name}"
        with plan.progress.stage(stage_name, expected_points(plan.setting, self._options), "points") as stage:
            start = time.perf_counter()
            for rows in sample_rows(plan.setting, self._options, name):
                self._writer.append(rows)
                tally.add(rows, first_value)
                stage.advance(len(rows))
                if plan.stopped.is_set():
                    break
            tally.seconds = time.perf_counter() - start
        return tally

    def close(self, target: Path) -> None:
        """Ends the file under this name; doing so twice is harmless."""
        if self._closed:
            return
        if self._is_bin:
            self._writer.close()
            write_samples_bin(target, open_samples(self._writer.path))
            self._writer.path.unlink()
        else:
            self._writer.close(target)
        self._closed = True

    def __enter__(self) -> _Growing:
        return self

    def __exit__(self, kind: object, *_: object) -> None:
        self._writer.abandon()
        if self._closed or (kind is not None and not self._is_bin):
            return
        part_path(self._writer.path).unlink(missing_ok=True)
        if self._is_bin:
            self._writer.path.unlink(missing_ok=True)
