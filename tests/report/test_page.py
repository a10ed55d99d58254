"""The report: self-contained, escaped, and showing the numbers that it was given."""

from __future__ import annotations

import dataclasses
import json
import re
from html.parser import HTMLParser

import numpy as np
import pytest

from irradia.report import (
    Comparison,
    Convergence,
    LightmapSummary,
    LiveView,
    MapPicture,
    Performance,
    ReportData,
    render_report,
    write_report,
)


class Collector(HTMLParser):
    """Tags with their attributes, and the balance of the tags that close."""

    VOID = frozenset({"meta", "img", "input", "br", "link"})

    def __init__(self):
        super().__init__()
        self.tags: list[tuple[str, dict]] = []
        self.open: list[str] = []

    def handle_starttag(self, tag, attrs):
        self.tags.append((tag, dict(attrs)))
        if tag not in self.VOID:
            self.open.append(tag)

    def handle_startendtag(self, tag, attrs):
        self.tags.append((tag, dict(attrs)))

    def handle_endtag(self, tag):
        assert self.open, f"</{tag}> closes nothing"
        assert self.open.pop() == tag


def collect(html: str) -> Collector:
    collector = Collector()
    collector.feed(html)
    return collector


@pytest.fixture
def data() -> ReportData:
    rng = np.random.default_rng(3)
    reference = rng.random((18, 32, 3), np.float32)
    coverage = np.zeros((2, 16, 16), np.float32)
    coverage[0, :8] = 1.0
    coverage[1, :, :4] = 0.5
    return ReportData(
        title="hall",
        facts=(("Triangles", "150 212"),),
        comparisons=(
            Comparison(
                "camera 0",
                reference * 1.01,
                reference,
                reference,
                reference[..., 0],
                {"flip": 0.0312, "relmse": 2.3e-4},
                512,
                64,
            ),
        ),
        lightmap=LightmapSummary(rng.random((2, 16, 16, 3), np.float32), coverage, 24.3, 7),
        performance=Performance({"trace": 30.0, "write": 10.0}, 33.3, 12.3e6, 31e6, 3 << 30, {"Epochs": 14}),
        provenance={"irradia": "0.1.0", "seed": 5, "config": {"samples": 64}},
        convergence=Convergence((1, 2, 4), (0.96, 1.01, 1.0)),
        notes=("Sun and sky were added.",),
    )


def test_the_viewer_is_loaded_only_when_it_is_asked_for(data):
    html = render_report(dataclasses.replace(data, live_view=LiveView('a "b".html', 3 << 20)))
    assert [a for t, a in collect(html).tags if t == "iframe"] == []
    (live,) = [a for _, a in collect(html).tags if "data-live" in a]
    assert live["data-live"] == "a%20%22b%22.html"
    assert "3 MiB" in html
    assert "data-live=" not in render_report(data)


def test_every_tag_is_closed(data):
    assert collect(render_report(data)).open == []


def test_nothing_is_fetched_from_outside(data):
    html = render_report(data)
    for tag, attributes in collect(html).tags:
        for name in ("src", "href", "srcset", "action"):
            if name in attributes:
                assert attributes[name].startswith("data:"), (tag, attributes[name][:60])
    assert not re.search(r"url\(|@import|https?://", html)
    policy = next(a["content"] for t, a in collect(html).tags if a.get("http-equiv"))
    assert "default-src 'none'" in policy


def test_names_from_the_scene_are_text_not_markup(data):
    evil = '<script>alert("x")</script>'
    html = render_report(
        dataclasses.replace(
            data,
            title=evil,
            notes=(evil,),
            facts=((evil, evil),),
            provenance={"inputs": {evil: evil}, "command": evil},
            comparisons=(dataclasses.replace(data.comparisons[0], name=evil),),
        )
    )
    assert evil not in html
    assert sum(tag == "script" for tag, _ in collect(html).tags) == 1


def test_the_numbers_given_are_shown(data):
    html = render_report(data)
    for shown in (
        "0.0312",
        "2.30 × 10<sup>−4</sup>",
        "12.3 M samples/s",
        "31 M rays/s",
        "3 GiB",
        "512 samples",
    ):
        assert shown in html, shown
    assert "Sun and sky were added." in html
    assert ">75%<" in html  # trace's share of the time


def test_chart_utilisation_is_covered_over_all_texels(data):
    assert data.lightmap.n_texels == 8 * 16 + 16 * 4
    assert data.lightmap.utilisation == pytest.approx(192 / 512)
    assert "37.5%" in render_report(data)


def test_baked_reference_full_and_flip_are_all_on_the_stage(data):
    layers = [a["data-layer"] for _, a in collect(render_report(data)).tags if "data-layer" in a]
    assert layers == ["baked", "reference", "full", "flip"]


def test_without_full_materials_that_picture_is_left_out(data):
    bare = dataclasses.replace(data.comparisons[0], full=None)
    html = render_report(dataclasses.replace(data, comparisons=(bare,)))
    assert 'data-copy="full"' not in html
    assert 'data-show="full"' not in html


def test_a_report_without_views_or_convergence_still_stands(data):
    bare = dataclasses.replace(data, comparisons=(), convergence=None, notes=())
    html = render_report(bare)
    assert collect(html).open == []
    assert "Mean ratio over samples" not in html


def test_a_black_bake_has_a_report(data):
    black = LightmapSummary(np.zeros((1, 8, 8, 3), np.float32), np.ones((1, 8, 8), np.float32), 1.0)
    assert "Lightmap page 0" in render_report(dataclasses.replace(data, lightmap=black))


def test_a_page_without_a_single_texel_has_a_report(data):
    empty = LightmapSummary(np.zeros((1, 8, 8, 3), np.float32), np.zeros((1, 8, 8), np.float32), 1.0)
    assert "0.0%" in render_report(dataclasses.replace(data, lightmap=empty))


def test_the_whole_provenance_is_inside(data):
    html = render_report(data)
    record = re.search(r"<pre>(.*?)</pre>", html, re.DOTALL).group(1).replace("&quot;", '"')
    assert json.loads(record) == data.provenance


def test_the_report_is_written_whole(data, tmp_path):
    write_report(tmp_path / "report.html", data)
    assert (tmp_path / "report.html").read_text(encoding="utf-8") == render_report(data)
    assert [p.name for p in tmp_path.iterdir()] == ["report.html"]


def test_maps_beside_the_plain_one_are_shown_with_their_names(data):
    pixels = np.zeros((16, 16, 3), np.uint8)
    companions = (MapPicture("Shadow <mask>", pixels), MapPicture("Samples", pixels))
    lightmap = dataclasses.replace(data.lightmap, companions=companions, facts=(("Probes", "81"),))
    html = render_report(dataclasses.replace(data, lightmap=lightmap))
    names = [attrs["alt"] for tag, attrs in collect(html).tags if tag == "img" and attrs.get("alt")]
    assert {"Shadow <mask>", "Samples"} <= set(names)
    assert "<dt>Probes</dt><dd>81</dd>" in html
