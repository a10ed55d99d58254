"""The page of a sweep: what each field costs and keeps, drawn, listed and shown."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from html import escape
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from irradia.core.files import write_text_atomic
from irradia.report import text
from irradia.report.pictures import data_uri, display
from irradia.report.scatter import Curve, Dot, curves_plot, scatter_plot
from irradia.report.sheet import card, provenance, section, sheet

F32 = NDArray[np.float32]
Row = Mapping[str, Any]

# Column: heading, and how its values are written.
_COLUMNS = {
    "name": ("Run", str),
    "relmse": ("relMSE", text.score),
    "psnr_db": ("PSNR, dB", lambda v: f"{v:.2f}"),
    "flip": ("HDR-FLIP", lambda v: f"{v:.4f}"),
    "mae": ("MAE", text.score),
    "bytes": ("Bytes", text.count),
    "parameters": ("Parameters", text.count),
    "train_s": ("Training, s", lambda v: f"{v:.1f}"),
    "flops": ("Operations a query", text.count),
    "queries_per_s": ("M queries/s", lambda v: f"{v / 1e6:.2f}"),
}
_NAMED_CURVES = 5
# Horizontal axes of the drawings of error: column, label.
_AXES = {
    "bytes": "bytes as shipped",
    "train_s": "seconds of training",
    "flops": "operations a query",
}


@dataclass(frozen=True)
class SweepData:
    """What the page shows.

    Attributes:
        title, subtitle: Plain text.
        rows: One a run; columns as of the table's file.
        losses: By run, the loss after so many steps.
        pictures: By name, linear radiance; the reference first.
        exposure_ev: Of the pictures, stops.
        provenance: Plain values.
        notes: What the user should know.
    """

    title: str
    subtitle: str
    rows: Sequence[Row]
    losses: Mapping[str, Sequence[tuple[int, float]]] = field(default_factory=dict)
    pictures: Mapping[str, F32] = field(default_factory=dict)
    exposure_ev: float = 0.0
    provenance: Mapping[str, Any] = field(default_factory=dict)
    notes: Sequence[str] = ()


def write_sweep(path: Path | str, data: SweepData) -> None:
    """Writes the page; see :func:`render_sweep`."""
    write_text_atomic(path, render_sweep(data))


def render_sweep(data: SweepData) -> str:
    """The whole page as text, without a request to anywhere."""
    done = [row for row in data.rows if row.get("status") == "done"]
    drawings = "".join(
        f"<figure>{scatter_plot(_dots(done, column), label, 'relMSE')}"
        f"<figcaption>Error against {escape(label)}; the line joins what nothing beats.</figcaption></figure>"
        for column, label in _AXES.items()
        if _dots(done, column)
    )
    failed = [row for row in data.rows if row.get("status") == "failed"]
    return sheet(
        data.title,
        data.subtitle,
        [*data.notes, *(f"{row['name']} failed: {row['error']}" for row in failed)],
        (
            section("Error against cost", f'<div class="drawings">{drawings}</div>' if drawings else ""),
            section("Runs", _table(done)),
            section("Loss", _losses(data)),
            section("Contact sheet", _contact_sheet(data)),
            section("Provenance", provenance(data.provenance)),
        ),
    )


def error_of(row: Row) -> float:
    """relMSE, to sort by; infinite where the field gave something that is no number."""
    relmse = row.get("relmse")
    return math.inf if relmse is None else relmse


def _dots(rows: Sequence[Row], column: str) -> list[Dot]:
    return [
        Dot(row[column], row["relmse"], row["name"], _encoding(row))
        for row in rows
        if (row.get(column) or 0) > 0 and (row.get("relmse") or 0) > 0
    ]


def _encoding(row: Row) -> str:
    return str(row.get("option.encoding") or "hash")


def _table(rows: Sequence[Row]) -> str:
    shown = [name for name in _COLUMNS if any(row.get(name) is not None for row in rows)]
    if not rows:
        return ""
    head = "".join(
        f'<th><button type="button" data-column="{i}">{escape(_COLUMNS[name][0])}</button></th>'
        for i, name in enumerate(shown)
    )
    ordered = sorted(rows, key=error_of)
    body = "".join(f"<tr>{''.join(_cell(name, row.get(name)) for name in shown)}</tr>" for row in ordered)
    table = f'<table class="numbers sortable"><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>'
    note = "relMSE, PSNR and MAE are of validation samples that training never saw. Click a heading to sort."
    return card(f'<div class="wide">{table}</div><p class="quiet hint">{note}</p>')


def _cell(column: str, value: Any) -> str:
    if value is None:
        return "<td>–</td>"
    return f'<td data-value="{escape(str(value))}">{escape(_COLUMNS[column][1](value))}</td>'


def _losses(data: SweepData) -> str:
    groups = {row["name"]: _encoding(row) for row in data.rows}
    curves = [Curve(name, groups.get(name, "hash"), points) for name, points in data.losses.items() if points]
    if not curves:
        return ""
    done = [row for row in data.rows if row.get("status") == "done" and row["name"] in data.losses]
    best = [row["name"] for row in sorted(done, key=error_of)[:_NAMED_CURVES]]
    note = "Means over parts of each training; the fields of least relMSE are named, all are when pointed at."
    return card(f'{curves_plot(curves, "steps", "loss", best)}<p class="quiet hint">{note}</p>')


def _contact_sheet(data: SweepData) -> str:
    figures = "".join(
        f'<figure class="page"><img src="{data_uri(display(picture, data.exposure_ev), lossless=False)}"'
        f' alt="{escape(name)}"><figcaption>{escape(name)}</figcaption></figure>'
        for name, picture in data.pictures.items()
    )
    if not figures:
        return ""
    note = f"One camera, exposure {text.stops(data.exposure_ev)}."
    return f'<p class="quiet">{note}</p><div class="pages contact">{figures}</div>'
