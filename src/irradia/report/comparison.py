"""One camera's view: what is judged and its reference on one stage, and the scores beside it."""

from __future__ import annotations

from html import escape

from irradia.core.colour import automatic_exposure_ev
from irradia.report import text
from irradia.report.data import Comparison
from irradia.report.pictures import data_uri, display, error_colours, error_gradient_css

# Metric: label, and what a good value is.
_SCORES = {
    "flip": ("HDR-FLIP, mean where the scene is seen", "0 is equal; under 0.05 is hard to see side by side"),
    "psnr": ("PSNR", "decibels, after tone mapping; more is better"),
    "relmse": ("relMSE", "0 is equal; the reference's own noise counts"),
    "relmse_noise_free": ("relMSE, noise of the reference removed", "0 is equal"),
    "smape": ("SMAPE", "0 is equal, 2 is the worst"),
    "mean_ratio": ("Mean ratio", "1 is equal brightness"),
    "p95": ("95th percentile of the relative error", "0 is equal"),
}


def comparison_section(view: Comparison, index: int) -> str:
    """The stage with its layers, what can be shown on it, and the numbers.

    Args:
        view: What is shown.
        index: Unlike that of any other on the page.
    """
    exposure_ev = automatic_exposure_ev(view.reference) if view.exposure_ev is None else view.exposure_ev
    label = escape(view.label)
    layers = {
        "baked": (label, data_uri(display(view.baked, exposure_ev))),
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
    <div class="divider" role="slider" aria-label="Between {label} and reference"
         aria-valuemin="0" aria-valuemax="100" aria-valuenow="50"></div>
    <span class="tag tag-left">{label}</span><span class="tag tag-right">Reference, diffuse</span>
  </div>
  <p class="quiet hint">Drag the line, scroll to zoom, drag to pan, double-click to fit.
    Keys 1 to {len(layers) + 1} switch, arrows move the line.</p>
  <div class="columns">
    <div>{_beside(view)}</div>
    <div><h3>{label} against the reference</h3>{_scores(view)}</div>
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
        flag = "<small>under the reference's own noise</small>" if key in view.under_noise else ""
        rows.append(
            f"<tr><td>{escape(label)}<small>{escape(meaning)}</small></td>"
            f'<td class="value">{text.score(value)}{flag}</td></tr>'
        )
    note = f"Both are diffuse transport; the reference took {view.reference_spp} samples per pixel."
    return f'<table class="numbers scores">{"".join(rows)}</table><p class="quiet">{note}</p>'
