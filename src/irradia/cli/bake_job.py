"""A whole bake: scene, layout, light, references, files. ``bake`` and ``demo`` both run it."""

from __future__ import annotations

import json
import math
import time
from collections.abc import Sequence
from dataclasses import asdict, dataclass, field, replace
from pathlib import Path
from typing import Any, Literal

from irradia import __version__
from irradia.bake.lightmap import BakeOptions, LightmapBake, LightmapResult, Selection
from irradia.bake.occlusion import OcclusionOptions
from irradia.bake.probes.options import ProbeOptions
from irradia.bake.rebake import Memory, Update
from irradia.bake.shards import Shard
from irradia.bake.texels import TexelSet
from irradia.cli.bake_update import Revision
from irradia.cli.bake_views import View, ViewOptions
from irradia.cli.field_job import FieldOptions, FinishedField
from irradia.cli.lighting import LightOptions, light_scene
from irradia.cli.origin import scene_config, scene_hash, scene_origin
from irradia.cli.staging import staged_folder
from irradia.core import provenance
from irradia.core.device import DeviceChoice
from irradia.core.progress import Progress
from irradia.formats.probes import ProbeSet
from irradia.scene.layout import LightmapLayout
from irradia.scene.lightmap_uv.options import LayoutOptions
from irradia.scene.load import LoadOptions
from irradia.scene.types import Scene

# What a bake may leave in its folder; what is left of an earlier run must not stand beside it.
PRODUCTS = (
    "lightmap*.exr",
    "lightmap*.hdr",
    "lightmap*.png",
    "lightmap*.ktx2",
    "occlusion*.*",
    "shadow_mask*.png",
    "probes.*",
    "field.*",
    "preview*.png",
    "view.png",
    "view*.reference.hdr",
    "view.html",
    "scene.baked.glb",
    "bake.json",
    "bake.memory",
    "report.html",
)
EndedBy = Literal["samples", "noise", "time", "interrupt"]

# Choices that change nothing of what is traced.
_NOT_TRACED = ("views", "threads", "device", "shard", "compatible", "probes", "neural_field", "formats")
_NOT_TRACED_OF_BAKE = ("time_s", "denoise", "seams", "direct_map")


@dataclass(frozen=True)
class BakeJob:
    """Everything that decides a bake.

    Attributes:
        scene: A file or ``builtin:NAME``.
        out: Folder for the results.
        views: The report's pictures; None leaves the report out.
        compatible: Writes instances out, for loaders that read neither them nor our extension.
        resume: Goes on from the state that a stopped bake has left in ``out``.
        checkpoint_s: How often that state is saved.
        view_first: Camera whose texels are finished first, as ``--camera`` names it.
        only: Names or patterns of the objects to bake.
        update: Bakes only what has changed since the last bake into ``out``, and keeps what the next
            such bake needs.
        overrides: Materials to replace; see :mod:`irradia.scene.material_override_file`.
        ies: Measured distributions for lights; see :mod:`irradia.scene.ies_option`.
        probes: Probes to bake as well, or None.
        neural_field: One to train from the lightmap, or None; needs ``views``.
        formats: Of the maps; names of :mod:`irradia.export.map_files`.
        occlusion: Bakes ambient occlusion in place of light.
        shard: (i, n): the part of the samples that this machine traces.
    """

    scene: str
    out: Path
    load: LoadOptions = field(default_factory=LoadOptions)
    light: LightOptions = field(default_factory=LightOptions)
    layout: LayoutOptions = field(default_factory=LayoutOptions)
    bake: BakeOptions = field(default_factory=BakeOptions)
    views: ViewOptions | None = field(default_factory=ViewOptions)
    compatible: bool = False
    resume: bool = False
    checkpoint_s: float = 60.0
    view_first: str | None = None
    only: tuple[str, ...] = ()
    update: bool = False
    overrides: tuple[str, ...] = ()
    ies: tuple[str, ...] = ()
    probes: ProbeOptions | None = None
    neural_field: FieldOptions | None = None
    formats: tuple[str, ...] = ("exr",)
    occlusion: OcclusionOptions | None = None
    shard: tuple[int, int] | None = None
    device: DeviceChoice = "auto"
    threads: int | None = None

    def config(self) -> dict[str, Any]:
        """Every choice as plain values; files by their names, since folders differ between machines."""
        plain = asdict(self) | scene_config(self)
        if self.occlusion is not None and self.occlusion.distance_m == math.inf:
            plain["occlusion"]["distance_m"] = "inf"  # which JSON has no number for
        for name in ("out", "resume", "checkpoint_s"):
            del plain[name]
        return plain


