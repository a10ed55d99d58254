"""A whole evaluation: references, the field and its rivals in pictures and in space, files."""

from __future__ import annotations

import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from irradia.cli.eval_baselines import Baseline
from irradia.cli.eval_options import EvalJob, PictureOptions
from irradia.core.errors import InputError
from irradia.core.progress import Progress
from irradia.core.rng import Seed
from irradia.scene.types import Camera, Scene

if TYPE_CHECKING:
    from irradia.cli.eval_reference import Reference
    from irradia.cli.eval_space import SpaceSamples
    from irradia.field.evaluation import LeakRatio, PictureScores, SpaceScores
    from irradia.field.field import Field
    from irradia.field.native_fields import StoredField
    from irradia.transport.render import RenderOptions

F32 = NDArray[np.float32]
STALE = ("eval.json", "eval.html", "view*.png", "view*.reference.hdr", "error*.png")


@dataclass(frozen=True)
class View:
    """One camera's picture of one rival.

    Attributes:
        picture: (H, W, 3) linear radiance.
    """

    picture: F32
    scores: PictureScores


@dataclass(frozen=True)
class Judged:
    """One way to store the light, judged.

    Attributes:
        key, name, n_bytes: As of the baseline.
        views: By camera.
        space, leaks: None where it knows only surfaces, or nothing was drawn in space.
    """

    key: str
    name: str
    n_bytes: int
    views: tuple[View, ...]
    space: SpaceScores | None = None
    leaks: LeakRatio | None = None

    @property
    def flip(self) -> float | None:
        """Mean over the cameras."""
        return float(np.mean([v.scores.flip.value for v in self.views])) if self.views else None

    @property
    def relmse(self) -> float | None:
        """Mean over the cameras, the reference's noise removed."""
        return float(np.mean([v.scores.relmse_noise_free for v in self.views])) if self.views else None


@dataclass(frozen=True)
class Evaluation:
    """Everything that was found.

    Attributes:
        scene: The lights that the field leaves out are live in it.
        stored: The field as its file holds it.
        cameras, references: What pictures were compared with.
        rivals: The field first.
        queries_per_second: Of the field, on this machine.
        remarks: What makes its figures doubtful.
    """

    scene: Scene
    stored: StoredField
    cameras: tuple[Camera, ...]
    references: tuple[Reference, ...]
    rivals: tuple[Judged, ...]
    queries_per_second: float
    remarks: tuple[str, ...] = ()


def run_eval(job: EvalJob, progress: Progress) -> dict[str, Any]:
    """Evaluates, writes everything to ``job.out`` and returns the content of ``eval.json``.

    Raises:
        InputError: A file or an option is wrong.
    """
    from irradia.bake.datasets.setting import in_quantity
    from irradia.cli.bake_job import open_scene
    from irradia.cli.eval_files import write_evaluation_files
    from irradia.cli.staging import staged_folder
    from irradia.field.files import read_field
    from irradia.transport import use_device

    start = time.perf_counter()
    use_device(job.device, job.threads)
    with staged_folder(job.out, stale=STALE) as folder:
        stored = read_field(job.weights)
        scene = open_scene(job.scene, job.load, job.light, progress, overrides=job.overrides, ies=job.ies)
        _check_box(stored.field, scene)
        remarks = tuple(_check_origin(job, stored, scene))
        for remark in remarks:
            progress.say(f"note: {remark}")
        scene = in_quantity(scene, stored.field.frame.quantity)
        found = replace(evaluate(job, scene, stored, progress), remarks=remarks)
        return write_evaluation_files(folder, job, found, progress, start)


def evaluate(
    job: EvalJob,
    scene: Scene,
    stored: StoredField,
    progress: Progress,
    views: Sequence[tuple[Camera, Reference]] = (),
) -> Evaluation:
    """Judges a field and its rivals.

    Args:
        job: What is asked for; files aside.
        scene: From :func:`irradia.bake.datasets.setting.in_quantity`.
        stored: The field that is judged, and its size.
        progress: Shows stages.
        views: Cameras whose references are there already; none renders those of ``job``.
    """
    from irradia.cli.eval_space import space_samples
    from irradia.field.backends import backend
    from irradia.field.evaluation import queries_per_second

    field, n_bytes = stored.field, stored.n_bytes
    views = views or [
        (camera, _reference(job, scene, camera, progress)) for camera in _cameras(scene, job.pictures)
    ]
    cameras, references = (tuple(part) for part in zip(*views, strict=True))
    samples = space_samples(job, scene, field, progress)
    shown = [
        Baseline("field", "neural field", n_bytes, field.irradiance),
        *_baselines(job, scene, n_bytes, progress),
    ]
    shown = _as_noisy(scene, shown)
    seen = _seen(job, scene, cameras, references)
    rivals = tuple(_judge(job, scene, each, seen, samples, progress) for each in shown)
    with progress.stage("queries"):
        evaluator = backend(field.backend_name, field.spec).evaluator(field.spec, field.parameters)
        speed = queries_per_second(evaluator, directional=field.spec.mode == "irradiance")
    return Evaluation(scene, stored, cameras, references, rivals, speed)


def _as_noisy(scene: Scene, rivals: list[Baseline]) -> list[Baseline]:
    """The rivals with the samples per pixel of the least where lights are live: these are noisy for all."""
    if all(light.mode in ("baked", "off") for light in scene.lights):
        return rivals
    least = min(rival.most_spp for rival in rivals)
    return [replace(rival, most_spp=least) for rival in rivals]


