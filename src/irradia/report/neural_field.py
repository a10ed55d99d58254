"""A neural field in a report: beside the reference, in numbers, and beside what else holds light."""

from __future__ import annotations

from html import escape
from pathlib import Path

from irradia.core.files import write_text_atomic
from irradia.report import charts, text
from irradia.report.comparison import comparison_section
from irradia.report.data import EvaluationData, FieldSummary, Rival
from irradia.report.sheet import card, pairs, provenance, section, sheet

_NONE = "–"
_COLUMNS = ("", "Size", "HDR-FLIP", "relMSE, noise removed", "MSE in space")


def write_evaluation(path: Path | str, data: EvaluationData) -> None:
    """Writes the report of a field; see :func:`render_evaluation`."""
    write_text_atomic(path, render_evaluation(data))


def render_evaluation(data: EvaluationData) -> str:
    """The whole page as text, without a request to anywhere."""
    field = data.field.rivals[0] if data.field.rivals else None
    return sheet(
        data.title,
        f"neural field, {text.size(field.n_bytes)}" if field else "neural field",
        data.notes,
        (
            *field_sections(data.field),
            section("Cost", card(charts.stage_bar(data.stage_s))),
            section("Provenance", provenance(data.provenance)),
        ),
    )


def field_sections(field: FieldSummary, first_view: int = 0) -> tuple[str, ...]:
    """The field's views, then its facts and rivals.

    Args:
        field: What there is to say.
        first_view: Number of its first view on the page.
    """
    views = (comparison_section(view, first_view + i) for i, view in enumerate(field.comparisons))
    return (*views, section("Neural field", pairs(field.facts) + _rivals(field.rivals)))


def _rivals(rivals: tuple[Rival, ...]) -> str:
    if not rivals:
        return ""
    head = "".join(f"<td>{name}</td>" for name in _COLUMNS)
    rows = "".join(_row(rival) for rival in rivals)
    note = "Means over the views. ≈ marks what is no larger than the reference's own noise."
    table = f'<table class="numbers"><tr>{head}</tr>{rows}</table>'
    return f'<div class="card rivals">{table}<p class="quiet">{note}</p></div>'


def _row(rival: Rival) -> str:
    mark = "≈ " if rival.under_noise else ""
    cells = (
        text.size(rival.n_bytes),
        _NONE if rival.flip is None else mark + text.score(rival.flip),
        _NONE if rival.relmse is None else text.score(rival.relmse),
        _NONE if rival.mse is None else text.score(rival.mse),
    )
    return f"<tr><td>{escape(rival.name)}</td>{''.join(f'<td>{cell}</td>' for cell in cells)}</tr>"
