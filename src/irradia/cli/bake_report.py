"""From a finished bake to the report's data."""

from __future__ import annotations

import itertools
from typing import Any

import numpy as np
from numpy.typing import NDArray

from irradia.bake.lightmap import LightmapResult
from irradia.cli.bake_job import Baked, BakeJob
from irradia.cli.bake_views import View, ViewOptions
from irradia.core.colour import automatic_exposure_ev
from irradia.report import (
    Comparison,
    Convergence,
    LightmapSummary,
    LiveView,
    MapPicture,
    Performance,
    ReportData,
)
from irradia.report.pictures import display, error_colours
from irradia.scene.types import Scene


def report_data(
    job: BakeJob, baked: Baked, record: dict[str, Any], live_view: LiveView | None = None
) -> ReportData:
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
            companions=companion_pictures(baked.result),
            facts=_lightmap_facts(record),
        ),
        performance=_performance(record),
        provenance=record["provenance"],
        convergence=convergence(record["stats"]["epochs"]),
        notes=(*baked.scene.notes, *baked.layout.notes),
        neural_field=baked.neural_field.summary if baked.neural_field else None,
        live_view=live_view,
    )


def companion_pictures(result: LightmapResult) -> tuple[MapPicture, ...]:
    """Samples per texel where they differ, and the maps beside the lightmap, each as its first page."""
    pictures = []
    counts = result.sample_count[result.valid]
    if len(counts) and counts.min() != counts.max():
        share = result.texels.to_pages(result.sample_count / np.float32(counts.max()))[0]
        name = f"Samples per texel, dark {counts.min()} to bright {counts.max()}"
        pictures.append(MapPicture(name, error_colours(share)))
    if result.direct is not None:
        exposure_ev = automatic_exposure_ev(result.pages[result.coverage > 0.0])
        pictures.append(MapPicture("Direct map", display(result.direct[0], exposure_ev)))
    if result.shadows is not None:
        names = _shadow_names(result)
        pictures.append(MapPicture(f"Shadow mask: {names}", _codes(result.shadows[0, ..., :3])))
    if result.directional is not None:
        from irradia.bake.directional_modes import MODES

        for name, pages in result.directional.pages.items():
            is_light = name in MODES[result.directional.mode].light_maps
            lit = pages[result.coverage > 0.0]
            pixels = display(pages[0], automatic_exposure_ev(lit)) if is_light else _codes(pages[0])
            pictures.append(MapPicture(f"Directional map {name}", pixels))
    return tuple(pictures)


def _codes(values: NDArray[np.float32]) -> NDArray[np.uint8]:
    """Numbers of [0, 1] as they are, not as light."""
    return np.round(np.clip(values, 0.0, 1.0) * 255.0).astype(np.uint8)


def _shadow_names(result: LightmapResult) -> str:
    """Which light is in which colour of the picture; the fourth channel has none."""
    named: dict[int, list[str]] = {}
    for light, channel in zip(result.lights, result.shadow_channels, strict=True):
        if channel is not None:
            named.setdefault(channel, []).append(light.name or light.kind)
    colours = ("red", "green", "blue", "no colour")
    return "; ".join(f"{', '.join(names)} in {colours[channel]}" for channel, names in sorted(named.items()))


def _lightmap_facts(record: dict[str, Any]) -> tuple[tuple[str, str], ...]:
    """What there is to say of a bake that went beyond its plain map."""
    stats, update, probes = record["stats"], record["update"], record["probes"]
    facts = {
        "Light": None if stats["mode"] == "full" else stats["mode"],
        "Ended by": None if record["ended_by"] == "samples" else record["ended_by"],
        "Noise, 95th percentile": _percent(stats["noise_p95"]),
        "Cut off by the clamp": _percent(stats["clamped_off_share"]),
        "Baked anew": None if update is None else _percent(update["rebaked_share"]),
        "Stale": None if update is None else _percent(update["stale_share"]),
        "Probes": None if probes is None else str(probes["count"]),
    }
    return tuple((label, value) for label, value in facts.items() if value is not None)


def _percent(share: float | None) -> str | None:
    return None if share is None else f"{share:.2%}"


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
