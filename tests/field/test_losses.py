"""Losses by hand, and what goes with what."""

from __future__ import annotations

import math
from typing import get_args

import numpy as np
import pytest

from irradia.core.errors import InputError
from irradia.field.backend import LossName
from irradia.field.encodings import Identity
from irradia.field.losses import check_loss, loss_and_gradient
from irradia.field.spec import FieldSpec, Head

P = np.array([[1.0, 2.0, 0.0]])
T = np.array([[0.0, 2.5, 0.3]])
LUMINANCE = 0.2126 * 1.0 + 0.7152 * 2.0


@pytest.mark.parametrize(
    ("name", "sum_of_three"),
    [
        ("l2", 1.0 + 0.25 + 0.09),
        ("relative_l2", 1.0 / 1.01 + 0.25 / 4.01 + 0.09 / 0.01),
        ("relative_l2_luminance", 1.34 / (LUMINANCE**2 + 0.01)),
        ("log", math.log(1.01 / 0.01) ** 2 + math.log(2.01 / 2.51) ** 2 + math.log(0.01 / 0.31) ** 2),
    ],
)
def test_losses_worked_out_by_hand(name, sum_of_three):
    assert loss_and_gradient(name, P, T)[0] == pytest.approx(sum_of_three / 3, rel=1e-12)


def test_the_denominator_of_a_relative_loss_is_constant():
    gradient = loss_and_gradient("relative_l2", P, T)[1]
    np.testing.assert_allclose(gradient, 2 / 3 * (P - T) / (P * P + 0.01))


def test_coefficients_are_weighed_by_the_luminance_of_the_first():
    prediction = np.concatenate([P, np.full((1, 9), 7.0)], axis=1)
    gradient = loss_and_gradient("relative_l2_luminance", prediction, np.zeros((1, 12)))[1]
    np.testing.assert_allclose(gradient, 2 / 12 * prediction / (LUMINANCE**2 + 0.01), rtol=1e-12)


@pytest.mark.parametrize("name", get_args(LossName))
def test_a_perfect_prediction_costs_nothing(name, rng):
    values = rng.uniform(0.0, 3.0, (4, 3))
    value, gradient = loss_and_gradient(name, values, values)
    assert value == 0.0
    assert not gradient.any()


@pytest.mark.parametrize("name", get_args(LossName))
def test_gradients_keep_the_precision_of_training(name):
    assert loss_and_gradient(name, P.astype(np.float32), T.astype(np.float32))[1].dtype == np.float32


@pytest.mark.parametrize("head", get_args(Head))
def test_the_log_loss_wants_a_head_above_zero(head):
    spec = FieldSpec(Identity(), Identity(), head=head)
    if head == "linear":
        with pytest.raises(InputError, match="head 'linear'"):
            check_loss("log", spec)
    else:
        check_loss("log", spec)


def test_an_unknown_loss_is_named_with_its_nearest():
    with pytest.raises(InputError, match="'relative_l2'"):
        check_loss("relative_l1", FieldSpec(Identity(), Identity()))  # pyright: ignore[reportArgumentType]
