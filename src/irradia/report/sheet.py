"""The frame of every report: one page with pictures, style and script inside, and the parts that repeat."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from html import escape
from importlib.resources import files
from string import Template
from typing import Any


def sheet(title: str, subtitle: str, notes: Sequence[str], sections: Sequence[str]) -> str:
    """The whole page as text, without a request to anywhere.

    Args:
        title: Plain text, like ``subtitle`` and ``notes``.
        subtitle: Shown below the title.
        notes: What the user should know.
        sections: HTML, in reading order.
    """
    return Template(_asset("report.html")).substitute(
        title=escape(title),
        subtitle=escape(subtitle),
        style=_asset("report.css"),
        script=_asset("report.js"),
        notes=_notes(notes),
        sections="\n".join(sections),
    )


def section(heading: str, content: str) -> str:
    """A section of HTML under a heading of plain text; nothing where there is no content."""
    return f"<section>\n  <h2>{escape(heading)}</h2>\n  {content}\n</section>" if content else ""


def card(content: str) -> str:
    """HTML on a ground of its own."""
    return f'<div class="card">{content}</div>'


def pairs(facts: Sequence[tuple[str, str]]) -> str:
    """Labels and values of plain text."""
    rows = "".join(f"<div><dt>{escape(k)}</dt><dd>{escape(v)}</dd></div>" for k, v in facts)
    return f'<dl class="facts">{rows}</dl>'


def provenance(record: Mapping[str, Any]) -> str:
    """What made it: single values at a glance, all of it folded away."""
    simple = [(k, str(v)) for k, v in record.items() if not isinstance(v, (dict, list)) and v is not None]
    whole = escape(json.dumps(record, indent=2, default=str))
    return f"{pairs(simple)}<details><summary>The whole record</summary><pre>{whole}</pre></details>"


def _notes(notes: Sequence[str]) -> str:
    if not notes:
        return ""
    return f'<ul class="notes">{"".join(f"<li>{escape(n)}</li>" for n in notes)}</ul>'


def _asset(name: str) -> str:
    return files("irradia.report").joinpath("assets", name).read_text(encoding="utf-8")
