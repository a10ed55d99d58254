"""A field's report, alone and inside that of a bake."""

from __future__ import annotations

import re

import numpy as np
import pytest

from irradia.report import (
    Comparison,
    EvaluationData,
    FieldSummary,
    Rival,
    render_evaluation,
    write_evaluation,
)
from irradia.report.neural_field import field_sections


@pytest.fixture
def field() -> FieldSummary:
    reference = np.random.default_rng(3).random((18, 32, 3), np.float32)
    view = Comparison(
        "hall, neural field",
        reference * 1.01,
        reference,
        None,
        reference[..., 0],
        {"flip": 0.0312, "mean_ratio": 1.0001},
        512,
        label="Neural field",
        under_noise=frozenset({"mean_ratio"}),
        exposure_ev=-3.0,
    )
    rivals = (
        Rival("neural field", 200_000, 0.0312, 2.3e-4, 1.5e-3),
        Rival("SH L2 grid, 9 × 9 × 9", 199_000, 0.21, 0.05, 0.031),
        Rival("lightmap, 224²", 198_000, 0.05, 0.01, None, under_noise=True),
    )
    return FieldSummary((("Encoding", "hash"),), (view,), rivals)


@pytest.fixture
def data(field) -> EvaluationData:
    return EvaluationData("hall", field, {"render": 3.0}, {"seed": 5}, ("The reference is noisy.",))


def test_the_field_takes_the_place_of_the_bake_on_the_stage(data):
    html = render_evaluation(data)
    assert '<span class="tag tag-left">Neural field</span>' in html
    assert "Neural field against the reference" in html
    assert "Baked" not in html.split("<script>")[0].split("</style>")[1]


def test_rows_of_the_table_of_rivals_stand_in_no_other_row(field):
    table = re.search(r'<table class="numbers">(.*?)</table>', "".join(field_sections(field)), re.DOTALL)
    assert table is not None
    rows = re.split(r"<tr>|</tr>", table[1])
    assert table[1].count("<tr>") == table[1].count("</tr>") == 1 + len(field.rivals)
    assert [row.count("<td>") for row in rows if row] == [5] * (1 + len(field.rivals))


def test_rivals_stand_in_order_with_their_bytes(field):
    html = "".join(field_sections(field))
    order = [html.index(rival.name) for rival in field.rivals]
    assert order == sorted(order)
    for shown in ("195 KiB", "0.0312", "2.30 × 10<sup>−4</sup>", "0.031"):
        assert shown in html, shown


def test_what_a_rival_has_no_figure_for_is_a_dash(field):
    lightmap = "".join(field_sections(field)).split("lightmap, 224²")[1].split("</tr>")[0]
    assert "<td>–</td>" in lightmap


def test_scores_under_the_noise_are_marked(field):
    html = "".join(field_sections(field))
    assert html.count("under the reference's own noise") == 1
    assert re.search(r"≈ 0\.05<", html)


def test_the_exposure_that_was_asked_for_is_shown(data):
    assert "exposure −3.0 EV" in render_evaluation(data)


def test_views_are_numbered_on_from_those_before(field):
    assert 'id="view-2"' in field_sections(field, first_view=2)[0]


def test_names_are_text_not_markup(data, field):
    evil = "<script>alert(1)</script>"
    rival = Rival(evil, 1)
    html = "".join(field_sections(FieldSummary(((evil, evil),), (), (rival,))))
    assert evil not in html


def test_the_page_is_written_whole(data, tmp_path):
    write_evaluation(tmp_path / "eval.html", data)
    assert (tmp_path / "eval.html").read_text(encoding="utf-8") == render_evaluation(data)
    assert "The reference is noisy." in render_evaluation(data)
