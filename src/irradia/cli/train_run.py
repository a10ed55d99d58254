"""A whole training: samples, field, files."""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from threading import Event
from typing import TYPE_CHECKING, Any

from irradia.cli.train_job import TrainJob
from irradia.cli.train_view import shown
from irradia.core import provenance
from irradia.core.errors import InputError, InternalError
from irradia.core.progress import Progress
from irradia.core.rng import Seed
from irradia.field.backend import Backend
from irradia.field.backends import backend as find_backend
from irradia.field.field import Field
from irradia.field.files import check_format, load_field, save_field
from irradia.field.registry import spec_to_dict
from irradia.field.spec import FieldSpec
from irradia.field.training import Figures, Finished, Saved, TrainContext, Validated, train
from irradia.field.training.checkpoint import read_step
from irradia.field.training.curves import write_curves
from irradia.field.training.growth import latest
from irradia.field.training.log import LogRow, TrainingLog, read_log, write_log
from irradia.formats.sample_origin import check_same_light
from irradia.formats.samples import SampleFile, open_samples, part_path, validation_path

if TYPE_CHECKING:
    from irradia.field.quantised import QuantisedField
    from irradia.field.training.jitter import Visibility

_WAIT_S = 0.5
_CLEARLY_WORSE = 1.25  # relMSE at the end over the best on the way


def run_training(job: TrainJob, progress: Progress) -> dict[str, Any]:
    """Trains a field and writes it, its log and its curves.

    Returns:
        What came of it, plain values; ``complete`` is False where Ctrl-C ended it early.

    Raises:
        InputError: Something in the files or among the options is wrong.
    """
    start = time.perf_counter()
    samples = open_data(job, progress)
    spec = job.choices.spec(samples.info)
    check_format(job.out, spec, precision=job.precision, finish=job.finish)
    backend = find_backend(job.backend, spec, job.threads)
    validation = _validation(job, samples)
    finished = _train(job, samples, validation, spec, backend, progress)
    samples = latest(samples)
    made = _made(job, finished, samples, validation, backend, progress)
    n_bytes = save_field(job.out, made, _about(job, samples, finished, progress), precision=job.precision)
    if finished.why == "stopped":
        progress.say("Stopped early; the field is usable. The same command with --resume goes on.")
    else:
        job.checkpoint.unlink(missing_ok=True)
    return {
        **_summary(job, finished, _shipped(job, finished, progress)),
        "remark": overfitting(read_log(job.beside(".training.csv"), finished.step)),
        "backend": backend.name,
        "bytes": n_bytes,
        "stage_s": {name: round(seconds, 4) for name, seconds in progress.seconds.items()},
        "wall_s": round(time.perf_counter() - start, 3),
    }


def open_data(job: TrainJob, progress: Progress) -> SampleFile:
    """The samples; with ``follow``, once they are there.

    Raises:
        InputError: They can't be read.
    """
    if job.follow and not _is_there(job.data):
        with progress.stage("Wait for samples"):
            while not _is_there(job.data):
                time.sleep(_WAIT_S)
    return open_samples(job.data, job.bin_samples)


def _is_there(path: Path) -> bool:
    return path.is_file() or part_path(path).is_file()


def _train(
    job: TrainJob,
    samples: SampleFile,
    validation: SampleFile | None,
    spec: FieldSpec,
    backend: Backend,
    progress: Progress,
) -> Finished:
    """Follows a training to its end, and writes its log on the way."""
    stopped = Event()
    context = TrainContext(
        validation=validation,
        visible=_visibility(job, progress),
        scene=job.jitter_scene if job.options.data.jitter_copies else None,
        backend=backend,
        checkpoint=job.checkpoint,
        resume=job.resume,
        stop=stopped.is_set,
    )
    log, finished = TrainingLog(_earlier_rows(job)), None
    for event in shown(train(samples, spec, job.options, context), job.options, progress, stopped.set):
        log.take(event)
        if isinstance(event, (Validated, Saved, Finished)):
            write_log(job.beside(".training.csv"), log.rows)
        if isinstance(event, Finished):
            write_curves(job.beside(".training.svg"), log.rows, job.out.name)
            finished = event
    if finished is None:
        raise InternalError("a training ended without saying so")
    return finished


def _validation(job: TrainJob, samples: SampleFile) -> SampleFile | None:
    """Samples to judge by: those asked for, else those beside the data, which must be of its box.

    Raises:
        InputError: They can't be read, or those beside the data were left by another sampling.
    """
    if job.validation is not None:
        return open_samples(job.validation, job.bin_samples)
    beside = validation_path(job.data.with_suffix(".samples"))
    if not beside.is_file() or beside == samples.path:
        return None
    found = open_samples(beside)
    check_same_light(samples.info, found.info, str(beside), same_box=True)
    return found


