"""Windowing: never negative, no more than needed, the mean untouched."""

from __future__ import annotations

import numpy as np
import pytest

from irradia.bake.probes.window import band_weights, window
from irradia.core.sh import fibonacci_sphere, irradiance, sh_basis


@pytest.fixture(scope="module")
def spiky() -> np.ndarray:
    """Probes lit by one to four coloured lights each, as hard as light gets, and one in the dark."""
    rng = np.random.default_rng(8)
    probes = []
    for k in range(300):
        n = 1 + k % 4
        directions = rng.normal(size=(n, 3))
        directions /= np.linalg.norm(directions, axis=1, keepdims=True)
        probes.append(sh_basis(directions).T @ rng.exponential(size=(n, 3)) ** 2)
    probes.append(np.zeros((9, 3)))
    return np.array(probes, np.float32)


def test_irradiance_is_nowhere_negative_even_between_the_directions_that_were_looked_at(spiky):
    damped, strength = window(spiky)
    assert (strength > 0).mean() > 0.5
    for directions in (fibonacci_sphere(1000), fibonacci_sphere(7919)):
        assert irradiance(damped[:, None], directions).min() >= 0.0


def test_halfs_of_windowed_probes_are_not_negative_either(spiky):
    damped, _ = window(spiky)
    halfs = damped.astype(np.float16).astype(np.float32)
    assert irradiance(halfs[:, None], fibonacci_sphere(1000)).min() >= 0.0


def test_mean_light_is_unchanged_to_the_bit(spiky):
    damped, _ = window(spiky)
    np.testing.assert_array_equal(damped[:, 0], spiky[:, 0])


def test_a_little_less_would_not_do(spiky):
    _, strength = window(spiky)
    some = strength > 0
    less = spiky * band_weights(0.99 * strength)[..., None]
    e = irradiance(less[some][:, None], fibonacci_sphere(1000))
    mean = np.pi * sh_basis((0, 0, 1))[0] * spiky[some][:, None, 0]
    assert np.all((e < 5e-3 * mean).any(axis=(1, 2)))


def test_light_that_needs_no_window_is_left_alone():
    series = np.zeros((1, 9, 3), np.float32)
    series[0, 0], series[0, 1] = 1.0, 0.4
    damped, strength = window(series)
    assert strength[0] == 0.0
    np.testing.assert_array_equal(damped, series)


def test_all_channels_are_damped_alike():
    """Else a red lamp's probe would have another hue on its far side."""
    series = np.zeros((1, 9, 3), np.float32)
    series[0, :, 0] = sh_basis((1, 0, 0))
    series[0, 0, 1] = 1.0
    series[0, 3, 1] = 0.1
    damped, strength = window(series)
    factors = band_weights(strength)[0]
    np.testing.assert_allclose(damped[0], series[0] * factors[:, None], rtol=1e-6)