@dataclass(frozen=True)
class Baked:
    """A finished bake that is not yet written.

    Attributes:
        bake_s: Wall time from opening the file to the finished pages.
        view: For the report, rendered after that.
        complete: Whether the bake came to its end rather than being stopped.
        ended_by: "samples", "noise" or "time", whichever limit was reached; "interrupt" where none was.
        probes: Where they were asked for.
        memory: For the next ``--update``, where there is to be one.
        update: What an edit has asked for.
        neural_field: Where one was asked for.
    """

    scene: Scene
    layout: LightmapLayout
    result: LightmapResult
    bake_s: float
    view: View | None
    complete: bool
    ended_by: EndedBy
    probes: ProbeSet | None = None
    memory: Memory | None = None
    update: Update | None = None
    neural_field: FinishedField | None = None


@dataclass(frozen=True)
class BakeSummary:
    """What a command says of a bake.

    Attributes:
        record: The content of ``bake.json``.
        files: Names of the files in the folder.
        complete: See :class:`Baked`.
    """

    record: dict[str, Any]
    files: tuple[str, ...]
    complete: bool


def run_bake(job: BakeJob, progress: Progress, shards: Sequence[Shard] = ()) -> BakeSummary:
    """Bakes and writes everything to ``job.out``, which is whole afterwards or as it was before.

    Args:
        job: What to bake.
        progress: Shows stages.
        shards: What other machines have traced, in order; joined instead of tracing.

    Raises:
        InputError: Something in the file or among the options is wrong.
    """
    from irradia.cli.bake_checks import check_job
    from irradia.cli.bake_files import write_products
    from irradia.cli.bake_occlusion import run_occlusion
    from irradia.cli.bake_trace import forget
    from irradia.transport import use_device

    check_job(job)
    start = time.perf_counter()
    use_device(job.device, job.threads)
    if job.occlusion is not None:
        return run_occlusion(job, job.occlusion, progress)
    with staged_folder(job.out, stale=PRODUCTS) as folder:
        baked = _bake(job, progress, shards)
        record = write_products(folder, job, baked, progress, start)
        files = tuple(sorted(path.name for path in folder.iterdir()))
    if baked.complete:
        forget(job)
    return BakeSummary(record, files, baked.complete)


def open_scene(
    spec: str,
    load: LoadOptions,
    light: LightOptions,
    progress: Progress,
    *,
    overrides: Sequence[str] = (),
    ies: Sequence[str] = (),
) -> Scene:
    """The scene as it will be lit; says what the user should know of it."""
    from irradia.scene.ies_option import apply_ies
    from irradia.scene.load import load_scene
    from irradia.scene.material_override import override_materials
    from irradia.scene.material_override_file import read_material_overrides

    with progress.stage("scene"):
        scene = load_scene(spec, load)
        if overrides:
            scene = override_materials(scene, read_material_overrides(overrides))
        if ies:
            scene = apply_ies(scene, ies)
        scene = light_scene(scene, light)
    for note in scene.notes:
        progress.say(f"note: {note}")
    return scene


def run_shard(job: BakeJob, progress: Progress) -> Path:
    """Traces ``job.shard`` and writes it to ``job.out``; returns the file.

    Raises:
        InputError: Something in the file or among the options is wrong.
    """
    from irradia.bake.shards import write_shard
    from irradia.cli.bake_checks import check_job
    from irradia.cli.bake_trace import trace_shard
    from irradia.transport import use_device

    check_job(job)
    use_device(job.device, job.threads)
    scene, _, bake = _prepare(job, progress)
    shard = trace_shard(bake, job, identity(job, scene, bake.texels), progress)
    path = job.out / f"shard-{shard.number}-of-{shard.count}.npz"
    write_shard(path, shard)  # by itself, so that machines may share a folder
    return path


