"""The registry of backends, and the reference among them."""

from __future__ import annotations

import subprocess
import sys
from dataclasses import replace

import numpy as np
import pytest

from irradia.core.device import CudaStatus
from irradia.core.errors import InputError, MissingDependencyError
from irradia.core.rng import Seed
from irradia.field import backends
from irradia.field.backend import AdamOptions, Rates, StepOptions
from irradia.field.backends import backend, matrix, matrix_text, numpy_backend
from irradia.field.backends.numpy_backend import NumpyBackend
from irradia.field.encodings import HashGrid, Identity, SphericalHarmonics
from irradia.field.init import new_parameters, new_state
from irradia.field.registry import ENCODINGS
from irradia.field.spec import FieldSpec

SPEC = FieldSpec(HashGrid(3, 6, 2, 3, 11), SphericalHarmonics(2), width=8)
RATES = Rates(encoding=0.01, network=0.01)


def test_numpy_can_do_every_encoding_and_the_matrix_has_them_all():
    table = matrix()
    assert table.keys() == ENCODINGS.keys()
    assert all(row["numpy"] for row in table.values())
    assert all(row.keys() == backends.BACKENDS.keys() for row in table.values())


def test_the_printed_matrix_has_a_line_an_encoding():
    head, *rows = matrix_text().splitlines()
    assert head.split() == ["encoding", *backends.BACKENDS]
    assert [row.split()[0] for row in rows] == list(ENCODINGS)


def test_the_automatic_choice_is_a_backend_that_can():
    assert not backend("auto", SPEC).lacks(SPEC)


def test_a_gpus_backend_is_no_automatic_choice_without_a_gpu(monkeypatch):
    abacus = ("numba_backend", "NumbaBackend", "numba")
    monkeypatch.setattr(backends, "BACKENDS", {"abacus": abacus, "numpy": backends.BACKENDS["numpy"]})
    monkeypatch.setattr(backends, "ON_GPU", frozenset({"abacus"}))
    for gpu, chosen in ((None, "numpy"), ("a GPU", "numba")):
        monkeypatch.setattr(backends, "cuda_status", lambda gpu=gpu: CudaStatus(gpu, False, ""))
        assert backend("auto", SPEC).name == chosen


def test_an_unknown_backend_is_named_with_its_nearest():
    with pytest.raises(InputError, match=r"(?s)no backend 'nunpy'.*'numpy'"):
        backend("nunpy")


def test_a_backend_whose_library_is_absent_says_what_to_install(monkeypatch):
    monkeypatch.setitem(backends.BACKENDS, "abacus", ("numpy_backend", "NumpyBackend", "no_such_library"))
    with pytest.raises(MissingDependencyError, match="pip install no_such_library"):
        backend("abacus")
    assert "abacus" not in backends.available()


def test_a_backend_that_cannot_do_a_field_says_why(monkeypatch):
    monkeypatch.setattr(NumpyBackend, "lacks", lambda self, spec: "the encoding hash")
    with pytest.raises(InputError, match="numpy can't compute this field: the encoding hash"):
        backend("numpy", SPEC)