@dataclass(frozen=True)
class _Seen:
    """What rivals are judged by from one camera: the reference, and (H, W) which pixels show the scene."""

    camera: Camera
    reference: Reference
    pixels: NDArray[np.bool_]


def _seen(
    job: EvalJob, scene: Scene, cameras: Sequence[Camera], references: Sequence[Reference]
) -> list[_Seen]:
    from irradia.transport.gbuffer import pixels_of_scene

    return [
        _Seen(camera, reference, pixels_of_scene(scene, camera, _render_options(job, camera, 1, "picture")))
        for camera, reference in zip(cameras, references, strict=True)
    ]


def _judge(
    job: EvalJob,
    scene: Scene,
    rival: Baseline,
    seen: Sequence[_Seen],
    samples: SpaceSamples | None,
    progress: Progress,
) -> Judged:
    from irradia.field.evaluation import leak_ratio, score_in_space, score_picture

    views = []
    for view in seen:
        picture = _picture(job, scene, rival, view.camera, progress)
        scores = score_picture(picture, view.reference.first, view.reference.second, view.pixels)
        views.append(View(picture, scores))
    if samples is None or rival.irradiance is None:
        return Judged(rival.key, rival.name, rival.n_bytes, tuple(views))
    with progress.stage(f"{rival.name} in space"):
        values = rival.irradiance(samples.positions, samples.normals)
    evenly = samples.evenly
    space = score_in_space(values[evenly], samples.irradiance[evenly], samples.variance[evenly])
    kept = ~samples.beside_lamps
    leaks = leak_ratio(values[kept], samples.irradiance[kept], samples.variance[kept], samples.wall_m[kept])
    return Judged(rival.key, rival.name, rival.n_bytes, tuple(views), space, leaks)


def _picture(job: EvalJob, scene: Scene, rival: Baseline, camera: Camera, progress: Progress) -> F32:
    from irradia.transport.gbuffer import picture_under
    from irradia.transport.render import render

    options = _render_options(job, camera, min(job.pictures.spp, rival.most_spp), "picture")
    if rival.irradiance is None:
        return render(scene, camera, options, lightmap=rival.lightmap, progress=progress)
    return picture_under(scene, camera, options, rival.irradiance, progress, name=rival.name)


def _reference(job: EvalJob, scene: Scene, camera: Camera, progress: Progress) -> Reference:
    from irradia.cli.eval_reference import render_reference

    options = _render_options(job, camera, job.pictures.reference_spp, "reference")
    return render_reference(scene, camera, options, progress)


def _render_options(job: EvalJob, camera: Camera, spp: int, stream: str) -> RenderOptions:
    from irradia.cli.bake_views import picture_size
    from irradia.transport.render import RenderOptions

    width, height = picture_size(camera.aspect, job.pictures.n_pixels)
    return RenderOptions(width, height, spp, seed=Seed(job.seed).child(stream).uint32())


def _cameras(scene: Scene, options: PictureOptions) -> tuple[Camera, ...]:
    """Those asked for, else all of the scene's, else one that frames it."""
    from irradia.scene.framing import camera_from_spec

    if options.cameras:
        return tuple(camera_from_spec(scene, spec) for spec in options.cameras)
    return scene.cameras or (camera_from_spec(scene, "auto"),)


def _baselines(job: EvalJob, scene: Scene, n_bytes: int, progress: Progress) -> list[Baseline]:
    from irradia.cli.eval_baselines import make_baseline

    made = (make_baseline(key, scene, n_bytes, progress, job.seed) for key in job.baselines)
    return [baseline for baseline in made if baseline is not None]


def _check_box(field: Field, scene: Scene) -> None:
    """Refuses a field of somewhere else.

    Raises:
        InputError: The field's box and the scene's don't meet.
    """
    from irradia.scene.merge import merge

    positions = merge(scene).positions
    low, high = field.frame.aabb
    if (positions.max(axis=0) < low).any() or (positions.min(axis=0) > high).any():
        raise InputError(
            "this field was trained for another scene: their boxes don't meet",
            where="--scene",
            fix="Give the scene that its samples were drawn from.",
        )


def _check_origin(job: EvalJob, stored: StoredField, scene: Scene) -> Iterator[str]:
    """Refuses a field, or samples to judge it by, of another scene or light; with ``force`` remarks on it.

    Raises:
        InputError: It says what differs from what ``job`` asks for.
    """
    from irradia.cli.origin import scene_origin
    from irradia.formats.sample_origin import difference
    from irradia.formats.samples import open_samples

    here = scene_origin(job, scene)
    origins = {"this field was trained in": ("WEIGHTS", stored.provenance.get("samples"))}
    if job.space.samples is not None:
        samples = open_samples(job.space.samples, job.space.bin_samples)
        origins["these samples are of"] = ("--samples", samples.info.provenance)
    for what, (where, origin) in origins.items():
        problem = difference(here, origin)
        if problem and not job.force:
            raise InputError(
                f"{what} another scene or light: {problem}",
                where=where,
                fix="Give --scene and its light as they were sampled, or --force to judge it all the same.",
            )
        if problem:
            yield f"{what} another scene or light: {problem}"
