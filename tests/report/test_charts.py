"""The drawings."""

from __future__ import annotations

import itertools
import re

import pytest

from irradia.report import charts
from irradia.report.data import Convergence


def _points(svg: str) -> list[tuple[float, float]]:
    listed = re.search(r'<polyline points="([^"]+)"', svg).group(1)
    return [tuple(map(float, pair.split(","))) for pair in listed.split()]


def test_the_bar_is_cut_in_proportion():
    grown = re.findall(r"flex-grow:([\d.]+)", charts.stage_bar({"trace": 30.0, "write": 10.0}))
    assert [float(g) for g in grown] == [0.75, 0.25]


def test_no_times_is_said():
    assert "No times" in charts.stage_bar({})


def test_short_stages_share_a_row_and_no_time_is_lost():
    stages = {f"stage {i}": 10.0 + i for i in range(12)} | {f"step {i}": 0.01 for i in range(20)}
    bar = charts.stage_bar(stages)
    rows = re.findall(r"</i>([^<]*)</td>", bar)
    assert rows == [*(f"stage {i}" for i in range(4, 12)), "24 shorter stages"]
    grown = [float(share) for share in re.findall(r"flex-grow:([\d.]+)", bar)]
    assert sum(grown) == pytest.approx(1.0, abs=1e-4)


def test_one_short_stage_keeps_its_name():
    assert "shorter" not in charts.stage_bar({"trace": 1000.0, "write": 0.1})


def test_each_doubling_of_samples_is_one_step_to_the_right():
    xs = [x for x, _ in _points(charts.mean_ratio_plot(Convergence((1, 2, 4, 8), (1.0, 1.0, 1.0, 1.0))))]
    steps = [b - a for a, b in itertools.pairwise(xs)]
    assert max(steps) - min(steps) < 0.2


def test_a_higher_ratio_is_drawn_higher_and_one_in_the_middle():
    (_, low), (_, one), (_, high) = _points(charts.mean_ratio_plot(Convergence((1, 2, 4), (0.9, 1.0, 1.1))))
    assert low > one > high
    assert abs((low + high) / 2 - one) < 0.2


def test_a_single_point_can_be_drawn():
    assert len(_points(charts.mean_ratio_plot(Convergence((64,), (1.0,))))) == 1


def test_labels_stay_few_and_keep_the_last():
    kept = charts._sparse([2**i for i in range(20)])
    assert len(kept) <= 8
    assert kept[-1] == 2**19
