"""The clock of queries."""

from __future__ import annotations

import time

import numpy as np
import pytest

from irradia.field.evaluation import queries_per_second


class Sleeper:
    """Takes a known time, and looks at what it is given."""

    def __init__(self) -> None:
        self.asked = []

    def __call__(self, x, normal):
        self.asked.append((x, normal))
        time.sleep(0.02)
        return x


def test_the_rate_is_queries_over_the_median_time():
    assert queries_per_second(Sleeper(), directional=True, n_queries=1000) == pytest.approx(50_000, rel=0.3)


def test_queries_are_positions_in_the_box_and_unit_normals():
    sleeper = Sleeper()
    queries_per_second(sleeper, directional=True, n_queries=100, repeats=1)
    x, normal = sleeper.asked[0]
    assert 0.0 <= x.min() < x.max() < 1.0
    np.testing.assert_allclose(np.linalg.norm(normal, axis=1), 1.0, rtol=1e-5)


def test_fields_without_direction_get_none():
    sleeper = Sleeper()
    queries_per_second(sleeper, directional=False, n_queries=10, repeats=1)
    assert sleeper.asked[0][1] is None
