"""Writes what a bake made: maps, previews, .glb, record, report."""

from __future__ import annotations

import json
import shutil
import time
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from irradia.cli.bake_job import Baked, BakeJob
from irradia.cli.field_job import FILE
from irradia.cli.memory import peak_memory_bytes
from irradia.cli.origin import scene_inputs
from irradia.core import provenance
from irradia.core.colour import automatic_exposure_ev, picture_srgb8
from irradia.core.files import write_atomic, write_text_atomic
from irradia.core.progress import Progress
from irradia.formats.lightmap import LightmapFile, make_lightmap, page_path
from irradia.scene.layout import LightmapLayout
from irradia.scene.types import Scene

if TYPE_CHECKING:
    from irradia.export.glb import Companions

_BAND_ROWS = 64  # of a picture in the making, which takes a hundred bytes a pixel


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
    from irradia.export.map_files import write_maps
    from irradia.export.web_views import KEY, write_views
    from irradia.transport.backend import give_back

    give_back()  # files take as much again as the maps
    origin = make_provenance(job, baked.scene, time.perf_counter() - start)
    result = baked.result
    lightmap = make_lightmap(result.pages, result.coverage, origin.reproducible(), _texel_channels(baked))
    with progress.stage("files"):
        write_maps(folder, lightmap, job.formats)
        _write_previews(folder / "preview.png", lightmap)
        _write_companions(folder, job, baked, origin.reproducible())
        write_baked_glb(
            folder / "scene.baked.glb",
            baked.scene,
            baked.layout,
            result.pages,
            _companions(baked),
            compatible=job.compatible,
        )
    record = bake_record(baked, lightmap, progress, origin.to_dict())
    if baked.view is not None and job.views is not None:
        record[KEY] = write_views(
            folder, [baked.view.camera], [baked.view.reference], job.views.reference_spp
        )
        _write_picture(folder / "view.png", baked.view.baked)
    write_text_atomic(folder / "bake.json", json.dumps(record, indent=2, allow_nan=False) + "\n")
    if baked.view is not None:
        from irradia.cli.bake_report import report_data
        from irradia.cli.live_view import write_live_view
        from irradia.report import write_report

        write_report(
            folder / "report.html", report_data(job, baked, record, write_live_view(folder, progress))
        )
    return record


def _companions(baked: Baked) -> Companions:
    """What goes into the .glb beside the lightmap."""
    from irradia.export.glb import Companions
    from irradia.export.shadow_mask_extension import BakedShadows
    from irradia.export.validity_extension import code_validity

    result = baked.result
    shadows = None if result.shadows is None else BakedShadows(result.shadows, result.shadow_channels)
    field = None if baked.neural_field is None else baked.neural_field.data
    validity = result.texels.to_pages(code_validity(1.0 - result.hidden_share))
    return Companions(result.directional, result.direct, shadows, baked.probes, field, validity)


def _texel_channels(baked: Baked) -> dict[str, NDArray]:
    """What is known of texels beside their light, as pages."""
    result, texels = baked.result, baked.result.texels
    channels: dict[str, NDArray] = {
        "validity": texels.to_pages((1.0 - result.hidden_share).astype(np.float16)),
        "samples": texels.to_pages(result.sample_count),
    }
    if baked.update is not None:
        channels["stale"] = texels.to_pages(baked.update.stale.astype(np.float16))
    return channels


def _write_companions(folder: Path, job: BakeJob, baked: Baked, origin: dict[str, Any]) -> None:
    """Directional and direct maps, shadow mask, probes, field, and what the next update needs."""
    from irradia.bake.rebake import write_memory
    from irradia.cli.bake_update import MEMORY
    from irradia.export.directional_files import write_directional_files
    from irradia.export.map_files import write_maps
    from irradia.export.probe_files import write_probe_files
    from irradia.formats.shadow_mask import write_shadow_mask

    result = baked.result
    if result.directional is not None:
        write_directional_files(folder, result.directional, result.coverage, job.formats, origin)
    if result.direct is not None:
        direct = make_lightmap(result.direct, result.coverage, origin)
        write_maps(folder, direct, job.formats, name="lightmap_direct")
    if result.shadows is not None:
        write_shadow_mask(folder / "shadow_mask.png", result.shadows)
    if baked.probes is not None:
        write_probe_files(folder, baked.probes)
    if baked.neural_field is not None:
        with write_atomic(folder / FILE) as stream:
            stream.write(baked.neural_field.data)
    if baked.memory is not None:
        write_memory(folder / MEMORY, baked.memory)
    elif not baked.complete and (job.out / MEMORY).exists():  # what --resume builds on
        shutil.copyfile(job.out / MEMORY, folder / MEMORY)


