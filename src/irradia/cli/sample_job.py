"""A whole sampling: scene, lightmap, points and their light, files."""

from __future__ import annotations

import json
import time
from collections.abc import Mapping
from contextlib import ExitStack
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
    from irradia.formats.samples import validation_path

    made: dict[str, Any] = {}
    judge_path = validation_path(out.with_suffix(".samples"))
    earlier = finished_rows(out)
    with ExitStack() as files:
        judge = None
        if n_validation:
            better = options.for_validation(n_validation)
            judge = files.enter_context(_Growing(judge_path, plan, better))
            made["validation"] = judge.fill(_VALIDATION).to_dict(better.samples)
            if not earlier:
                judge.close(judge_path)  # so that a training that follows has it
        elif not earlier:
            judge_path.unlink(missing_ok=True)  # it would judge fields of these samples
        if plan.stopped.is_set():
            return made
        train = files.enter_context(_Growing(out, plan, options))
        tally = train.fill(_TRAIN)
        keep = plan.stopped.is_set() and earlier > tally.n_points
        target = out.with_name(f"{out.stem}.stopped{out.suffix}") if keep else out
        made |= tally.to_dict(options.samples) | {"path": str(target)}
        if keep:
            judge_path = validation_path(target.with_suffix(".samples"))
            made["kept"] = {"path": str(out), "points": earlier}
        if judge is None:
            judge_path.unlink(missing_ok=True)
        else:
            judge.close(judge_path)
            made["validation"]["path"] = str(judge_path)
        train.close(target)
    return made


def finished_rows(path: Path) -> int:
    """How many samples a finished dataset has; 0 where there is none that can be read."""
    from irradia.formats.samples import open_samples

    try:
        return len(open_samples(path)) if path.is_file() else 0
    except InputError:
        return 0


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
        from irradia.formats.samples import SampleWriter

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
            from irradia.formats.samples import open_samples
            from irradia.formats.samples_bin import write_samples_bin

            self._writer.close()
            write_samples_bin(target, open_samples(self._writer.path))
            self._writer.path.unlink()
        else:
            self._writer.close(target)
        self._closed = True

    def __enter__(self) -> _Growing:
        return self

    def __exit__(self, kind: object, *_: object) -> None:
        from irradia.formats.samples import part_path

        self._writer.abandon()
        if self._closed or (kind is not None and not self._is_bin):
            return
        part_path(self._writer.path).unlink(missing_ok=True)
        if self._is_bin:
            self._writer.path.unlink(missing_ok=True)


def _origin(job: SampleJob, inputs: dict[str, str]) -> dict[str, Any]:
    """What a file tells of how it was made; the same for the same samples."""
    from irradia.transport.backend import device

    origin = provenance.record(
        "sample", job.config(), seed=job.options.seed, inputs=inputs, device=device, wall_s=0.0
    )
    return json.loads(json.dumps(origin.reproducible()))
