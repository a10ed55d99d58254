"""Every gradient against central differences in double precision, over all that is registered."""

from __future__ import annotations

from collections.abc import Callable
from typing import get_args

import numpy as np
import pytest

from irradia.core.rng import Seed
from irradia.field.activations import ACTIVATIONS, Activation
from irradia.field.backend import LossName
from irradia.field.encodings import HashGrid, SphericalHarmonics
from irradia.field.heads import HEADS
from irradia.field.init import new_parameters
from irradia.field.losses import WEIGHTS, loss_and_gradient
from irradia.field.network import evaluate, loss_and_gradients
from irradia.field.spec import ActivationName, FieldSpec, Head

STEP = 1e-5
SPEC = FieldSpec(
    HashGrid(3, 6, 2, 3, 11), SphericalHarmonics(2), width=8, n_hidden_layers=2, activation="silu"
)


def difference(function: Callable[[np.ndarray], float], at: np.ndarray) -> np.ndarray:
    """Central differences with respect to every value."""
    found = np.zeros_like(at)
    for index in np.ndindex(at.shape):
        step = np.zeros_like(at)
        step[index] = STEP
        found[index] = (function(at + step) - function(at - step)) / (2.0 * STEP)
    return found


def check_slope(function: Activation) -> None:
    z = np.linspace(-6.0, 6.0, 48)  # none within a step of 0, where some have a kink
    expected = (function.value(z + STEP) - function.value(z - STEP)) / (2.0 * STEP)
    np.testing.assert_allclose(function.slope(z), expected, rtol=1e-7, atol=1e-9)


def test_encodings_know_the_gradient_of_their_parameters(small_encoding, rng):
    x = rng.random((9, 3), np.float32)
    parameters = rng.normal(size=small_encoding.n_parameters)
    of_features = rng.normal(size=(9, small_encoding.n_outputs))

    def loss(values: np.ndarray) -> float:
        return float((small_encoding.forward(x, values) * of_features).sum())

    found = small_encoding.backward(x, parameters, of_features)
    np.testing.assert_allclose(found, difference(loss, parameters), rtol=1e-6, atol=1e-8)
    assert small_encoding.n_parameters == 0 or np.abs(found).max() > 0.1


@pytest.mark.parametrize("name", get_args(ActivationName))
def test_activations_know_their_slope(name):
    check_slope(ACTIVATIONS[name])


@pytest.mark.parametrize("name", get_args(Head))
def test_heads_know_their_slope(name):
    check_slope(HEADS[name])


def held_loss(name: LossName, at: np.ndarray, target: np.ndarray) -> Callable[[np.ndarray], float]:
    """The loss near ``at``, its denominator held there: what gradients are taken of."""
    if name == "log":
        return lambda prediction: loss_and_gradient("log", prediction, target)[0]
    weight = WEIGHTS[name](at)
    return lambda prediction: float((weight * (prediction - target) ** 2).mean())


@pytest.mark.parametrize("n_outputs", [3, 12, 27])
@pytest.mark.parametrize("name", get_args(LossName))
def test_losses_know_their_gradient(name, n_outputs, rng):
    prediction, target = rng.uniform(0.05, 2.0, (2, 5, n_outputs))
    held = held_loss(name, prediction, target)
    value, gradient = loss_and_gradient(name, prediction, target)
    assert value == pytest.approx(held(prediction), rel=1e-12)
    np.testing.assert_allclose(gradient, difference(held, prediction), rtol=1e-6, atol=1e-10)


def check_whole(
    spec: FieldSpec, make_batch, rng: np.random.Generator, loss: LossName = "relative_l2"
) -> None:
    """The loss along a random direction of each array of parameters, against its gradient."""
    batch = make_batch(spec)
    start = new_parameters(spec, Seed(3))
    parameters = {name: rng.normal(0.0, 0.1, value.shape) + value for name, value in start.items()}
    held = held_loss(loss, evaluate(spec, parameters, batch.x, batch.normal), batch.target)
    _, gradients = loss_and_gradients(spec, parameters, batch, loss)
    assert gradients.keys() == parameters.keys()
    for name, value in parameters.items():
        along = rng.normal(size=value.shape)

        def moved(by: float, name: str = name, along: np.ndarray = along) -> float:
            there = parameters | {name: parameters[name] + by * along}
            return held(evaluate(spec, there, batch.x, batch.normal))

        slope = (moved(STEP) - moved(-STEP)) / (2 * STEP)
        assert (gradients[name] * along).sum() == pytest.approx(slope, rel=1e-4, abs=1e-9), name


def test_fields_know_their_gradient_with_every_encoding(small_encoding, make_batch, rng):
    check_whole(FieldSpec(small_encoding, small_encoding, 6, 2, "gelu"), make_batch, rng)


@pytest.mark.parametrize("name", get_args(ActivationName))
def test_fields_know_their_gradient_with_every_activation(name, make_batch, rng):
    check_whole(FieldSpec(SPEC.position, SPEC.direction, 8, 3, name), make_batch, rng)


@pytest.mark.parametrize("head", get_args(Head))
def test_fields_know_their_gradient_with_every_head(head, make_batch, rng):
    check_whole(FieldSpec(SPEC.position, SPEC.direction, 8, 1, "silu", head), make_batch, rng)


@pytest.mark.parametrize("loss", get_args(LossName))
def test_fields_know_their_gradient_with_every_loss(loss, make_batch, rng):
    check_whole(SPEC, make_batch, rng, loss)


@pytest.mark.parametrize("mode", ["sh1", "sh2"])
def test_fields_of_coefficients_know_their_gradient(mode, make_batch, rng):
    spec = FieldSpec(SPEC.position, None, 8, 2, "silu", "linear", mode)
    check_whole(spec, make_batch, rng, "relative_l2_luminance")
