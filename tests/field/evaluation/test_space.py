"""Scores in space and near walls, with the samples' own noise taken out."""

from __future__ import annotations

import numpy as np
import pytest

from irradia.core.errors import InputError
from irradia.field.evaluation import leak_ratio, score_in_space

N = 20_000


def _samples(noise: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    rng = np.random.default_rng(2)
    truth = rng.uniform(0.5, 2.0, (N, 3))
    return truth, truth + rng.normal(0.0, noise, (N, 3)), np.full(N, noise**2)


def test_the_error_is_told_apart_from_the_noise():
    truth, samples, variance = _samples(0.2)
    scores = score_in_space(truth + 0.1, samples, variance)
    assert scores.mse == pytest.approx(0.1**2 + 0.2**2, rel=0.05)
    assert scores.mse_noise_free == pytest.approx(0.1**2, rel=0.1)
    assert not scores.is_noise


def test_an_error_below_the_noise_is_flagged():
    _, samples, variance = _samples(0.2)
    assert score_in_space(samples, samples, variance).is_noise


def test_scores_of_known_values_are_their_formulas():
    values, truth = np.array([[1.0, 2.0, 3.0]]), np.array([[2.0, 2.0, 2.0]])
    scores = score_in_space(values, truth, np.zeros(1))
    assert (scores.mse, scores.mae, scores.mean_ratio) == pytest.approx((2 / 3, 2 / 3, 1.0))
    assert scores.relmse == pytest.approx((1 / 4 + 1 / 4) / 3 / 1.01)


@pytest.mark.parametrize("n", [0, 3])
def test_values_must_be_as_many_as_samples(n):
    with pytest.raises(InputError, match="expected as many values"):
        score_in_space(np.zeros((n, 3)), np.zeros((0, 3)), np.zeros(0))


def test_light_that_is_not_finite_is_refused():
    with pytest.raises(InputError, match="finite"):
        score_in_space(np.full((1, 3), np.nan), np.zeros((1, 3)), np.zeros(1))


def test_leak_ratio_is_that_of_the_errors_on_either_side():
    truth, samples, variance = _samples(0.05)
    distance_m = np.random.default_rng(4).uniform(0.0, 0.5, N)
    values = truth + np.where(distance_m <= 0.05, 0.3, 0.1)[:, None]
    found = leak_ratio(values, samples, variance, distance_m)
    assert found.ratio == pytest.approx(3.0, rel=0.05)
    assert found.n_near + found.n_elsewhere == N


def test_too_few_places_near_walls_give_no_ratio():
    truth, samples, variance = _samples(0.0)
    assert leak_ratio(truth + 1.0, samples, variance, np.ones(N)).ratio is None
