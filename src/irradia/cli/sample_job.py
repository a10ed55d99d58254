"""A whole sampling: scene, lightmap, points and their light, files."""

from __future__ import annotations

import json
import time
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import asdict, dataclass, field
from pathlib import Path
from threading import Event
from typing import TYPE_CHECKING, Any

from irradia.bake.datasets.options import SampleOptions
from irradia.cli.lighting import LightOptions
from irradia.cli.origin import scene_config, scene_inputs
from irradia.core import provenance
from irradia.core.device import DeviceChoice
from irradia.core.errors import InputError
from irradia.core.interrupt import asks_first
from irradia.core.progress import Progress
from irradia.scene.lightmap_uv.options import LayoutOptions
from irradia.scene.load import LoadOptions

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from irradia.bake.datasets import BakedPages, Setting
    from irradia.scene.types import Scene

SUFFIXES = (".samples", ".bin")
DEFAULT_VALIDATION = 16_384
_TRAIN, _VALIDATION = "train", "validation"


@dataclass(frozen=True)
class SampleJob:
    """Everything that decides a dataset.

    Attributes:
        scene: A file or ``builtin:NAME``.
        out: The dataset; a ``.bin`` for the Unity project.
        layout: Of the lightmap that is baked for the rays to read.
        options: Which points.
        overrides: As in :class:`irradia.cli.bake_job.BakeJob`.
        ies: Likewise.
        lightmap: A finished bake to read instead: its folder or its ``scene.baked.glb``.
        validation: Points of the second file, which is of higher quality; 0 for none.
    """

    scene: str
    out: Path
    load: LoadOptions = field(default_factory=LoadOptions)
    light: LightOptions = field(default_factory=LightOptions)
    layout: LayoutOptions = field(default_factory=LayoutOptions)
    options: SampleOptions = field(default_factory=SampleOptions)
    overrides: tuple[str, ...] = ()
    ies: tuple[str, ...] = ()
    lightmap: Path | None = None
    validation: int = DEFAULT_VALIDATION
    device: DeviceChoice = "auto"
    threads: int | None = None

    def __post_init__(self) -> None:
        if self.out.suffix.lower() not in SUFFIXES:
            raise InputError(
                f"expected a name ending in {' or '.join(SUFFIXES)}, found {self.out.name!r}", where="-o"
            )
        if self.out.suffix.lower() == ".bin" and self.options.n_coefficients == 9:
            raise InputError("a .bin holds SH of order 1", where="--order 2", fix="Write a .samples file.")
        if self.lightmap is not None and self.options.integrator == "path":
            raise InputError("paths read no lightmap", where="--lightmap", fix="Use --integrator cached.")

    def config(self) -> dict[str, Any]:
        """Every choice as plain values; files by their names, since folders differ between machines."""
        plain = asdict(self) | scene_config(self)
        plain["lightmap"] = self.lightmap.name if self.lightmap else None
        del plain["out"]
        return plain


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