def bake_record(
    baked: Baked, lightmap: LightmapFile, progress: Progress, origin: dict[str, Any]
) -> dict[str, Any]:
    """What was baked, how fast and how right: plain values, fit for JSON."""
    stats = baked.result.stats
    if baked.update is not None:  # the rounds of an update have met only some of the texels
        stats = {**stats, "noise_p95": None}
    return {
        "scene": baked.scene.name,
        "ended_by": baked.ended_by,
        "samples_per_second": stats["samples_per_second"],
        "launches_per_pass": stats["launches_per_pass"],
        "lightmap": map_record(lightmap, baked.layout, int(np.count_nonzero(~baked.result.valid))),
        "direct_map": _direct_record(baked),
        "shadow_mask": _shadow_channels(baked),
        "probes": None
        if baked.probes is None
        else {"count": len(baked.probes), "light": baked.probes.light, **baked.probes.provenance},
        "update": None
        if baked.update is None
        else {
            "rebaked_share": _share(baked.update.rebake, baked.result.valid),
            "stale_share": _share(baked.update.stale, baked.result.valid),
        },
        "stats": stats,
        "bake_s": round(baked.bake_s, 4),
        "stage_s": {name: round(seconds, 4) for name, seconds in progress.seconds.items()},
        "peak_memory_bytes": peak_memory_bytes(),
        "against_reference": _against_reference(baked),
        "neural_field": None if baked.neural_field is None else baked.neural_field.record,
        "notes": [*baked.scene.notes, *baked.layout.notes],
        "provenance": origin,
    }


def _share(chosen: NDArray[np.bool_], among: NDArray[np.bool_]) -> float:
    return float(chosen[among].mean()) if among.any() else 0.0


def map_record(lightmap: LightmapFile, layout: LightmapLayout, n_invalid_texels: int) -> dict[str, Any]:
    """What the pages are."""
    covered = lightmap.covered
    return {
        "quantity": lightmap.quantity,
        "scale": lightmap.scale,
        "exposure_ev": lightmap.exposure_ev,
        "n_pages": len(lightmap.pages),
        "width_px": lightmap.pages.shape[2],
        "height_px": lightmap.pages.shape[1],
        "n_texels": int(covered.sum()),
        "n_invalid_texels": n_invalid_texels,
        "utilisation": float(covered.mean()),
        "texels_per_metre": layout.texels_per_metre,
    }


def _direct_record(baked: Baked) -> dict[str, Any] | None:
    """Which part of the map's light the direct map holds, or None without one."""
    result = baked.result
    if result.direct is None:
        return None
    there = result.coverage > 0.0
    direct, full = (pages[there].sum(dtype=np.float64) for pages in (result.direct, result.pages))
    return {"share": float(direct / max(full, 1e-30))}


def _shadow_channels(baked: Baked) -> dict[str, int] | None:
    """The channel of every light that has one, by its name or number."""
    result = baked.result
    if result.shadows is None:
        return None
    return {
        light.name or f"light {index}": channel
        for index, (light, channel) in enumerate(zip(result.lights, result.shadow_channels, strict=True))
        if channel is not None
    }


def _against_reference(baked: Baked) -> dict[str, Any] | None:
    if baked.view is None:
        return None
    return {
        "camera": baked.view.camera.name,
        **baked.view.comparison.to_json(),
        "relmse_noise_free": baked.view.relmse_noise_free,
    }


def make_provenance(job: BakeJob, scene: Scene, wall_s: float) -> provenance.Provenance:
    """How a bake came about: inputs, choices, versions, device, time."""
    from irradia.transport.backend import device

    inputs = scene_inputs(job, scene)
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
        bands = [pixels[row : row + _BAND_ROWS] for row in range(0, len(pixels), _BAND_ROWS)]
        picture = np.concatenate([picture_srgb8(band, lightmap.exposure_ev) for band in bands])
        write_png(page_path(path, page), picture)
