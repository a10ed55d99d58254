"""Writes what an evaluation found: pictures, error maps, eval.json and a page to look at."""

from __future__ import annotations

import json
import time
from pathlib import Path
from typing import Any

import numpy as np

from irradia.cli.eval_job import Evaluation, Judged, View
from irradia.cli.eval_options import EvalJob
from irradia.cli.memory import peak_memory_bytes
from irradia.cli.origin import scene_inputs
from irradia.core import provenance
from irradia.core.colour import automatic_exposure_ev, picture_srgb8
from irradia.core.files import write_text_atomic
from irradia.core.progress import Progress
from irradia.export.web_views import KEY, write_views
from irradia.field.cost import counted_cost
from irradia.field.native_fields import StoredField
from irradia.field.registry import spec_to_dict
from irradia.report import Comparison, EvaluationData, FieldSummary, Rival, text, write_evaluation
from irradia.report.pictures import error_colours
from irradia.scene.types import Camera

_PLAIN_BITS = {"fp16": 16, "fp32": 32}
SCORES = {"flip": "flip", "psnr": "psnr_db", "relmse": "relmse", "mean_ratio": "mean_ratio", "p95": "p95"}


def write_evaluation_files(
    folder: Path, job: EvalJob, found: Evaluation, progress: Progress, start: float
) -> dict[str, Any]:
    """Writes all files to ``folder`` and returns the content of ``eval.json``.

    Args:
        folder: Where to.
        job: What was asked for.
        found: What was found.
        progress: Has kept the times of stages.
        start: ``time.perf_counter()`` when the command began.
    """
    with progress.stage("files"):
        for number in range(len(found.cameras)):
            _write_pictures(folder, job, found, number)
        pictures = [reference.mean for reference in found.references]
        views = write_views(folder, found.cameras, pictures, job.pictures.reference_spp)
    notes = tuple(_notes(found))
    record = evaluation_record(job, found, progress, time.perf_counter() - start)
    record |= {"notes": list(notes), KEY: views}
    data = EvaluationData(
        found.scene.name, summary(job, found), record["stage_s"], record["provenance"], notes
    )
    write_evaluation(folder / "eval.html", data)
    write_text_atomic(folder / "eval.json", json.dumps(_finite(record), indent=2, allow_nan=False) + "\n")
    return record


def evaluation_record(job: EvalJob, found: Evaluation, progress: Progress, wall_s: float) -> dict[str, Any]:
    """Everything as plain values."""
    from irradia.transport.backend import device

    field = found.stored.field
    origin = provenance.record(
        "eval",
        job.config(),
        seed=job.seed,
        inputs={
            job.weights.name: provenance.sha256_file(job.weights),
            **scene_inputs(job, found.scene),
        },
        device=device,
        wall_s=wall_s,
    )
    return {
        "scene": found.scene.name,
        "field": {
            "spec": spec_to_dict(field.spec),
            "quantity": field.frame.quantity,
            "n_parameters": field.spec.n_parameters,
            "n_bytes": found.rivals[0].n_bytes,
        },
        "cameras": [camera.name or f"camera {i}" for i, camera in enumerate(found.cameras)],
        "reference_spp": job.pictures.reference_spp,
        "exposure_ev": [exposure_of(job, found, i) for i in range(len(found.cameras))],
        "rivals": [rival_record(rival) for rival in found.rivals],
        "query": {
            "million_per_second": found.queries_per_second / 1e6,
            **query_record(found.stored),
        },
        "stage_s": {name: round(seconds, 4) for name, seconds in progress.seconds.items()},
        "peak_memory_bytes": peak_memory_bytes(),
        "provenance": origin.to_dict(),
    }


def summary(job: EvalJob, found: Evaluation) -> FieldSummary:
    """What a report shows of it."""
    comparisons = tuple(
        _comparison(job, found, number, camera) for number, camera in enumerate(found.cameras)
    )
    rivals = tuple(
        Rival(
            rival.name,
            rival.n_bytes,
            rival.flip,
            rival.relmse,
            rival.space.mse_noise_free if rival.space else None,
            under_noise=bool(rival.views) and all(view.scores.flip.is_noise for view in rival.views),
        )
        for rival in found.rivals
    )
    return FieldSummary(_facts(found), comparisons, rivals)


def exposure_of(job: EvalJob, found: Evaluation, number: int) -> float:
    """Stops at which a camera's pictures are shown."""
    chosen = job.pictures.exposure_ev
    return automatic_exposure_ev(found.references[number].mean) if chosen is None else chosen