def _prepare(job: BakeJob, progress: Progress) -> tuple[Scene, LightmapLayout, LightmapBake]:
    from irradia.bake.lightmap import start_bake
    from irradia.scene.lightmap_uv import layout_lightmap

    scene = open_scene(job.scene, job.load, job.light, progress, overrides=job.overrides, ies=job.ies)
    selection = _selection(job, scene)
    layout = layout_lightmap(scene, job.layout, progress)
    for note in layout.notes:
        progress.say(note)
    return scene, layout, start_bake(scene, layout, job.bake, progress, selection)


def _bake(job: BakeJob, progress: Progress, shards: Sequence[Shard]) -> Baked:
    from irradia.bake.shards import join
    from irradia.cli.bake_trace import trace

    start = time.perf_counter()
    scene, layout, bake = _prepare(job, progress)
    same = identity(job, scene, bake.texels)
    revision = Revision.begin(job, scene, bake, progress)
    complete = True
    if shards:
        join(bake.bake, shards, same)
    else:
        complete = trace(bake, job, same, progress)
    memory = revision.fill_in(progress) if revision else None
    result = bake.result(progress)
    scene = replace(scene, lights=result.lights)
    probes = _probes(job, scene, layout, result, progress) if complete else None
    bake_s = time.perf_counter() - start
    baked = Baked(
        scene,
        layout,
        result,
        bake_s,
        None,
        complete,
        _ended_by(job, result.stats, complete),
        probes,
        memory if complete else None,
        revision.update if revision else None,
    )
    if job.views is None or not complete or job.bake.mode == "direct":
        return baked
    from irradia.bake.datasets import BakedPages
    from irradia.cli.bake_views import render_view
    from irradia.cli.field_job import field_of_bake
    from irradia.transport.render import BakedLight

    shown = result.pages if result.all_light is None else result.all_light
    view = render_view(scene, BakedLight(layout, shown), job.views, progress)
    made = None
    if job.neural_field is not None:
        lightmap = BakedPages(layout, shown)
        origin = scene_origin(job, scene)
        made = field_of_bake(scene, lightmap, view, job.views, job.neural_field, origin, progress)
    return replace(baked, view=view, neural_field=made)


def _ended_by(job: BakeJob, stats: dict[str, Any], complete: bool) -> EndedBy:
    if not complete:
        return "interrupt"
    if not stats["complete"]:
        return "time"
    target, found = job.bake.noise, stats["noise_p95"]
    return "noise" if target is not None and found is not None and found <= target else "samples"


def _probes(
    job: BakeJob, scene: Scene, layout: LightmapLayout, result: LightmapResult, progress: Progress
) -> ProbeSet | None:
    if job.probes is None:
        return None
    from irradia.bake.probes import bake_probes

    pages = result.pages if result.all_light is None else result.all_light
    return bake_probes(scene, layout, pages, job.probes, progress)


def _selection(job: BakeJob, scene: Scene) -> Selection:
    from irradia.scene.framing import camera_from_spec
    from irradia.scene.selection import select_instances

    view = None if job.view_first is None else camera_from_spec(scene, job.view_first, where="--view-first")
    only = select_instances(scene, job.only) if job.only else None
    return Selection(view=view, instances=only, shard=job.shard)


def identity(job: BakeJob, scene: Scene, texels: TexelSet) -> dict[str, Any]:
    """What must be the same for a stopped bake to go on as if it had never stopped: plain JSON values.

    How the finished light is written, and by when, is no part of it.
    """
    from irradia.scene.fingerprint import fingerprint
    from irradia.transport.backend import device

    config = job.config()
    for name in _NOT_TRACED:
        del config[name]
    for name in _NOT_TRACED_OF_BAKE:
        del config["bake"][name]
    same = {
        "scene": scene_hash(scene),
        "environment": environment_hash(scene),
        "overrides and profiles": fingerprint(scene) if job.overrides or job.ies else None,
        "texels": provenance.sha256_bytes(texels.pixel.tobytes()),
        "version": __version__,
        "device": device.kind,
        **{f"option {key}": value for key, value in config.items()},
    }
    return json.loads(json.dumps(same))  # as it comes back from a file: without tuples


def environment_hash(scene: Scene) -> str:
    """SHA-256 of the light from outside, or an empty text without."""
    return provenance.sha256_bytes(scene.environment.radiance.tobytes()) if scene.environment else ""
