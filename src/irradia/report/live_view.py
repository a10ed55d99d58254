"""The viewer beside a report: a page of its own, which is only loaded when somebody asks for it."""

from __future__ import annotations

from html import escape
from urllib.parse import quote

from irradia.report import text
from irradia.report.data import LiveView
from irradia.report.sheet import section


def live_section(view: LiveView | None) -> str:
    """A button in whose place the viewer opens; nothing where there is no viewer."""
    if view is None:
        return ""
    address, size = escape(quote(view.file)), text.size(view.n_bytes)
    return section(
        "Live view",
        f'<div class="live card" data-live="{address}">'
        '<button type="button">Walk through it here</button>'
        f'<p class="quiet"><a href="{address}" target="_blank" rel="noopener">{escape(view.file)}</a>, '
        f"which lies beside this page, works alone as well ({size}).</p></div>",
    )