def test_importing_fields_loads_no_compiler():
    heavy = "import sys, irradia.field.field; print(sorted({'numba', 'drjit', 'mitsuba'} & set(sys.modules)))"
    done = subprocess.run([sys.executable, "-c", heavy], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


def test_training_lowers_the_loss(make_batch):
    batch = make_batch(SPEC, 64)
    stepper = NumpyBackend().stepper(SPEC, new_state(SPEC, Seed(1)), StepOptions())
    losses = [stepper.step(batch, RATES) for _ in range(40)]
    assert losses[-1] < 0.3 * losses[0]


def test_a_training_goes_on_from_its_state_as_if_it_had_not_stopped(make_batch):
    batches = [make_batch(SPEC) for _ in range(6)]
    whole = NumpyBackend().stepper(SPEC, new_state(SPEC, Seed(1)), StepOptions())
    for batch in batches:
        whole.step(batch, RATES)
    state = new_state(SPEC, Seed(1))
    for half in (batches[:3], batches[3:]):
        part = NumpyBackend().stepper(SPEC, state, StepOptions())
        for batch in half:
            part.step(batch, RATES)
        state = part.state()
    assert state.step == whole.state().step == 6
    for group in ("parameters", "average", "first", "second"):
        for name, values in getattr(whole.state(), group).items():
            np.testing.assert_array_equal(values, getattr(state, group)[name])
            assert values.dtype == np.float32


def test_a_state_given_in_or_out_is_a_copy(make_batch):
    state = new_state(SPEC, Seed(1))
    stepper = NumpyBackend().stepper(SPEC, state, StepOptions())
    state.parameters["mlp.0.weight"][:] = np.nan
    stepper.state().parameters["mlp.0.weight"][:] = np.nan
    assert np.isfinite(stepper.step(make_batch(SPEC), RATES))


def test_frozen_parameters_stay_and_others_move(make_batch):
    start = new_state(SPEC, Seed(1))
    options = StepOptions(frozen=frozenset({"position"}))
    stepper = NumpyBackend().stepper(SPEC, start, options)
    for _ in range(3):
        stepper.step(make_batch(SPEC), RATES)
    end = stepper.state()
    for group in ("parameters", "average", "first", "second"):
        np.testing.assert_array_equal(getattr(end, group)["position"], getattr(start, group)["position"])
    assert (end.parameters["mlp.0.weight"] != start.parameters["mlp.0.weight"]).any()


def test_encodings_and_network_learn_at_their_own_rates(make_batch):
    start = new_state(SPEC, Seed(1))
    stepper = NumpyBackend().stepper(SPEC, start, StepOptions())
    stepper.step(make_batch(SPEC), Rates(encoding=0.5, network=0.0))
    end = stepper.state().parameters
    np.testing.assert_array_equal(end["mlp.0.weight"], start.parameters["mlp.0.weight"])
    moved = np.abs(end["position"] - start.parameters["position"])
    assert moved.max() == pytest.approx(0.5, rel=1e-3)
    assert moved.min() == 0.0  # entries that no sample met


@pytest.mark.parametrize("kind", ["encoding", "network"])
def test_encodings_and_network_have_their_own_adam(kind, make_batch):
    still = replace(StepOptions(), **{f"{kind}_adam": AdamOptions(epsilon=1e30)})
    start = new_state(SPEC, Seed(1))
    stepper = NumpyBackend().stepper(SPEC, start, still)
    stepper.step(make_batch(SPEC), RATES)
    end = stepper.state().parameters
    for name, is_network in (("position", False), ("mlp.1.weight", True)):
        moved = (end[name] != start.parameters[name]).any()
        assert moved == (is_network != (kind == "network"))


def test_evaluating_in_chunks_changes_nothing(make_batch, monkeypatch):
    batch = make_batch(SPEC, 50)
    evaluator = NumpyBackend().evaluator(SPEC, new_parameters(SPEC, Seed(1)))
    whole = evaluator(batch.x, batch.normal)
    monkeypatch.setattr(numpy_backend, "CHUNK", 7)
    np.testing.assert_allclose(evaluator(batch.x, batch.normal), whole, rtol=1e-5)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda p: p.pop("mlp.1.bias"), "'mlp.1.bias' of shape .8,. are missing"),
        (lambda p: p.update({"mlp.9.bias": p["mlp.0.bias"]}), "unknown parameters mlp.9.bias"),
        (lambda p: p.update({"position": p["position"][:-1]}), "position: expected shape"),
        (lambda p: p["mlp.0.weight"].__setitem__(0, np.nan), "mlp.0.weight: some parameters are infinite"),
    ],
)
def test_parameters_that_are_not_the_specs_are_refused(change, message):
    parameters = new_parameters(SPEC, Seed(1))
    change(parameters)
    with pytest.raises(InputError, match=message):
        NumpyBackend().evaluator(SPEC, parameters)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (StepOptions(frozen=frozenset({"positoin"})), "(?s)no parameters 'positoin'.*'position'"),
        (StepOptions(average=1.0), r"decay of the mean in \[0, 1\)"),
    ],
)
def test_options_that_cannot_be_are_refused(options, message):
    with pytest.raises(InputError, match=message):
        NumpyBackend().stepper(SPEC, new_state(SPEC, Seed(1)), options)


def test_a_loss_that_the_head_cannot_have_is_refused():
    spec = FieldSpec(SPEC.position, Identity(), head="linear")
    with pytest.raises(InputError, match="log loss"):
        NumpyBackend().stepper(spec, new_state(spec, Seed(1)), StepOptions(loss="log"))
