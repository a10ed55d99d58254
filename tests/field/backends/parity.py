"""A backend's values, gradients and steps against the definition."""

from __future__ import annotations

import numpy as np
import pytest

from irradia.core.rng import Seed
from irradia.field.backend import (
    AdamOptions,
    Backend,
    Batch,
    LossName,
    Parameters,
    Rates,
    StepOptions,
    TrainState,
)
from irradia.field.init import new_parameters
from irradia.field.network import evaluate, loss_and_gradients
from irradia.field.spec import FieldSpec

GROUPS = ("parameters", "average", "first", "second")  # of a state
STILL = Rates(0.0, 0.0)
ADAM = AdamOptions(beta1=0.0)  # with it the first moment after a step is the gradient


def parameters_of(spec: FieldSpec) -> Parameters:
    """Large enough that nothing is nearly linear, biases not 0."""
    rng = np.random.default_rng(7)
    parameters = new_parameters(spec, Seed(3))
    for name, values in parameters.items():
        if not name.endswith("weight"):
            parameters[name] = rng.uniform(-0.5, 0.5, values.shape).astype(np.float32)
    return parameters


def exact(parameters: Parameters) -> dict[str, np.ndarray]:
    """In double precision."""
    return {name: values.astype(np.float64) for name, values in parameters.items()}


def gradients_of(
    backend: Backend, spec: FieldSpec, parameters: Parameters, batch: Batch, loss: LossName = "relative_l2"
) -> tuple[float, Parameters]:
    """The loss, and its gradients by name."""
    zeros = {name: np.zeros_like(values) for name, values in parameters.items()}
    options = StepOptions(loss, encoding_adam=ADAM, network_adam=ADAM, average=0.0)
    stepper = backend.stepper(spec, TrainState(parameters, {}, zeros, zeros, 0), options)
    return stepper.step(batch, STILL), stepper.state().first


def check_gradients(
    backend: Backend,
    spec: FieldSpec,
    batch: Batch,
    loss: LossName = "relative_l2",
    tolerance: float = 4e-6,
    loss_tolerance: float | None = None,
) -> None:
    """Within a few roundings of the largest gradient in each array; the loss likewise, if not said closer."""
    parameters = parameters_of(spec)
    expected_loss, expected = loss_and_gradients(spec, exact(parameters), batch, loss)
    found_loss, found = gradients_of(backend, spec, parameters, batch, loss)
    assert found_loss == pytest.approx(expected_loss, rel=loss_tolerance or tolerance)
    assert found.keys() == expected.keys()
    for name, gradient in expected.items():
        atol = tolerance * np.abs(gradient).max()
        np.testing.assert_allclose(found[name], gradient, rtol=0.0, atol=atol, err_msg=name)


def check_values(backend: Backend, spec: FieldSpec, batch: Batch, tolerance: float = 4e-6) -> None:
    """Within a few roundings of the definition in double precision."""
    parameters = parameters_of(spec)
    expected = evaluate(spec, exact(parameters), batch.x, batch.normal)
    found = backend.evaluator(spec, parameters)(batch.x, batch.normal)
    np.testing.assert_allclose(found, expected, rtol=tolerance, atol=tolerance * np.abs(expected).max())


def check_same_bits(a: TrainState, b: TrainState) -> None:
    """Of two states, all that they hold."""
    assert a.step == b.step
    for group in GROUPS:
        ours, theirs = getattr(a, group), getattr(b, group)
        assert ours.keys() == theirs.keys()
        for name in ours:
            np.testing.assert_array_equal(ours[name], theirs[name], err_msg=f"{group} of {name}")
