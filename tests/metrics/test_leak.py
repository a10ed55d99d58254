"""The leak measure takes the worst place, not the mean."""

from __future__ import annotations

import math

import numpy as np
import pytest

from irradia.metrics.leak import leak

INSIDE = np.array([True, True, True, False, False])


def values(*inside: float, outside: float = 2.0) -> np.ndarray:
    return np.array([*inside, outside, outside], np.float32)[:, None] * np.ones(3, np.float32)


def test_a_black_inside_does_not_leak():
    assert leak(values(0, 0, 0), INSIDE, ~INSIDE) == 0.0


def test_one_bright_place_is_the_whole_leak():
    assert leak(values(0, 0.5, 0), INSIDE, ~INSIDE) == pytest.approx(0.25)


def test_one_bright_channel_counts():
    light = values(0, 0, 0)
    light[1, 2] = 1.0
    assert leak(light, INSIDE, ~INSIDE) == pytest.approx(0.5)


def test_negative_light_is_a_leak_too():
    assert leak(values(0, -0.5, 0), INSIDE, ~INSIDE) == pytest.approx(0.25)


def test_light_inside_a_dark_world_is_infinite():
    assert math.isinf(leak(values(0, 1, 0, outside=0.0), INSIDE, ~INSIDE))


@pytest.mark.parametrize("inside", [np.zeros(5, bool), np.ones(5, bool)])
def test_without_an_inside_or_an_outside_there_is_no_figure(inside):
    with pytest.raises(ValueError, match="inside and outside"):
        leak(values(0, 0, 0), inside, ~inside)
