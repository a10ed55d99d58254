"""A field from a finished bake: sampled under its lightmap, trained, rounded, judged."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from threading import Event
from typing import TYPE_CHECKING, Any

import numpy as np

from irradia.cli.eval_options import EvalJob, PictureOptions, SpaceOptions
from irradia.core.errors import InternalError
from irradia.core.progress import Progress
from irradia.field.spec import Quantity

if TYPE_CHECKING:
    from irradia.bake.datasets import BakedPages
    from irradia.cli.bake_views import View, ViewOptions
    from irradia.field.field import Field
    from irradia.field.quantised import QuantisedField
    from irradia.field.spec import FieldSpec
    from irradia.field.training import TrainOptions
    from irradia.formats.samples import SampleFile
    from irradia.report import FieldSummary, Rival
    from irradia.scene.types import Scene

FILE = "field.safetensors.zst"
_VALIDATION_POINTS = 4096
_SPACE = SpaceOptions(count=1024, rays=256)


@dataclass(frozen=True)
class FieldOptions:
    """How to make a field.

    Attributes:
        preset: Of :data:`irradia.field.presets.PRESETS`.
        quantity: ``indirect`` leaves the first bounce of punctual lights to whoever draws.
        n_samples: Points in space and on surfaces.
        rays: At each.
        train_s: Seconds of training, before tables are rounded.
        seed: Root of all random numbers.
    """

    preset: str = "hash-200kB"
    quantity: Quantity = "indirect"
    n_samples: int = 300_000
    rays: int = 32
    train_s: float = 20.0
    seed: int = 0


@dataclass(frozen=True)
class FinishedField:
    """A field on its way to a bake's folder.

    Attributes:
        data: Content of its file.
        summary: For the report.
        record: For ``bake.json``.
    """

    data: bytes
    summary: FieldSummary
    record: dict[str, Any]


def field_of_bake(
    scene: Scene,
    lightmap: BakedPages,
    view: View,
    views: ViewOptions,
    options: FieldOptions,
    origin: Mapping[str, Any],
    progress: Progress,
) -> FinishedField:
    """Makes a field from a bake's lightmap, and judges it by the references of the bake's report.

    Args:
        scene: As it was baked.
        lightmap: Of all light.
        view: The bake's.
        views: How that was rendered.
        options: How to make the field.
        origin: Of the scene; see :func:`irradia.cli.origin.scene_origin`.
        progress: Shows stages.
    """
    from irradia.bake.datasets.setting import in_quantity
    from irradia.cli.eval_files import rival_record, summary
    from irradia.cli.eval_job import evaluate
    from irradia.cli.eval_reference import Reference
    from irradia.field.native_fields import decode_field, encode_field

    made = make_field(scene, lightmap, options, progress)
    data = encode_field(made, {"field": asdict(options), "samples": dict(origin)}, compress=True)
    pictures = PictureOptions(reference_spp=views.reference_spp, n_pixels=views.n_pixels)
    job = EvalJob(
        Path(FILE), scene.name, Path(), pictures=pictures, space=_SPACE, baselines=(), seed=options.seed
    )
    seen = [(view.camera, Reference(*view.halves))]
    found = evaluate(job, in_quantity(scene, options.quantity), decode_field(data), progress, seen)
    shown = summary(job, found)
    shown = replace(shown, rivals=(*shown.rivals, _lightmap_rival(lightmap, view)))
    record = {"options": asdict(options), **rival_record(found.rivals[0])}
    return FinishedField(data, shown, record)


def _lightmap_rival(lightmap: BakedPages, view: View) -> Rival:
    """The map that the field was made from, as shipped."""
    from irradia.formats.ktx2 import encode_ktx2
    from irradia.report import Rival

    n_bytes = len(encode_ktx2(lightmap.pages, "rgb9e5"))
    height, width = lightmap.pages.shape[1:3]
    name = f"lightmap, {width} × {height}, as KTX2"
    return Rival(name, n_bytes, view.comparison.flip, view.relmse_noise_free)


def make_field(
    scene: Scene, lightmap: BakedPages, options: FieldOptions, progress: Progress
) -> QuantisedField | Field:
    """Samples a scene's space, trains a preset and rounds its tables.

    Args:
        scene: As it was baked.
        lightmap: Of all light.
        options: How.
        progress: Shows stages.
    """
    from irradia.field.presets import preset
    from irradia.field.quantise import FinishOptions, finish

    chosen = preset(options.preset)
    samples, validation = draw_samples(scene, lightmap, options, progress)
    how = chosen.training(options.train_s, options.seed)
    trained = _train(chosen.spec, samples, validation, how, progress)
    if chosen.bits is None:
        return trained
    finishing = FinishOptions(batch_size=chosen.batch_size, seed=options.seed)
    return finish(trained, chosen.bits, samples, finishing, progress=progress)


def draw_samples(
    scene: Scene, lightmap: BakedPages, options: FieldOptions, progress: Progress
) -> tuple[SampleFile, SampleFile]:
    """Samples to learn from and to be judged by, in memory."""
    from irradia.bake.datasets import SampleOptions, sample_info, sample_rows, set_up
    from irradia.formats.samples import SampleFile

    asked = SampleOptions(
        "volume",
        options.n_samples,
        quantity=options.quantity,
        samples=options.rays,
        seed=options.seed,
    )
    setting = set_up(scene, asked, lightmap, progress)
    files = []
    for name, how in (("train", asked), ("validation", asked.for_validation(_VALIDATION_POINTS))):
        rows = []
        with progress.stage(f"light to {name}", how.n_points, "points") as stage:
            for part in sample_rows(setting, how, name):
                rows.append(part)
                stage.advance(len(part))
        files.append(SampleFile(Path(name), sample_info(setting, how, {}), np.concatenate(rows)))
    return files[0], files[1]


def _train(
    spec: FieldSpec, samples: SampleFile, validation: SampleFile, how: TrainOptions, progress: Progress
) -> Field:
    from irradia.cli.train_view import shown
    from irradia.field.field import Field
    from irradia.field.training import Finished, TrainContext, train

    stopped = Event()
    events = train(samples, spec, how, TrainContext(validation, stop=stopped.is_set))
    finished = None
    for event in shown(events, how, progress, stopped.set):
        if isinstance(event, Finished):
            finished = event
    if finished is None:
        raise InternalError("a training ended without saying so")
    return Field(finished.spec, finished.frame, finished.parameters)
