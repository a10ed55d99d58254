"""The page of a sweep."""

from __future__ import annotations

import re

import numpy as np

from irradia.report.sweep import SweepData, render_sweep


def row(name, relmse, n_bytes, **more):
    return {
        "name": name,
        "status": "done",
        "relmse": relmse,
        "bytes": n_bytes,
        "train_s": 1.0,
        "flops": 100,
        "option.encoding": "hash",
        **more,
    }


ROWS = [row("b<ig>", 0.1, 9000), row("small", 0.2, 100)]


def test_runs_are_listed_best_first_with_values_to_sort_by():
    page = render_sweep(SweepData("t", "s", ROWS))
    assert page.index("b&lt;ig&gt;</td>") < page.index("small</td>")
    assert 'data-value="9000"' in page
    assert "<ig>" not in page


def test_a_field_whose_error_is_no_number_is_last_and_has_a_dash():
    page = render_sweep(SweepData("t", "s", [row("broken", None, 50), *ROWS]))
    assert page.index("small</td>") < page.index("broken</td>")
    assert "<td>–</td>" in page
    assert "<title>broken" not in page


def test_each_cost_has_a_drawing_with_every_run():
    page = render_sweep(SweepData("t", "s", ROWS))
    assert len(re.findall(r"<title>small: ", page)) == 3


def test_a_failed_run_is_told_and_not_drawn():
    failed = {"name": "bad", "status": "failed", "error": "it was wrong"}
    page = render_sweep(SweepData("t", "s", [*ROWS, failed]))
    assert "bad failed: it was wrong" in page
    assert "<title>bad" not in page


def test_pictures_are_inside_the_page():
    page = render_sweep(SweepData("t", "s", ROWS, pictures={"reference": np.ones((4, 4, 3), np.float32)}))
    assert 'src="data:image/' in page
    assert not re.search(r'(src|href)="(?!data:)', page)


def test_a_sweep_without_results_still_has_a_page():
    assert "Provenance" in render_sweep(SweepData("t", "s", []))