def query_record(stored: StoredField) -> dict[str, float | None]:
    """What a query costs by formula, as plain values; None where nobody has counted."""
    cost = counted_cost(stored.field.spec)
    if cost is None:
        return dict.fromkeys(("flops", "encoding_bytes", "network_bytes"))
    return {
        "flops": cost.flops,
        "encoding_bytes": cost.encoding_bytes(_encoding_bits(stored)),
        "network_bytes": cost.network_values * _PLAIN_BITS[stored.precision] / 8,
    }


def _encoding_bits(stored: StoredField) -> int:
    """Of a value of the encoding, the widest where they differ."""
    if stored.tensors:
        return max(tensor.bits for tensor in stored.tensors.values())
    return _PLAIN_BITS[stored.precision]


def _facts(found: Evaluation) -> tuple[tuple[str, str], ...]:
    field, judged = found.stored.field, found.rivals[0]
    cost = query_record(found.stored)
    facts = [
        ("Encoding", field.spec.position.name),
        ("Network", f"{field.spec.n_hidden_layers} × {field.spec.width}, {field.spec.activation}"),
        ("Parameters", text.count(field.spec.n_parameters)),
        ("Size as shipped", text.size(judged.n_bytes)),
        ("Light", field.frame.quantity),
        ("Queries here", text.rate(found.queries_per_second, "queries/s")),
        ("Operations a query", _count(cost["flops"])),
        ("Bytes touched a query, encoding", _count(cost["encoding_bytes"])),
    ]
    if judged.leaks is not None:
        ratio = judged.leaks.ratio
        facts.append(("Leak ratio", "–" if ratio is None else f"{ratio:.2f}"))
    return tuple(facts)


def _comparison(job: EvalJob, found: Evaluation, number: int, camera: Camera) -> Comparison:
    view = found.rivals[0].views[number]
    scores = {name: getattr(view.scores, key).value for name, key in SCORES.items()}
    scores["relmse_noise_free"] = view.scores.relmse_noise_free
    hidden = frozenset(name for name, key in SCORES.items() if getattr(view.scores, key).is_noise)
    return Comparison(
        name=f"{camera.name or f'camera {number}'}, neural field",
        baked=view.picture,
        reference=found.references[number].mean,
        full=None,
        flip=view.scores.error,
        scores=scores,
        reference_spp=job.pictures.reference_spp,
        label="Neural field",
        under_noise=hidden,
        exposure_ev=exposure_of(job, found, number),
    )


def rival_record(rival: Judged) -> dict[str, Any]:
    """One rival's figures as plain values."""
    return {
        "key": rival.key,
        "name": rival.name,
        "n_bytes": rival.n_bytes,
        "flip": rival.flip,
        "views": [view.scores.to_json() for view in rival.views],
        "space": rival.space.to_json() if rival.space else None,
        "leaks": vars(rival.leaks) if rival.leaks else None,
    }


def _notes(found: Evaluation) -> list[str]:
    """What makes figures doubtful, and that a reference is too noisy, where it is."""
    views = zip(found.cameras, found.rivals[0].views, strict=True)
    hidden = [
        camera.name or f"camera {i}" for i, (camera, view) in enumerate(views) if view.scores.flip.is_noise
    ]
    if not hidden:
        return list(found.remarks)
    names = ", ".join(hidden)
    return [
        *found.remarks,
        f"The reference's own noise hides HDR-FLIP in {names}; more samples per pixel would show it.",
    ]


def _write_pictures(folder: Path, job: EvalJob, found: Evaluation, number: int) -> None:
    """The field's picture, the reference, and the errors of every rival."""
    from irradia.formats.png import write_png

    exposure_ev = exposure_of(job, found, number)
    view: View = found.rivals[0].views[number]
    write_png(folder / f"view{number}.field.png", picture_srgb8(view.picture, exposure_ev))
    reference = found.references[number].mean
    write_png(folder / f"view{number}.reference.png", picture_srgb8(reference, exposure_ev))
    for rival in found.rivals:
        write_png(folder / f"error{number}.{rival.key}.png", error_colours(rival.views[number].scores.error))


def _finite(value: Any) -> Any:
    """JSON knows neither NaN nor infinity."""
    if isinstance(value, float):
        return value if np.isfinite(value) else None
    if isinstance(value, dict):
        return {key: _finite(each) for key, each in value.items()}
    return [_finite(each) for each in value] if isinstance(value, (list, tuple)) else value


def _count(value: float | None) -> str:
    return "–" if value is None else text.count(value)
