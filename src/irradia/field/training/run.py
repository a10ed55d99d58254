"""The course of a training: steps, validations, checkpoints, setbacks, and the end."""

from __future__ import annotations

import math
import time
from collections import deque
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from irradia.core.errors import InputError
from irradia.core.rng import Seed
from irradia.field.backend import Backend, Parameters, Stepper, TrainState
from irradia.field.spec import FieldFrame, FieldSpec
from irradia.field.training import schedule
from irradia.field.training.checkpoint import Checkpoint, Course, save_checkpoint
from irradia.field.training.events import (
    Finished,
    Judges,
    Remark,
    Saved,
    Stepped,
    SteppedBack,
    TrainEvent,
    Validated,
    Why,
)
from irradia.field.training.figures import Figures, Judge
from irradia.field.training.growth import Growth
from irradia.field.training.options import TrainOptions
from irradia.field.training.start import inference_parameters

MAX_SETBACKS = 3
N_VALIDATIONS = 20
N_LOSSES = 100  # that the last mean is over
LEAST_GAIN = 1e-3  # of relMSE, for a validation to count as better


@dataclass(frozen=True)
class Plan:
    """All that stays the same over a training.

    Attributes:
        spec, frame: Of the field.
        options: Of the training.
        backend: What computes it.
        judges: What it is judged by.
        checkpoint: File for checkpoints; None keeps none.
        identity: For checkpoints.
        stop: Asked before each step whether to stop.
    """

    spec: FieldSpec
    frame: FieldFrame
    options: TrainOptions
    backend: Backend
    judges: Judges
    checkpoint: Path | None
    identity: dict[str, Any]
    stop: Callable[[], bool]


