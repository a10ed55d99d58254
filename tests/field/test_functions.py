"""Activations and heads by hand."""

from __future__ import annotations

import numpy as np
import pytest

from irradia.field.activations import ACTIVATIONS
from irradia.field.heads import EXP_LIMIT, HEADS

Z = np.array([-2.0, -0.5, 0.25, 1.5])


@pytest.mark.parametrize(
    ("name", "expected"),
    [
        ("relu", [0.0, 0.0, 0.25, 1.5]),
        ("leaky_relu", [-0.02, -0.005, 0.25, 1.5]),
        ("silu", [-0.238406, -0.188770, 0.140544, 1.226361]),
        ("gelu", [-0.045402, -0.154286, 0.149675, 1.399572]),
        ("sine", [-0.909297, -0.479426, 0.247404, 0.997495]),
    ],
)
def test_activations_worked_out_by_hand(name, expected):
    np.testing.assert_allclose(ACTIVATIONS[name].value(Z), expected, atol=2e-6)


@pytest.mark.parametrize(
    ("name", "expected"),
    [
        ("exp", [0.135335, 0.606531, 1.284025, 4.481689]),
        ("softplus", [0.126928, 0.474077, 0.825939, 1.701413]),
        ("linear", [-2.0, -0.5, 0.25, 1.5]),
    ],
)
def test_heads_worked_out_by_hand(name, expected):
    np.testing.assert_allclose(HEADS[name].value(Z), expected, atol=2e-6)


@pytest.mark.parametrize("name", ["exp", "softplus"])
def test_heads_above_zero_stay_finite_and_can_come_back(name):
    z = np.array([-1e4, 1e4], np.float32)
    assert np.isfinite(HEADS[name].value(z)).all()
    assert HEADS[name].slope(z)[1] > 0.0


def test_the_exponential_head_is_clamped():
    np.testing.assert_allclose(HEADS["exp"].value(np.array([-99.0, 99.0])), np.exp([-EXP_LIMIT, EXP_LIMIT]))


@pytest.mark.parametrize("function", [*ACTIVATIONS.values(), *HEADS.values()])
def test_precision_is_that_of_the_input(function):
    for kind in (np.float32, np.float64):
        assert function.value(Z.astype(kind)).dtype == function.slope(Z.astype(kind)).dtype == kind
