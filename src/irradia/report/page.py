"""Puts the page of a bake together."""

from __future__ import annotations

import math
from html import escape
from pathlib import Path

from irradia.core.colour import automatic_exposure_ev
from irradia.core.files import write_text_atomic
from irradia.report import charts, text
from irradia.report.comparison import comparison_section
from irradia.report.data import Convergence, LightmapSummary, MapPicture, Performance, ReportData
from irradia.report.live_view import live_section
from irradia.report.neural_field import field_sections
from irradia.report.pictures import F32, data_uri, map_display, page_display
from irradia.report.sheet import card, pairs, provenance, section, sheet


def write_report(path: Path | str, data: ReportData) -> None:
    """Writes the report; see :func:`render_report`."""
    write_text_atomic(path, render_report(data))


def render_report(data: ReportData) -> str:
    """The whole page as text: pictures, style and script inside, no request to anywhere."""
    n_views = len(data.comparisons)
    field = field_sections(data.neural_field, first_view=n_views) if data.neural_field else ()
    return sheet(
        data.title,
        _subtitle(data),
        data.notes,
        (
            *(comparison_section(view, index) for index, view in enumerate(data.comparisons)),
            *field,
            live_section(data.live_view),
            section("Lightmap", _lightmap(data.lightmap)),
            section("Cost", card(_performance(data.performance))),
            section("Mean ratio over samples", _convergence(data.convergence)),
            section("Scene", pairs(data.facts)),
            section("Provenance", provenance(data.provenance)),
        ),
    )


def _subtitle(data: ReportData) -> str:
    parts = [
        f"{text.count(data.lightmap.n_texels)} texels",
        text.rate(data.performance.samples_per_second, "samples/s"),
        f"baked in {text.duration(data.performance.bake_s)}",
    ]
    return " · ".join(parts)


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
    return f'{pairs(facts)}<div class="pages">{figures}</div>'


def _companion(companion: MapPicture, coverage: F32) -> str:
    uri, name = data_uri(map_display(companion.pixels, coverage), lossless=False), escape(companion.name)
    return (
        f'<figure class="page"><img src="{uri}" alt="{name}" loading="lazy">'
        f"<figcaption>{name}</figcaption></figure>"
    )


def _page_uris(lightmap: LightmapSummary, exposure_ev: float) -> list[str]:
    covered = zip(lightmap.pages, lightmap.coverage, strict=True)
    return [data_uri(page_display(page, cover, exposure_ev), lossless=False) for page, cover in covered]


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
    return f'<div class="columns"><div>{bar}</div><div>{pairs(facts)}</div></div>'


def _convergence(convergence: Convergence | None) -> str:
    if convergence is None or not convergence.samples:
        return ""
    if not all(math.isfinite(r) for r in convergence.mean_ratio):
        return ""
    return card(charts.mean_ratio_plot(convergence))