class Run:
    """One process's part of a training.

    Args:
        plan: What stays the same.
        data: Where batches come from.
        state: To start from.
        resumed: The checkpoint that the state is of; None at the beginning.
    """

    def __init__(self, plan: Plan, data: Growth, state: TrainState, resumed: Checkpoint | None) -> None:
        self._plan, self._options, self._data = plan, plan.options, data
        self._step_options = plan.options.step_options()
        self._course = resumed.course if resumed else Course()
        self._best: Parameters = resumed.best if resumed else {}
        self._losses = deque(self._course.losses, N_LOSSES)
        self._good = state  # the last state in which every number is one
        self._stepper: Stepper = plan.backend.stepper(plan.spec, state, self._step_options)
        self._step = self._validated_step = state.step
        self._began = time.perf_counter() - self._course.spent_s
        self._validated_s = self._saved_s = self._course.spent_s
        self._steps_s, self._samples = 0.0, 0  # of this process

    def events(self) -> Iterator[TrainEvent]:
        """Trains to the end."""
        while (why := self._end()) is None:
            yield from self._data.follow()
            loss = self._take_step()
            if math.isfinite(loss):
                yield self._stepped(loss)
                yield from self._look()
            else:
                yield self._step_back()
        yield from self._last_look(why)
        yield self._finished(why)

    def _end(self) -> Why | None:
        """Why there is no further step."""
        options = self._options
        if self._plan.stop():
            return "stopped"
        if options.early_stop is not None and self._course.n_worse >= options.early_stop:
            return "early stop"
        if options.steps is not None and self._step >= options.steps:
            return "steps"
        return "time" if options.time_s is not None and self._spent_s() >= options.time_s else None

    def _take_step(self) -> float:
        options, course = self._options, self._course
        start = time.perf_counter()
        batch = self._data.source.batch(self._step, options.batch_size, self._batch_seed())
        done = schedule.progress(options, self._step, self._spent_s())
        loss = self._stepper.step(batch, schedule.rates(options, done, course.rate_factor))
        self._steps_s += time.perf_counter() - start
        self._samples += len(batch)
        self._step += 1
        return loss

    def _batch_seed(self) -> Seed:
        """After a setback other batches come, lest the same one does the same harm."""
        seed = Seed(self._options.seed).child("batch")
        n = self._course.n_setbacks
        return seed.child(f"setback-{n}") if n else seed

    def _stepped(self, loss: float) -> Stepped:
        self._losses.append(loss)
        spent_s = self._spent_s()
        return Stepped(
            self._step,
            loss,
            schedule.progress(self._options, self._step, spent_s),
            spent_s,
            self._step * self._options.batch_size,
            self._samples_per_s(),
        )

    def _look(self) -> Iterator[TrainEvent]:
        """Validates and saves where that is due."""
        validate, save = self._validation_is_due(), self._due_checkpoint()
        if not validate and save is None:
            return
        state = self._stepper.state()
        if not _is_finite(state):
            yield self._step_back()
            return
        if validate:
            figures = self._judged(state)
            if not math.isfinite(figures.relmse):
                yield self._step_back()
                return
            yield Validated(self._step, figures)
            self._good = state  # not where it is only saved: the clock says when that is
        if save is not None:
            yield self._save(save, state)

    def _last_look(self, why: Why) -> Iterator[TrainEvent]:
        """Validates the last state, and saves it if one may go on from it."""
        if self._validated_step != self._step or self._good.step != self._step:
            state = self._stepper.state()
            if _is_finite(state):
                self._good = state
            if why != "stopped":  # which must not count as a validation when the training goes on
                yield Validated(self._good.step, self._judged(self._good))
        if why == "stopped" and self._plan.checkpoint is not None:
            yield self._save(self._plan.checkpoint, self._good)

    def _judged(self, state: TrainState) -> Figures:
        """Validates; notes whether it is the best so far."""
        parameters = inference_parameters(state, self._step_options)
        figures = self._figures(self._plan.judges.validation, parameters)
        better = figures.relmse < self._course.best_relmse * (1.0 - LEAST_GAIN)
        if better:
            self._course = replace(self._course, best_relmse=figures.relmse, n_worse=0)
            self._best = parameters if self._options.early_stop is not None else {}
        elif math.isfinite(figures.relmse):
            self._course = replace(self._course, n_worse=self._course.n_worse + 1)
        self._validated_step, self._validated_s = state.step, self._spent_s()
        return figures

    def _figures(self, judge: Judge, parameters: Parameters) -> Figures:
        return judge.figures(self._plan.backend.evaluator(self._plan.spec, parameters))

    def _validation_is_due(self) -> bool:
        options = self._options
        if options.validate_every is not None:
            return self._step % options.validate_every == 0
        if options.time_s is not None:
            return self._spent_s() - self._validated_s >= options.time_s / N_VALIDATIONS
        return self._step % -(-(options.steps or 1) // N_VALIDATIONS) == 0

    def _due_checkpoint(self) -> Path | None:
        """The file to write now, if it is time to."""
        due = self._spent_s() - self._saved_s >= self._options.checkpoint_s
        return self._plan.checkpoint if due else None

    def _save(self, path: Path, state: TrainState) -> TrainEvent:
        """Writes a checkpoint; a disk without room for it need not end the training."""
        course = replace(self._course, spent_s=self._spent_s(), losses=tuple(self._losses))
        kept = Checkpoint(state, course, self._best, self._plan.identity, self._plan.frame.scale)
        self._saved_s = self._spent_s()
        try:
            save_checkpoint(path, kept)
        except OSError as error:
            return Remark(f"The checkpoint could not be saved: {error.strerror or error}.")
        return Saved(state.step)

    def _step_back(self) -> SteppedBack:
        """Goes on from the last good state at half the rates."""
        course, at = self._course, self._step
        if course.n_setbacks == MAX_SETBACKS:
            raise InputError(
                f"after {at} steps the loss is no number, for the {MAX_SETBACKS + 1}th time, "
                f"at {course.rate_factor:g} of the learning rates",
                fix="Lower --lr-encoding and --lr-network, or take another --head or --loss.",
            )
        self._course = replace(course, rate_factor=course.rate_factor / 2.0, n_setbacks=course.n_setbacks + 1)
        self._stepper = self._plan.backend.stepper(self._plan.spec, self._good, self._step_options)
        self._step = self._good.step
        return SteppedBack(at, self._step, self._course.rate_factor)

    def _finished(self, why: Why) -> Finished:
        plan = self._plan
        parameters = self._best or inference_parameters(self._good, self._step_options)
        blocks = plan.judges.blocks
        return Finished(
            why,
            plan.spec,
            plan.frame,
            parameters,
            self._good.step,
            float(np.mean(self._losses)) if self._losses else math.nan,
            self._figures(plan.judges.validation, parameters),
            self._figures(blocks, parameters) if blocks is not None else None,
            self._spent_s(),
            self._samples_per_s(),
            self._data.source.n_rows,
            self._course.n_setbacks,
            plan.judges,
        )

    def _spent_s(self) -> float:
        return time.perf_counter() - self._began

    def _samples_per_s(self) -> float:
        return self._samples / self._steps_s if self._steps_s > 0.0 else 0.0


def _is_finite(state: TrainState) -> bool:
    """Whether every number is one; a sum is none where one of its terms isn't."""
    groups = (state.parameters, state.average, state.first, state.second)
    return all(np.isfinite(np.sum(array)) for group in groups for array in group.values())
