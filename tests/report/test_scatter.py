"""Drawings on logarithmic axes."""

from __future__ import annotations

import itertools
import re

import numpy as np
import pytest

from irradia.report.scatter import Curve, Dot, curves_plot, evened, pareto_front, scatter_plot

DOTS = [
    Dot(1.0, 8.0, "small", "a"),
    Dot(2.0, 9.0, "beaten", "a"),
    Dot(4.0, 2.0, "middle", "b"),
    Dot(4.0, 3.0, "beaten at equal cost", "b"),
    Dot(9.0, 2.0, "beaten at equal error", "b"),
    Dot(10.0, 1.0, "large", "c"),
]


def test_the_front_holds_what_nothing_beats():
    assert [dot.name for dot in pareto_front(DOTS)] == ["small", "middle", "large"]


def test_one_dot_is_its_own_front_and_can_be_drawn():
    assert pareto_front(DOTS[:1]) == DOTS[:1]
    assert "nan" not in scatter_plot(DOTS[:1], "bytes", "error")


def test_equal_ratios_are_equal_distances():
    svg = scatter_plot([Dot(10.0**i, 1.0, str(i), "a") for i in range(1, 4)], "x", "y")
    places = [float(x) for x in re.findall(r'cx="([\d.]+)" cy="[\d.]+" r="4.5"><title>', svg)]
    assert places[2] - places[1] == pytest.approx(places[1] - places[0], abs=0.2)


def test_dots_stay_within_the_drawing():
    svg = scatter_plot(DOTS, "x", "y")
    for x, y in re.findall(r'cx="([\d.]+)" cy="([\d.]+)"', svg):
        assert 0 < float(x) < 640
        assert 0 < float(y) < 400


def test_every_axis_has_two_ticks_however_near_its_values_are():
    svg = curves_plot([Curve("c", "a", [(100.0, 0.19), (140.0, 0.24)])], "steps", "loss")
    assert svg.count('class="left"') >= 2
    assert svg.count('class="below"') >= 1


def test_names_are_escaped():
    assert "<b>" not in scatter_plot([Dot(1.0, 1.0, "<b>", "<b>")], "<b>", "<b>")


def test_points_without_a_logarithm_are_left_out():
    assert curves_plot([Curve("c", "a", [(0.0, 1.0), (1.0, 0.0)])], "x", "y") == ""


def _noisy(name: str, level: float) -> Curve:
    rng = np.random.default_rng(len(name))
    steps = np.arange(1, 2001)
    return Curve(name, "hash", [(float(s), level / s**0.5 * float(rng.lognormal(0.0, 0.5))) for s in steps])


def test_a_noisy_curve_is_drawn_by_few_points_on_its_course():
    points = evened(_noisy("a", 1.0).points)
    assert 10 < len(points) <= 40
    course = [y * x**0.5 for x, y in points]
    assert all(0.8 < c < 1.25 for c in course[20:])
    few = [(1.0, 2.0), (10.0, 1.0)]
    assert evened(few) == [pytest.approx(point) for point in few]


def test_chosen_curves_stand_out_and_are_named_without_touching():
    names = ["good", "as good", "a name so long that it wouldn't fit beside its curve", "bad"]
    svg = curves_plot([_noisy(name, 1.0 + 0.001 * i) for i, name in enumerate(names)], "s", "l", names[:3])
    assert svg.count('strong"') == 3
    assert svg.index("<title>bad") < svg.index("<title>good")  # faint ones lie behind
    ys = sorted(float(y) for y in re.findall(r'class="name" x="[\d.]+" y="([\d.]+)"', svg))
    assert len(ys) == 3
    assert min(b - a for a, b in itertools.pairwise(ys)) >= 13.9
    assert ">a name so long that it …<" in svg
    assert "<title>a name so long that it wouldn&#x27;t fit beside its curve</title>" in svg
