"""Puts the page together."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from html import escape
from importlib.resources import files
from pathlib import Path
from string import Template
from typing import Any

from irradia.core.colour import automatic_exposure_ev
from irradia.core.files import write_text_atomic
from irradia.report import charts, text
from irradia.report.data import Comparison, LightmapSummary, MapPicture, Performance, ReportData
from irradia.report.pictures import (
    F32,
    data_uri,
    display,
    error_colours,
    error_gradient_css,
    map_display,
    page_display,
)

# Metric: label, and what a good value is.
_SCORES = {
    "flip": ("HDR-FLIP, mean", "0 is equal; under 0.05 is hard to see side by side"),
    "psnr": ("PSNR", "decibels, after tone mapping; more is better"),
    "relmse": ("relMSE", "0 is equal; the reference's own noise counts"),
    "relmse_noise_free": ("relMSE, noise of the reference removed", "0 is equal"),
    "smape": ("SMAPE", "0 is equal, 2 is the worst"),
    "mean_ratio": ("Mean ratio", "1 is equal brightness"),
    "p95": ("95th percentile of the relative error", "0 is equal"),
}


def write_report(path: Path | str, data: ReportData) -> None:
    """Writes the report; see :func:`render_report`."""
    write_text_atomic(path, render_report(data))


def render_report(data: ReportData) -> str:
    """The whole page as text: pictures, style and script inside, no request to anywhere."""
    return Template(_asset("report.html")).substitute(
        title=escape(data.title),
        style=_asset("report.css"),
        script=_asset("report.js"),
        subtitle=_subtitle(data),
        notes=_notes(data.notes),
        comparisons="".join(_comparison(c, i) for i, c in enumerate(data.comparisons)),
        lightmap=_lightmap(data.lightmap),
        performance=_performance(data.performance),
        convergence=_convergence(data),
        facts=_pairs(data.facts),
        provenance=_provenance(data.provenance),
    )


def _asset(name: str) -> str:
    return files("irradia.report").joinpath("assets", name).read_text(encoding="utf-8")


def _subtitle(data: ReportData) -> str:
    parts = [
        f"{text.count(data.lightmap.n_texels)} texels",
        text.rate(data.performance.samples_per_second, "samples/s"),
        f"baked in {text.duration(data.performance.bake_s)}",
    ]
    return " · ".join(parts)


def _notes(notes: tuple[str, ...]) -> str:
    if not notes:
        return ""
    return f'<ul class="notes">{"".join(f"<li>{escape(n)}</li>" for n in notes)}</ul>'


# -- Comparison --------------------------------------------------------------------------------


def _comparison(view: Comparison, index: int) -> str:
    """The stage with its layers, what can be shown on it, and the numbers."""
    exposure_ev = automatic_exposure_ev(view.reference)
    layers = {
        "baked": ("Baked", data_uri(display(view.baked, exposure_ev))),
        "reference": ("Reference", data_uri(display(view.reference, exposure_ev))),
    }
    if view.full is not None:
        layers["full"] = ("Full materials", data_uri(display(view.full, exposure_ev)))
    layers["flip"] = ("FLIP", data_uri(error_colours(view.flip)))
    height, width = view.reference.shape[:2]
    pictures = "".join(
        f'<img class="layer" data-layer="{key}" src="{uri}" draggable="false"'
        f' alt="{escape(view.name)}: {label}">'
        for key, (label, uri) in layers.items()
    )
    buttons = "".join(
        f'<button type="button" data-show="{key}" aria-pressed="{str(key == "slider").lower()}">'
        f"<kbd>{number}</kbd>{label}</button>"
        for number, (key, label) in enumerate(
            {"slider": "Slider", **{k: label for k, (label, _) in layers.items()}}.items(), start=1
        )
    )
    return f"""
<section class="comparison" id="view-{index}">
  <h2>{escape(view.name)} <small>exposure {text.stops(exposure_ev)} · {width} × {height}</small></h2>
  <div class="modes" role="toolbar" aria-label="What is shown">{buttons}</div>
  <div class="stage" data-mode="slider" tabindex="0" style="aspect-ratio:{width}/{height}">
    {pictures}
    <div class="divider" role="slider" aria-label="Between baked and reference"
         aria-valuemin="0" aria-valuemax="100" aria-valuenow="50"></div>
    <span class="tag tag-left">Baked</span><span class="tag tag-right">Reference, diffuse</span>
  </div>
  <p class="quiet hint">Drag the line, scroll to zoom, drag to pan, double-click to fit.
    Keys 1 to 5 switch, arrows move the line.</p>
  <div class="columns">
    <div>{_beside(view)}</div>
    <div><h3>Baked against the reference</h3>{_scores(view)}</div>
  </div>
