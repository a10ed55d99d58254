"""``irradia bake --mode ao``: how open each texel is, in place of its light."""

from __future__ import annotations

import json
import time
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from irradia.bake.occlusion import OcclusionOptions
from irradia.bake.occlusion_map import OcclusionMap
from irradia.cli.bake_files import make_provenance, map_record
from irradia.cli.bake_job import PRODUCTS, BakeJob, BakeSummary, open_scene
from irradia.cli.memory import peak_memory_bytes
from irradia.cli.staging import staged_folder
from irradia.core.files import write_text_atomic
from irradia.core.progress import Progress
from irradia.formats.lightmap import LightmapFile, make_lightmap, page_path
from irradia.scene.layout import LightmapLayout
from irradia.scene.types import Scene

QUANTITY = "ambient_occlusion"


@dataclass(frozen=True)
class BakedOcclusion:
    """A finished bake that is not yet written."""

    scene: Scene
    layout: LightmapLayout
    found: OcclusionMap
    bake_s: float


def run_occlusion(job: BakeJob, options: OcclusionOptions, progress: Progress) -> BakeSummary:
    """Bakes ambient occlusion and writes everything to ``job.out``, whole or not at all.

    Raises:
        InputError: Something in the file or among the options is wrong.
    """
    start = time.perf_counter()
    with staged_folder(job.out, stale=PRODUCTS) as folder:
        baked = _bake(job, options, progress)
        record = _write(folder, job, options, baked, progress, start)
        files = tuple(sorted(path.name for path in folder.iterdir()))
    return BakeSummary(record, files, complete=True)


def _bake(job: BakeJob, options: OcclusionOptions, progress: Progress) -> BakedOcclusion:
    from irradia.bake.occlusion_map import bake_occlusion_map
    from irradia.scene.lightmap_uv import layout_lightmap

    start = time.perf_counter()
    unlit = replace(job.light, default_light=False)
    scene = open_scene(job.scene, job.load, unlit, progress, overrides=job.overrides)
    layout = layout_lightmap(scene, job.layout, progress)
    for note in layout.notes:
        progress.say(note)
    found = bake_occlusion_map(
        scene, layout, options, progress, fast_rays=job.bake.fast_rays, seams=job.bake.seams
    )
    return BakedOcclusion(scene, layout, found, time.perf_counter() - start)


def _write(
    folder: Path,
    job: BakeJob,
    options: OcclusionOptions,
    baked: BakedOcclusion,
    progress: Progress,
    start: float,
) -> dict[str, Any]:
    from irradia.export.glb import write_occlusion_glb
    from irradia.export.map_files import write_maps

    found = baked.found
    origin = make_provenance(job, baked.scene, time.perf_counter() - start)
    validity = found.texels.to_pages((1.0 - found.hidden_share).astype(np.float16))
    pages = make_lightmap(found.pages, found.coverage, origin.reproducible(), {"validity": validity})
    occlusion = replace(pages, quantity=QUANTITY, scale=1.0, exposure_ev=0.0)
    with progress.stage("files"):
        write_maps(folder, occlusion, job.formats, name="occlusion")
        _write_pictures(folder / "occlusion.png", occlusion)
        write_occlusion_glb(folder / "scene.baked.glb", baked.scene, baked.layout, found.pages)
    record = {
        "scene": baked.scene.name,
        "occlusion": {
            "samples_per_texel": options.samples,
            "distance_m": found.distance_m if np.isfinite(found.distance_m) else None,
            "mean": float(found.openness[found.valid].mean()) if found.valid.any() else None,
        },
        "lightmap": map_record(occlusion, baked.layout, int(np.count_nonzero(~found.valid))),
        "bake_s": round(baked.bake_s, 4),
        "stage_s": {name: round(seconds, 4) for name, seconds in progress.seconds.items()},
        "peak_memory_bytes": peak_memory_bytes(),
        "notes": [*baked.scene.notes, *baked.layout.notes],
        "provenance": origin.to_dict(),
    }
    write_text_atomic(folder / "bake.json", json.dumps(record, indent=2, allow_nan=False) + "\n")
    return record


def _write_pictures(path: Path, occlusion: LightmapFile) -> None:
    """8-bit linear grey pages: what engines take as they are."""
    from irradia.export.occlusion_materials import linear_codes
    from irradia.formats.png import write_png

    for page, pixels in enumerate(occlusion.pages):
        write_png(page_path(path, page), linear_codes(pixels))


def describe_occlusion(job: BakeJob, summary: BakeSummary) -> str:
    """Three lines of results."""
    record = summary.record
    lightmap, found = record["lightmap"], record["occlusion"]
    reach = "any distance" if found["distance_m"] is None else f"{found['distance_m']:.3g} m"
    mean = "nothing valid" if found["mean"] is None else f"{found['mean']:.1%} open on average"
    return "\n".join(
        [
            f"{record['scene']}: {lightmap['n_texels']:,} texels, {found['samples_per_texel']} samples each, "
            f"baked in {record['bake_s']:.1f} s",
            f"Ambient occlusion within {reach}: {mean}",
            f"In {job.out}: {', '.join(summary.files)}",
        ]
    )
