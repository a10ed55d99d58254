"""Adam and the running mean by hand."""

from __future__ import annotations

import numpy as np
import pytest

from irradia.field.adam import adam, running_mean
from irradia.field.backend import AdamOptions, StepOptions, TrainState
from irradia.field.training.start import inference_parameters

PLAIN = AdamOptions(beta1=0.5, beta2=0.75, epsilon=0.0)


def test_two_steps_worked_out_by_hand():
    value, first, second = np.array([1.0]), np.zeros(1), np.zeros(1)
    value, first, second = adam(value, np.array([2.0]), first, second, 1, 0.1, PLAIN)
    assert (first[0], second[0]) == (1.0, 1.0)
    assert value[0] == pytest.approx(0.9)  # the first step is as long as the rate
    value, first, second = adam(value, np.array([-1.0]), first, second, 2, 0.1, PLAIN)
    assert (first[0], second[0]) == (0.0, 1.0)
    assert value[0] == pytest.approx(0.9)


def test_a_third_gradient_moves_against_its_sign_by_the_formula():
    first, second = np.array([0.4]), np.array([0.2])
    value, *_ = adam(np.array([0.0]), np.array([0.6]), first, second, 3, 0.01, PLAIN)
    expected = -0.01 * (0.5 / 0.875) / np.sqrt(0.24 / (1 - 0.75**3))
    assert value[0] == pytest.approx(expected, rel=1e-12)


def test_epsilon_keeps_values_without_any_gradient_in_place():
    value, *_ = adam(np.ones(2), np.zeros(2), np.zeros(2), np.zeros(2), 1, 0.1, AdamOptions())
    np.testing.assert_array_equal(value, 1.0)


def test_skipped_values_keep_their_moments():
    options = AdamOptions(skip_zero=True)
    first, second = np.array([0.3, 0.3]), np.array([0.2, 0.2])
    value, new_first, new_second = adam(np.ones(2), np.array([0.0, 1.0]), first, second, 5, 0.1, options)
    assert (value[0], new_first[0], new_second[0]) == (1.0, 0.3, 0.2)
    assert value[1] != 1.0
    assert new_first[1] != 0.3


def test_values_that_are_not_skipped_move_on_by_their_moments():
    value, *_ = adam(np.ones(1), np.zeros(1), np.array([0.3]), np.array([0.2]), 5, 0.1, AdamOptions())
    assert value[0] < 1.0


def state(values: list[float], decay: float) -> TrainState:
    mean = np.zeros(1, np.float32)
    for value in values:
        mean = running_mean(mean, np.float32([value]), decay)
    last = {"w": np.float32([values[-1]])}
    return TrainState(last, {"w": mean} if decay else {}, last, last, len(values))


def test_the_mean_of_a_constant_is_that_constant_from_the_first_step():
    for n_steps in (1, 2, 30):
        options = StepOptions(average=0.9)
        assert inference_parameters(state([3.0] * n_steps, 0.9), options)["w"][0] == pytest.approx(3.0)


def test_the_mean_weighs_the_past_by_its_decay():
    found = inference_parameters(state([1.0, 4.0], 0.5), StepOptions(average=0.5))["w"][0]
    assert found == pytest.approx((0.5 * 1.0 + 4.0) / 1.5)


def test_without_a_mean_or_for_frozen_values_inference_takes_the_last():
    assert inference_parameters(state([1.0, 4.0], 0.0), StepOptions(average=0.0))["w"][0] == 4.0
    frozen = StepOptions(average=0.5, frozen=frozenset({"w"}))
    assert inference_parameters(state([1.0, 4.0], 0.5), frozen)["w"][0] == 4.0