</section>"""


def _beside(view: Comparison) -> str:
    """The error map with its scale, and the unscored picture; the script copies both from the stage."""
    scale = f'<span class="scale" style="background:{error_gradient_css()}"></span>'
    parts = [
        f'<figure><img data-copy="flip" alt="FLIP error map">'
        f"<figcaption>HDR-FLIP error 0 {scale} 1</figcaption></figure>"
    ]
    if view.full is not None:
        parts.append(
            f'<figure><img data-copy="full" alt="Full materials">'
            f"<figcaption>Full materials, {view.full_spp} spp: for the eye, not scored</figcaption></figure>"
        )
    return f'<div class="pair">{"".join(parts)}</div>'


def _scores(view: Comparison) -> str:
    rows = []
    for key, value in view.scores.items():
        label, meaning = _SCORES.get(key, (key, ""))
        rows.append(
            f"<tr><td>{escape(label)}<small>{escape(meaning)}</small></td>"
            f'<td class="value">{text.score(value)}</td></tr>'
        )
    note = f"Both are diffuse transport; the reference took {view.reference_spp} samples per pixel."
    return f'<table class="numbers scores">{"".join(rows)}</table><p class="quiet">{note}</p>'


# -- Lightmap, cost, origin --------------------------------------------------------------------


def _lightmap(lightmap: LightmapSummary) -> str:
    exposure_ev = automatic_exposure_ev(lightmap.pages[lightmap.coverage > 0])
    n_pages, height, width = lightmap.coverage.shape
    facts = (
        ("Pages", f"{n_pages} of {width} × {height}"),
        ("Covered texels", text.count(lightmap.n_texels)),
        ("Chart utilisation", f"{lightmap.utilisation:.1%}"),
        ("Density", f"{text.count(round(lightmap.texels_per_metre, 2))} texels per metre"),
        ("Texels inside geometry", text.count(lightmap.n_invalid)),
        ("Exposure of the pictures", text.stops(exposure_ev)),
        *lightmap.facts,
    )
    figures = "".join(
        f'<figure class="page"><img src="{uri}" alt="Lightmap page {i}" loading="lazy">'
        f"<figcaption>Page {i}, {_covered(lightmap, i):.0%} covered</figcaption></figure>"
        for i, uri in enumerate(_page_uris(lightmap, exposure_ev))
    )
    figures += "".join(_companion(companion, lightmap.coverage[0]) for companion in lightmap.companions)
    return f'{_pairs(facts)}<div class="pages">{figures}</div>'


def _companion(companion: MapPicture, coverage: F32) -> str:
    uri, name = data_uri(map_display(companion.pixels, coverage), lossless=False), escape(companion.name)
    return (
        f'<figure class="page"><img src="{uri}" alt="{name}" loading="lazy">'
        f"<figcaption>{name}</figcaption></figure>"
    )


def _page_uris(lightmap: LightmapSummary, exposure_ev: float) -> list[str]:
    pairs = zip(lightmap.pages, lightmap.coverage, strict=True)
    return [data_uri(page_display(page, cover, exposure_ev), lossless=False) for page, cover in pairs]


def _covered(lightmap: LightmapSummary, page: int) -> float:
    return float((lightmap.coverage[page] > 0).mean())


def _performance(performance: Performance) -> str:
    facts = [
        ("Gather samples", text.rate(performance.samples_per_second, "samples/s")),
        ("Rays", text.rate(performance.rays_per_second, "rays/s")),
        ("Peak memory", text.size(performance.peak_memory_bytes)),
        *((label, text.count(value)) for label, value in performance.counts.items()),
    ]
    bar = charts.stage_bar(performance.stage_s)
    return f'<div class="columns"><div>{bar}</div><div>{_pairs(facts)}</div></div>'


def _convergence(data: ReportData) -> str:
    convergence = data.convergence
    if convergence is None or not convergence.samples:
        return ""
    if not all(math.isfinite(r) for r in convergence.mean_ratio):
        return ""
    plot = charts.mean_ratio_plot(convergence)
    return f'<section><h2>Mean ratio over samples</h2><div class="card">{plot}</div></section>'


def _provenance(provenance: Mapping[str, Any]) -> str:
    simple = [(k, str(v)) for k, v in provenance.items() if not isinstance(v, (dict, list)) and v is not None]
    record = escape(json.dumps(provenance, indent=2, default=str))
    return f"{_pairs(simple)}<details><summary>The whole record</summary><pre>{record}</pre></details>"


def _pairs(facts: tuple[tuple[str, str], ...] | list[tuple[str, str]]) -> str:
    rows = "".join(f"<div><dt>{escape(k)}</dt><dd>{escape(v)}</dd></div>" for k, v in facts)
    return f'<dl class="facts">{rows}</dl>'
