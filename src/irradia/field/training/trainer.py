"""Trains a field, one event at a time."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from irradia.core.provenance import sha256_bytes
from irradia.core.rng import Seed
from irradia.field.backend import Backend, Parameters, Rates, TrainState
from irradia.field.backends import backend as find_backend
from irradia.field.checks import check_options
from irradia.field.registry import spec_to_dict
from irradia.field.spec import FieldFrame, FieldSpec
from irradia.field.training.batches import BatchSource
from irradia.field.training.checkpoint import check_same, check_state, load_checkpoint
from irradia.field.training.events import TrainEvent, Working
from irradia.field.training.growth import Growth, wait_for_rows
from irradia.field.training.jitter import Visibility
from irradia.field.training.judges import find_judges
from irradia.field.training.options import TrainOptions
from irradia.field.training.prepare import DataPlan, prepare
from irradia.field.training.rows import check_fit, frame_of, held_out, spread
from irradia.field.training.run import Plan, Run
from irradia.field.training.start import starting_state, state_of
from irradia.formats.samples import SampleFile

_STARTING_SAMPLES = 1 << 16
_WARM_UP_SAMPLES = 256
_FINGERPRINT_ROWS = 4096


@dataclass(frozen=True)
class TrainContext:
    """What surrounds a training and doesn't shape it, and what it may start from.

    Attributes:
        validation: Samples made for validation; without, 2 % of the rows are held out.
        start: Parameters trained before.
        visible: Test by rays for jitter; see :mod:`irradia.field.training.jitter`.
        scene: Name of the scene that these rays meet.
        backend: What computes it, or its name; see :func:`irradia.field.backends.backend`.
        checkpoint: File for checkpoints.
        resume: Go on from it.
        stop: Asked before each step whether to stop there.
    """

    validation: SampleFile | None = None
    start: Parameters | None = None
    visible: Visibility | None = None
    scene: str | None = None
    backend: Backend | str = "auto"
    checkpoint: Path | None = None
    resume: bool = False
    stop: Callable[[], bool] = lambda: False


def train(
    samples: SampleFile,
    spec: FieldSpec,
    options: TrainOptions | None = None,
    context: TrainContext | None = None,
) -> Iterator[TrainEvent]:
    """Trains a field on samples.

    The same samples, spec, options and backend give the same parameters, whatever the number of threads
    and however often it was stopped; but not with a time budget, nor from samples that still come.

    Args:
        samples: To learn from; may still be growing.
        spec: Of the field.
        options: Of its training.
        context: What surrounds it.

    Yields:
        What happens; :class:`~irradia.field.training.events.Finished` is the last.

    Raises:
        InputError: Samples and spec don't fit, there is nothing to resume, or the loss remains no number.
    """
    options, context = options or TrainOptions(), context or TrainContext()
    check_fit(samples, spec)
    check_options(spec, options.step_options())
    computing = context.backend
    if isinstance(computing, str):
        computing = find_backend(computing, spec)
    resumed = load_checkpoint(context.checkpoint) if context.resume and context.checkpoint else None
    identity = _identity(samples, spec, options, context, computing)
    if resumed is not None:
        check_same(resumed, identity, context.checkpoint or "")
        check_state(resumed, spec, context.checkpoint or "", averaged=options.average > 0.0)
    samples = yield from wait_for_rows(samples, options.batch_size)
    frame = frame_of(samples)
    if resumed is not None:
        frame = replace(frame, scale=resumed.scale)
    data_plan = _plan(samples, frame, options, context)
    judges = yield from find_judges(samples, context.validation, data_plan.kept_back, frame)
    source = yield from prepare(samples, data_plan)
    state = resumed.state if resumed else _start(spec, options, context, source)
    yield from _warm_up(computing, spec, state, options, source)
    plan = Plan(
        spec=spec,
        frame=frame,
        options=options,
        backend=computing,
        judges=judges,
        checkpoint=context.checkpoint,
        identity=identity,
        stop=context.stop,
    )
    yield from Run(plan, Growth(samples, source, data_plan), state, resumed).events()


def _plan(samples: SampleFile, frame: FieldFrame, options: TrainOptions, context: TrainContext) -> DataPlan:
    seed = Seed(options.seed)
    blocks = options.data.hold_out_blocks
    kept_back = held_out(samples, seed, rows=context.validation is None, blocks=blocks)
    return DataPlan(frame, kept_back, options.data, options.batch_size, seed, context.visible)


def _start(spec: FieldSpec, options: TrainOptions, context: TrainContext, source: BatchSource) -> TrainState:
    if context.start is not None:
        return state_of(context.start, options.step_options())
    seed = Seed(options.seed).child("init")
    typical = np.median(source.batch(0, _STARTING_SAMPLES, seed).target, axis=0)
    return starting_state(spec, seed, options.step_options(), typical)


def _warm_up(
    backend: Backend, spec: FieldSpec, state: TrainState, options: TrainOptions, source: BatchSource
) -> Iterator[Working]:
    """Has kernels compiled, which takes seconds the first time, by a step that is thrown away."""
    yield Working("Compile kernels")
    batch = source.batch(0, _WARM_UP_SAMPLES, Seed(options.seed))
    backend.stepper(spec, state, options.step_options()).step(batch, Rates(0.0, 0.0))
    backend.evaluator(spec, state.parameters)(batch.x, batch.normal)


def _identity(
    samples: SampleFile, spec: FieldSpec, options: TrainOptions, context: TrainContext, computing: Backend
) -> dict[str, Any]:
    """What must be the same for a stopped training to go on."""
    return {
        "spec": spec_to_dict(spec),
        "options": options.identity(),
        "backend": computing.name,
        "scene": context.scene,
        "data": _fingerprint(samples),
        "validation": None if context.validation is None else _fingerprint(context.validation),
    }


def _fingerprint(samples: SampleFile) -> dict[str, Any]:
    """What tells a dataset from others without reading all of it; of one that grows, its kind alone."""
    info = samples.info
    kind = {
        "kind": info.kind,
        "quantity": info.quantity,
        "n_coefficients": info.n_coefficients,
        "aabb": np.asarray(info.aabb).tolist(),
    }
    if not samples.finished:
        return {**kind, "rows": None, "sha256": None}
    some = np.array(samples.rows[spread(len(samples), _FINGERPRINT_ROWS)])
    return {**kind, "rows": len(samples), "sha256": sha256_bytes(some.tobytes())}
