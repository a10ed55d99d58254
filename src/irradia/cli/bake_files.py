"""Writes what a bake made: maps, previews, .glb, record, report."""

from __future__ import annotations

import json
import time
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from irradia.cli.bake_job import Baked, BakeJob, scene_hash
from irradia.cli.memory import peak_memory_bytes
from irradia.core import provenance
from irradia.core.colour import automatic_exposure_ev, picture_srgb8
from irradia.core.files import write_text_atomic
from irradia.core.progress import Progress
from irradia.formats.lightmap import LightmapFile, make_lightmap, page_path, write_lightmap
from irradia.scene.types import Scene


def write_products(
    folder: Path, job: BakeJob, baked: Baked, progress: Progress, start: float
) -> dict[str, Any]:
    """Writes all files to ``folder`` and returns the content of ``bake.json``.

    Args:
        folder: Where to.
        job: What was asked for.
        baked: What was made.
        progress: Shows stages and has kept their times.
        start: ``time.perf_counter()`` when the command began.
    """
    from irradia.export import write_baked_glb

    origin = _provenance(job, baked.scene, time.perf_counter() - start)
    lightmap = make_lightmap(baked.result.pages, baked.result.coverage, origin.reproducible())
    with progress.stage("files"):
        write_lightmap(folder / "lightmap.exr", lightmap)
        _write_previews(folder / "preview.png", lightmap)
        write_baked_glb(
            folder / "scene.baked.glb",
            baked.scene,
            baked.layout,
            baked.result.pages,
            compatible=job.compatible,
        )
    record = bake_record(baked, lightmap, progress, origin.to_dict())
    if baked.view is not None:
        _write_picture(folder / "view.png", baked.view.baked)
        from irradia.cli.bake_report import report_data
        from irradia.report import write_report

        write_report(folder / "report.html", report_data(job, baked, record))
    write_text_atomic(folder / "bake.json", json.dumps(record, indent=2, allow_nan=False) + "\n")
    return record


def bake_record(
    baked: Baked, lightmap: LightmapFile, progress: Progress, origin: dict[str, Any]
) -> dict[str, Any]:
    """What was baked, how fast and how right: plain values, fit for JSON."""
    stats = baked.result.stats
    covered = lightmap.covered
    return {
        "scene": baked.scene.name,
        "samples_per_second": stats["samples_per_second"],
        "launches_per_pass": stats["launches_per_pass"],
        "lightmap": {
            "quantity": lightmap.quantity,
            "scale": lightmap.scale,
            "exposure_ev": lightmap.exposure_ev,
            "n_pages": len(lightmap.pages),
            "width_px": lightmap.pages.shape[2],
            "height_px": lightmap.pages.shape[1],
            "n_texels": int(covered.sum()),
            "n_invalid_texels": int(np.count_nonzero(~baked.result.valid)),
            "utilisation": float(covered.mean()),
            "texels_per_metre": baked.layout.texels_per_metre,
        },
        "stats": stats,
        "bake_s": round(baked.bake_s, 4),
        "stage_s": {name: round(seconds, 4) for name, seconds in progress.seconds.items()},
        "peak_memory_bytes": peak_memory_bytes(),
        "against_reference": _against_reference(baked),
        "notes": [*baked.scene.notes, *baked.layout.notes],
        "provenance": origin,
    }


def _against_reference(baked: Baked) -> dict[str, Any] | None:
    if baked.view is None:
        return None
    return {
        "camera": baked.view.camera.name,
        **baked.view.comparison.to_json(),
        "relmse_noise_free": baked.view.relmse_noise_free,
    }


def _provenance(job: BakeJob, scene: Scene, wall_s: float) -> provenance.Provenance:
    from irradia.transport.backend import device

    inputs = {Path(job.scene).name: scene_hash(scene)}
    if job.light.env is not None:
        inputs[job.light.env.name] = provenance.sha256_file(job.light.env)
    return provenance.record(
        "bake", job.config(), seed=job.bake.seed, inputs=inputs, device=device, wall_s=wall_s
    )


def _write_picture(path: Path, radiance: NDArray[np.float32]) -> None:
    """What the report shows as baked, for use elsewhere."""
    from irradia.formats.png import write_png

    write_png(path, picture_srgb8(radiance, automatic_exposure_ev(radiance)))


def _write_previews(path: Path, lightmap: LightmapFile) -> None:
    """8-bit pictures of the pages at the automatic exposure that the map's metadata names."""
    from irradia.formats.png import write_png

    for page, pixels in enumerate(lightmap.pages):
        write_png(page_path(path, page), picture_srgb8(pixels, lightmap.exposure_ev))
