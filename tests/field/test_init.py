"""Where training starts."""

from __future__ import annotations

from typing import get_args

import numpy as np
import pytest

from irradia.core.rng import Seed
from irradia.field.backend import StepOptions
from irradia.field.encodings import Identity, OneBlob, TriPlane
from irradia.field.init import new_parameters, new_state
from irradia.field.mlp import forward
from irradia.field.spec import ActivationName, FieldSpec


def test_parameters_are_those_of_the_spec(small_encoding):
    spec = FieldSpec(small_encoding, small_encoding, 8, 3)
    found = new_parameters(spec, Seed(1))
    assert {name: value.shape for name, value in found.items()} == spec.parameter_shapes()
    assert {value.dtype for value in found.values()} == {np.dtype(np.float32)}


def test_the_same_seed_starts_the_same_and_another_differs():
    spec = FieldSpec(TriPlane(4, 2), Identity(), 8, 1)
    one, same, other = (new_parameters(spec, Seed(root)) for root in (1, 1, 2))
    for name, value in one.items():
        np.testing.assert_array_equal(value, same[name])
    assert (one["position"] != other["position"]).all()


def test_each_array_has_a_stream_of_its_own():
    one = new_parameters(FieldSpec(Identity(), Identity(), 8, 2), Seed(1))
    other = new_parameters(FieldSpec(TriPlane(4, 1), Identity(), 8, 3), Seed(1))
    np.testing.assert_array_equal(one["mlp.1.weight"], other["mlp.1.weight"])


@pytest.mark.parametrize("activation", get_args(ActivationName))
def test_activations_neither_vanish_nor_explode_through_six_layers(activation, rng):
    spec = FieldSpec(OneBlob(32), OneBlob(8), 128, 6, activation, "linear")
    tape = forward(spec, new_parameters(spec, Seed(4)), rng.normal(size=(256, spec.n_inputs)))[1]
    sizes = [float(np.std(raw)) for raw in tape.raw[:-1]]
    assert 0.2 < sizes[-1] / sizes[0] < 2.0 or (activation == "sine" and 0.5 < sizes[-1] < 2.0)


def test_the_first_sines_are_slower_on_features_that_cannot_adapt():
    def largest(encoding):
        spec = FieldSpec(encoding, Identity(), activation="sine")
        return np.abs(new_parameters(spec, Seed(1))["mlp.0.weight"]).max()

    assert largest(TriPlane(4, 16)) == pytest.approx(30 / 51, rel=0.01)
    assert largest(OneBlob(16)) == pytest.approx(10 / 51, rel=0.01)


def test_a_training_begins_with_moments_and_means_of_zero():
    spec = FieldSpec(TriPlane(4, 1), Identity(), 8, 1)
    state = new_state(spec, Seed(1))
    assert state.step == 0
    for group in (state.first, state.second, state.average):
        assert {name: value.shape for name, value in group.items()} == spec.parameter_shapes()
        assert not any(value.any() for value in group.values())
    assert new_state(spec, Seed(1), StepOptions(average=0.0)).average == {}
