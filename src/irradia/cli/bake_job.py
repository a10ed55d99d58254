"""A whole bake: scene, layout, light, references, files. ``bake`` and ``demo`` both run it."""

from __future__ import annotations

import time
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

from irradia.bake.lightmap import BakeOptions, LightmapResult
from irradia.cli.bake_views import View, ViewOptions
from irradia.cli.lighting import LightOptions, light_scene
from irradia.cli.staging import staged_folder
from irradia.core.device import DeviceChoice
from irradia.core.progress import Progress
from irradia.scene.layout import LightmapLayout
from irradia.scene.lightmap_uv.options import LayoutOptions
from irradia.scene.load import LoadOptions
from irradia.scene.types import Scene

# What a bake may leave in its folder; what is left of an earlier run must not stand beside it.
PRODUCTS = ("lightmap*.exr", "preview*.png", "view.png", "scene.baked.glb", "bake.json", "report.html")


@dataclass(frozen=True)
class BakeJob:
    """Everything that decides a bake.

    Attributes:
        scene: A file or ``builtin:NAME``.
        out: Folder for the results.
        views: The report's pictures; None leaves the report out.
        compatible: Writes instances out, for loaders that read neither them nor our extension.
    """

    scene: str
    out: Path
    load: LoadOptions = field(default_factory=LoadOptions)
    light: LightOptions = field(default_factory=LightOptions)
    layout: LayoutOptions = field(default_factory=LayoutOptions)
    bake: BakeOptions = field(default_factory=BakeOptions)
    views: ViewOptions | None = field(default_factory=ViewOptions)
    compatible: bool = False
    device: DeviceChoice = "auto"
    threads: int | None = None

    def config(self) -> dict[str, Any]:
        """Every choice as plain values; files by their names, since folders differ between machines."""
        plain = asdict(self)
        plain["scene"] = Path(self.scene).name
        plain["light"]["env"] = self.light.env.name if self.light.env else None
        del plain["out"]
        return plain


@dataclass(frozen=True)
class Baked:
    """A finished bake that is not yet written.

    Attributes:
        bake_s: Wall time from opening the file to the finished pages.
        view: For the report, rendered after that.
    """

    scene: Scene
    layout: LightmapLayout
    result: LightmapResult
    bake_s: float
    view: View | None


@dataclass(frozen=True)
class BakeSummary:
    """What a command says of a bake.

    Attributes:
        record: The content of ``bake.json``.
        files: Names of the files in the folder.
    """

    record: dict[str, Any]
    files: tuple[str, ...]


def run_bake(job: BakeJob, progress: Progress) -> BakeSummary:
    """Bakes and writes everything to ``job.out``, which is whole afterwards or as it was before.

    Raises:
        InputError: Something in the file or among the options is wrong.
    """
    from irradia.cli.bake_files import write_products
    from irradia.transport import use_device

    start = time.perf_counter()
    use_device(job.device, job.threads)
    with staged_folder(job.out, stale=PRODUCTS) as folder:
        baked = _bake(job, progress)
        record = write_products(folder, job, baked, progress, start)
        files = tuple(sorted(path.name for path in folder.iterdir()))
    return BakeSummary(record, files)


def open_scene(spec: str, load: LoadOptions, light: LightOptions, progress: Progress) -> Scene:
    """The scene as it will be lit; says what the user should know of it."""
    from irradia.scene.load import load_scene

    with progress.stage("scene"):
        scene = light_scene(load_scene(spec, load), light)
    for note in scene.notes:
        progress.say(f"note: {note}")
    return scene


def _bake(job: BakeJob, progress: Progress) -> Baked:
    from irradia.bake.lightmap import bake_lightmap
    from irradia.scene.lightmap_uv import layout_lightmap

    start = time.perf_counter()
    scene = open_scene(job.scene, job.load, job.light, progress)
    layout = layout_lightmap(scene, job.layout, progress)
    for note in layout.notes:
        progress.say(note)
    result = bake_lightmap(scene, layout, job.bake, progress)
    bake_s = time.perf_counter() - start
    if job.views is None:
        return Baked(scene, layout, result, bake_s, None)
    from irradia.cli.bake_views import render_view
    from irradia.transport.render import BakedLight

    view = render_view(scene, BakedLight(layout, result.pages), job.views, progress)
    return Baked(scene, layout, result, bake_s, view)