def run_sampling(job: SampleJob, progress: Progress) -> dict[str, Any]:
    """Writes the dataset, and before it the one by which a field trained from it is judged.

    Returns:
        What was made, plain values; ``complete`` is False where Ctrl-C ended it early: what has been
        written by then is usable.

    Raises:
        InputError: Something in the file or among the options is wrong.
    """
    from irradia.bake.datasets import set_up
    from irradia.transport import use_device

    use_device(job.device, job.threads)
    scene, lightmap, inputs = open_lit_scene(job, progress)
    setting = set_up(scene, job.options, lightmap, progress)
    made = write_datasets(job.out, setting, job.options, job.validation, _origin(job, inputs), progress)
    return {
        "scene": scene.name,
        "kind": job.options.placement,
        "quantity": job.options.quantity,
        "integrator": job.options.integrator,
        **made,
        "stage_s": {name: round(seconds, 4) for name, seconds in progress.seconds.items()},
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
    from irradia.formats.samples import validation_path

    stopped = Event()
    made: dict[str, Any] = {}
    with asks_first(stopped.set, progress.say):
        path = validation_path(out.with_suffix(".samples"))
        if n_validation:
            better = options.for_validation(n_validation)
            tally = _write(path, setting, better, _VALIDATION, origin, progress, stopped)
            made["validation"] = tally.to_dict(better.samples)
        else:
            path.unlink(missing_ok=True)  # an earlier one would judge fields of these samples
        if not stopped.is_set():
            tally = _write(out, setting, options, _TRAIN, origin, progress, stopped)
            made.update(tally.to_dict(options.samples))
    return {**made, "complete": not stopped.is_set()}


def open_lit_scene(job: SampleJob, progress: Progress) -> tuple[Scene, BakedPages | None, dict[str, str]]:
    """The scene, the lightmap that its rays read, and the hashes of what both come from."""
    from irradia.bake.datasets.light import bake_all_light
    from irradia.cli.bake_job import open_scene

    scene = open_scene(job.scene, job.load, job.light, progress, overrides=job.overrides, ies=job.ies)
    inputs = scene_inputs(job, scene)
    if job.options.integrator == "path":
        return scene, None, inputs
    if job.lightmap is None:
        options = job.options
        lightmap = bake_all_light(scene, job.layout, progress, seed=options.seed, fast_rays=options.fast_rays)
        return scene, lightmap, inputs
    from irradia.cli.sample_lightmap import read_all_light
    from irradia.scene.material_override import override_materials
    from irradia.scene.material_override_file import read_material_overrides

    scene, lightmap, path = read_all_light(job.lightmap, scene, job.load)
    if job.overrides:  # the baked file has the materials as they were
        scene = override_materials(scene, read_material_overrides(job.overrides))
    return scene, lightmap, inputs | {f"lightmap {path.name}": provenance.sha256_file(path)}


def _write(
    path: Path,
    setting: Setting,
    options: SampleOptions,
    name: str,
    origin: Mapping[str, Any],
    progress: Progress,
    stopped: Event,
) -> Tally:
    """One file; ends early where Ctrl-C asks for it."""
    from irradia.bake.datasets.generate import expected_points, sample_info, sample_rows
    from irradia.formats.samples import SampleWriter

    info, tally = sample_info(setting, options, origin), Tally(path)
    stage_name = "samples" if name == _TRAIN else f"samples for {name}"
    with (
        _streamed(path) as file,
        progress.stage(stage_name, expected_points(setting, options), "points") as stage,
        SampleWriter(file, info) as writer,
    ):
        start = time.perf_counter()
        for rows in sample_rows(setting, options, name):
            writer.append(rows)
            tally.add(rows, info.n_columns - 1 - info.n_values)
            stage.advance(len(rows))
            if stopped.is_set():
                break
        tally.seconds = time.perf_counter() - start
    return tally


@contextmanager
def _streamed(path: Path) -> Iterator[Path]:
    """Where rows go: the file itself, or one beside a ``.bin`` that becomes it in the end."""
    if path.suffix.lower() != ".bin":
        yield path
        return
    from irradia.formats.samples import open_samples, part_path
    from irradia.formats.samples_bin import write_samples_bin

    beside = path.with_name(f"{path.name}.samples")
    try:
        yield beside
        write_samples_bin(path, open_samples(beside))
    finally:
        for left in (beside, part_path(beside)):
            left.unlink(missing_ok=True)


def _origin(job: SampleJob, inputs: dict[str, str]) -> dict[str, Any]:
    """What a file tells of how it was made; the same for the same samples."""
    from irradia.transport.backend import device

    origin = provenance.record(
        "sample", job.config(), seed=job.options.seed, inputs=inputs, device=device, wall_s=0.0
    )
    return json.loads(json.dumps(origin.reproducible()))
