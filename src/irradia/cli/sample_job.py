"""A whole sampling: scene, lightmap, points and their light, files."""

from __future__ import annotations

import json
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

from irradia.bake.datasets.options import SampleOptions
from irradia.cli.lighting import LightOptions
from irradia.cli.origin import scene_config, scene_inputs
from irradia.core import provenance
from irradia.core.device import DeviceChoice
from irradia.core.errors import InputError
from irradia.core.progress import Progress
from irradia.scene.lightmap_uv.options import LayoutOptions
from irradia.scene.load import LoadOptions

if TYPE_CHECKING:
    from irradia.bake.datasets import BakedPages
    from irradia.scene.types import Scene

SUFFIXES = (".samples", ".bin")
DEFAULT_VALIDATION = 16_384


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


def run_sampling(job: SampleJob, progress: Progress) -> dict[str, Any]:
    """Writes the dataset, and before it the one by which a field trained from it is judged.

    Returns:
        What was made, plain values; ``complete`` is False where Ctrl-C ended it early: what has been
        written by then is usable.

    Raises:
        InputError: Something in the file or among the options is wrong.
    """
    from irradia.bake.datasets import set_up
    from irradia.cli.sample_files import write_datasets
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


def _origin(job: SampleJob, inputs: dict[str, str]) -> dict[str, Any]:
    """What a file tells of how it was made; the same for the same samples."""
    from irradia.transport.backend import device

    origin = provenance.record(
        "sample", job.config(), seed=job.options.seed, inputs=inputs, device=device, wall_s=0.0
    )
    return json.loads(json.dumps(origin.reproducible()))
