"""The live view of a report, opened from disk in a browser."""

from __future__ import annotations

from pathlib import Path

from irradia.cli.gallery_browser import open_page
from irradia.report import LiveView
from irradia.report.live_view import live_section
from irradia.report.sheet import sheet

NAME = "view & walk.html"


def test_a_click_opens_the_viewer_in_the_page(tmp_path: Path, chromium: str) -> None:
    (tmp_path / "report.html").write_text(sheet("A", "", (), (live_section(LiveView(NAME, 1000)),)))
    (tmp_path / NAME).write_text("<script>parent.postMessage('here', '*')</script>")
    with open_page(200, 200) as page:
        page.go((tmp_path / "report.html").as_uri())
        page.wait_for("document.readyState === 'complete' && !!document.querySelector('.live button')", 20.0)
        page.evaluate("addEventListener('message', (event) => { document.title = event.data; })")
        assert page.evaluate("document.querySelector('iframe')") is None
        page.evaluate("document.querySelector('.live button').click()")
        page.wait_for("document.title === 'here'", 20.0)
        assert page.complaints == []
