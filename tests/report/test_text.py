"""Numbers as people read them."""

from __future__ import annotations

import pytest

from irradia.report import text


@pytest.mark.parametrize(
    ("value", "shown"), [(12.3e6, "12.3 M rays/s"), (950.0, "950 rays/s"), (None, "–"), (float("nan"), "–")]
)
def test_rates(value, shown):
    assert text.rate(value, "rays/s") == shown


@pytest.mark.parametrize(
    ("value", "shown"), [(3 << 30, "3 GiB"), (1536, "1.5 KiB"), (12, "12 B"), (None, "–")]
)
def test_sizes(value, shown):
    assert text.size(value) == shown


@pytest.mark.parametrize(
    ("value", "shown"), [(0.421, "0.42 s"), (12.34, "12.3 s"), (125, "2 min 5 s"), (119.7, "2 min 0 s")]
)
def test_durations(value, shown):
    assert text.duration(value) == shown


@pytest.mark.parametrize(
    ("value", "shown"),
    [
        (0.99871, "0.9987"),
        (2.3e-4, "2.30 × 10<sup>−4</sup>"),
        (0.0, "0"),
        (float("inf"), "∞"),
        (float("nan"), "–"),
    ],
)
def test_scores(value, shown):
    assert text.score(value) == shown


@pytest.mark.parametrize(("value", "shown"), [(821000, "821\u202f000"), (0.5, "0.5"), (float("nan"), "–")])
def test_counts(value, shown):
    assert text.count(value) == shown


def test_exposures_have_a_true_minus_sign():
    assert text.stops(-1.94) == "−1.9 EV"
    assert text.stops(2.0) == "+2.0 EV"