def _visibility(job: TrainJob, progress: Progress) -> Visibility | None:
    """A test by rays, where copies are made and their scene is named."""
    if not job.options.data.jitter_copies or job.jitter_scene is None:
        return None
    from irradia.cli.train_sight import sight_in

    return sight_in(job.jitter_scene, job.threads, progress)


def _earlier_rows(job: TrainJob) -> list[LogRow]:
    """What the log says of the training that is to go on."""
    if not job.resume:
        return []
    return read_log(job.beside(".training.csv"), read_step(job.checkpoint))


def _made(
    job: TrainJob,
    finished: Finished,
    samples: SampleFile,
    validation: SampleFile | None,
    backend: Backend,
    progress: Progress,
) -> Field | QuantisedField:
    """What goes into the file."""
    trained = Field(finished.spec, finished.frame, finished.parameters)
    if job.finish is None:
        return trained
    from irradia.field.quantise import FinishOptions
    from irradia.field.quantise import finish as finish_in_bits
    from irradia.field.training.rows import held_out

    options = job.options
    if options.data.smooth_k or options.data.jitter_copies:
        progress.say(
            f"note: --finish {job.finish} learns from the samples as they are, neither smoothed nor copied."
        )
    finishing = FinishOptions(batch_size=options.batch_size, loss=options.loss, seed=options.seed)
    bits = 8 if job.finish == "int8" else 4
    kept_back = held_out(
        samples,
        Seed(options.seed),
        rows=validation is None,
        blocks=options.data.hold_out_blocks,
    )
    return finish_in_bits(
        trained, bits, samples, finishing, kept_back=kept_back, backend=backend, progress=progress
    )


def _about(job: TrainJob, samples: SampleFile, finished: Finished, progress: Progress) -> dict[str, Any]:
    """The field's provenance: nothing that differs between runs that give the same field."""
    inputs = _hashes(job, samples, progress)
    made = provenance.record(
        "train", job.config(), seed=job.options.seed, inputs=inputs, device=None, wall_s=0.0
    )
    result = {"steps": finished.step, "loss": finished.loss, "validation": finished.figures.to_json()}
    return {**made.reproducible(), "training": result, "samples": dict(samples.info.provenance)}


def _hashes(job: TrainJob, samples: SampleFile, progress: Progress) -> dict[str, str]:
    """SHA-256 of the samples; none where they have gone meanwhile, which must not cost the field."""
    with progress.stage("Hash samples"):
        try:
            return {job.data.name: provenance.sha256_file(samples.grown().path)}
        except (InputError, OSError):
            progress.say(f"note: {job.data} has gone, so the field doesn't hold its hash.")
            return {}


def _shipped(job: TrainJob, finished: Finished, progress: Progress) -> Figures:
    """Figures of the file. A .bin comes back with another spec and scale that give the same light."""
    with progress.stage("Judge the file"):
        field = load_field(job.out)
        judge = replace(finished.judges.validation, scale=field.frame.scale)
        backend = find_backend(job.backend, field.spec, job.threads)
        return judge.figures(backend.evaluator(field.spec, field.parameters))


def overfitting(rows: Sequence[LogRow]) -> str | None:
    """What to say where validation has been clearly better before the end; None where it wasn't."""
    judged = [(row.relmse, row.psnr_db, row.step) for row in rows if row.relmse and row.psnr_db is not None]
    if not judged:
        return None
    relmse, psnr_db, step = min(judged)
    if judged[-1][0] < _CLEARLY_WORSE * relmse:
        return None
    return f"validation was best at step {step:,}, {psnr_db:.1f} dB: try more samples, or --early-stop 3"


def _summary(job: TrainJob, finished: Finished, shipped: Figures) -> dict[str, Any]:
    held_out = finished.held_out
    return {
        "data": str(job.data),
        "out": str(job.out),
        "log": str(job.beside(".training.csv")),
        "curves": str(job.beside(".training.svg")),
        "complete": finished.why != "stopped",
        "ended_by": finished.why,
        "samples": finished.n_samples,
        "steps": finished.step,
        "batch_size": job.options.batch_size,
        "loss": finished.loss,
        "validation": shipped.to_json(),
        "validation_before_rounding": finished.figures.to_json(),
        "held_out_blocks": held_out.to_json() if held_out is not None else None,
        "setbacks": finished.n_setbacks,
        "samples_per_s": finished.samples_per_s,
        "train_s": round(finished.spent_s, 3),
        "parameters": finished.spec.n_parameters,
        "scale": finished.frame.scale,
        "spec": spec_to_dict(finished.spec),
    }
