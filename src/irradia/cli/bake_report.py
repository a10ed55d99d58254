"""From a finished bake to the report's data."""

from __future__ import annotations

import itertools
from typing import Any

from irradia.cli.bake_job import Baked, BakeJob
from irradia.cli.bake_views import View, ViewOptions
from irradia.report import Comparison, Convergence, LightmapSummary, Performance, ReportData
from irradia.scene.types import Scene


def report_data(job: BakeJob, baked: Baked, record: dict[str, Any]) -> ReportData:
    """Everything that the report shows."""
    views = (_comparison(baked.view, job.views),) if baked.view and job.views else ()
    return ReportData(
        title=baked.scene.name,
        facts=_facts(baked.scene),
        comparisons=views,
        lightmap=LightmapSummary(
            baked.result.pages,
            baked.result.coverage,
            baked.layout.texels_per_metre,
            record["lightmap"]["n_invalid_texels"],
        ),
        performance=_performance(record),
        provenance=record["provenance"],
        convergence=convergence(record["stats"]["epochs"]),
        notes=baked.scene.notes,
    )


def convergence(epochs: list[dict[str, float]]) -> Convergence | None:
    """The map's mean after each epoch over the last one's, by rays per texel spent so far."""
    final = epochs[-1]["mean"] if epochs else 0.0
    if len(epochs) < 2 or not final > 0.0:
        return None
    spent = itertools.accumulate(int(epoch["rays"]) for epoch in epochs)
    ratios = tuple(epoch["mean"] / final for epoch in epochs)
    return Convergence(tuple(spent), ratios, against="that of the last epoch")


def _comparison(view: View, options: ViewOptions) -> Comparison:
    found = view.comparison
    return Comparison(
        name=view.camera.name or "camera",
        baked=view.baked,
        reference=view.reference,
        full=view.full,
        flip=view.flip,
        scores={
            "flip": found.flip,
            "psnr": found.psnr_db,
            "relmse": found.relmse,
            "relmse_noise_free": view.relmse_noise_free,
            "smape": found.smape,
            "mean_ratio": found.mean_ratio,
            "p95": found.relative_error_p95,
        },
        reference_spp=options.reference_spp,
        full_spp=options.full_spp,
    )


def _performance(record: dict[str, Any]) -> Performance:
    stats = record["stats"]
    return Performance(
        stage_s=record["stage_s"],
        bake_s=record["bake_s"],
        samples_per_second=stats["samples_per_second"],
        rays_per_second=stats.get("rays_per_second"),
        peak_memory_bytes=record["peak_memory_bytes"],
        counts={
            "Samples per texel": stats["samples_per_texel"],
            "Epochs": len(stats["epochs"]),
            "Kernel launches per pass": stats["launches_per_pass"],
        },
    )


def _facts(scene: Scene) -> tuple[tuple[str, str], ...]:
    environment = scene.environment.name if scene.environment else "none"
    return (
        ("Triangles", f"{scene.n_triangles:,}".replace(",", "\u202f")),
        ("Instances", str(len(scene.instances))),
        ("Materials", str(len(scene.materials))),
        ("Images", str(len(scene.images))),
        ("Lights", _lights(scene)),
        ("Environment", environment),
    )


def _lights(scene: Scene) -> str:
    kinds = [light.kind for light in scene.lights]
    counted = {kind: kinds.count(kind) for kind in dict.fromkeys(kinds)}
    emissive = sum(max(material.emission) > 0.0 for material in scene.materials)
    parts = [f"{count} {kind}" for kind, count in counted.items()]
    if emissive:
        parts.append(f"{emissive} emissive materials")
    return ", ".join(parts) or "none"
