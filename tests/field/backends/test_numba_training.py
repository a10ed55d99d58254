"""Numba's steps against the reference's, and what a training may rely on."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from irradia.core.rng import Seed
from irradia.field.backend import AdamOptions, Rates, StepOptions, Stepper
from irradia.field.backends.numba_backend import NumbaBackend
from irradia.field.backends.numba_perceptron import train
from irradia.field.backends.numpy_backend import NumpyBackend
from irradia.field.encodings import Composite, HashGrid, Identity, SphericalHarmonics
from irradia.field.init import new_state
from irradia.field.spec import FieldSpec

SPEC = FieldSpec(HashGrid(4, 8, 2, 4, 64), SphericalHarmonics(2), width=12)
RATES = Rates(encoding=0.01, network=0.001)
GROUPS = ("parameters", "average", "first", "second")


def trained(stepper: Stepper, batches) -> tuple[list[float], Stepper]:
    return [stepper.step(batch, RATES) for batch in batches], stepper


def check_same(a: Stepper, b: Stepper) -> None:
    for group in GROUPS:
        ours, theirs = getattr(a.state(), group), getattr(b.state(), group)
        assert ours.keys() == theirs.keys()
        for name in ours:
            np.testing.assert_array_equal(ours[name], theirs[name], err_msg=f"{group} of {name}")


@pytest.mark.parametrize(
    "options",
    [
        StepOptions(),
        StepOptions(encoding_adam=AdamOptions(skip_zero=False), average=0.0),
        StepOptions(network_adam=AdamOptions(0.8, 0.95, 1e-3, skip_zero=True)),
    ],
    ids=["defaults", "no skipping and no mean", "other decays"],
)
def test_steps_follow_the_reference(options, make_batch):
    batches, start = [make_batch(SPEC, 300) for _ in range(5)], new_state(SPEC, Seed(1), options)
    losses, ours = trained(NumbaBackend(2).stepper(SPEC, start, options), batches)
    expected, theirs = trained(NumpyBackend().stepper(SPEC, start, options), batches)
    assert losses == pytest.approx(expected, rel=1e-5)
    ours, theirs = ours.state(), theirs.state()
    assert ours.step == theirs.step == 5
    for group in GROUPS:
        mine, reference = getattr(ours, group), getattr(theirs, group)
        assert mine.keys() == reference.keys()
        for name in mine:
            size = np.abs(reference[name]).max()
            # Adam divides by the gradient's own size, so a tiny gradient's roundings show in full.
            np.testing.assert_allclose(mine[name], reference[name], rtol=1e-3, atol=2e-3 * size)
            assert np.mean(np.abs(mine[name] - reference[name])) < 2e-5 * size


def test_one_thread_and_more_give_the_same_bits(make_batch):
    spec = FieldSpec(HashGrid(8, 10, 2, 4, 64), SphericalHarmonics(2), width=32)
    batches = [make_batch(spec, 20_000) for _ in range(3)]
    _, one = trained(NumbaBackend(1).stepper(spec, new_state(spec, Seed(1)), StepOptions()), batches)
    for threads in (2, 3):
        _, many = trained(
            NumbaBackend(threads).stepper(spec, new_state(spec, Seed(1)), StepOptions()), batches
        )
        check_same(one, many)


def test_a_training_goes_on_from_its_state_as_if_it_had_not_stopped(make_batch):
    batches = [make_batch(SPEC, 300) for _ in range(4)]
    backend = NumbaBackend(2)
    _, whole = trained(backend.stepper(SPEC, new_state(SPEC, Seed(1)), StepOptions()), batches)
    _, half = trained(backend.stepper(SPEC, new_state(SPEC, Seed(1)), StepOptions()), batches[:2])
    _, rest = trained(backend.stepper(SPEC, half.state(), StepOptions()), batches[2:])
    check_same(whole, rest)


@pytest.mark.parametrize("frozen", [{"position"}, {"mlp.0.weight", "mlp.1.bias"}])
def test_frozen_parameters_stay_and_others_move(frozen, make_batch):
    start = new_state(SPEC, Seed(1))
    stepper = NumbaBackend(2).stepper(SPEC, start, StepOptions(frozen=frozenset(frozen)))
    _, stepper = trained(stepper, [make_batch(SPEC, 300) for _ in range(3)])
    end = stepper.state()
    for group in GROUPS:
        for name, values in getattr(start, group).items():
            same = np.array_equal(values, getattr(end, group)[name])
            assert same == (name in frozen), f"{group} of {name}"


def test_a_state_given_in_or_out_is_a_copy(make_batch):
    state = new_state(SPEC, Seed(1))
    stepper = NumbaBackend(2).stepper(SPEC, state, StepOptions())
    for values in (state.parameters, stepper.state().parameters):
        for name in values:
            values[name][:] = np.nan
    assert np.isfinite(stepper.step(make_batch(SPEC, 300), RATES))


def test_numbers_that_are_none_show_in_the_loss(make_batch):
    for put in ("target", "parameters"):
        batch, state = make_batch(SPEC, 300), new_state(SPEC, Seed(1))
        stepper = NumbaBackend(2).stepper(SPEC, state, StepOptions())
        if put == "target":
            batch.target[17, 1] = np.nan
            assert np.isnan(stepper.step(batch, RATES))
        else:
            stepper.step(batch, Rates(np.nan, np.nan))
            assert np.isnan(stepper.step(batch, RATES))


def test_batches_of_changing_size_are_as_good(make_batch):
    batches = [make_batch(SPEC, n) for n in (700, 10, 300)]
    losses, _ = trained(NumbaBackend(2).stepper(SPEC, new_state(SPEC, Seed(1)), StepOptions()), batches)
    expected, _ = trained(NumpyBackend().stepper(SPEC, new_state(SPEC, Seed(1)), StepOptions()), batches)
    assert losses == pytest.approx(expected, rel=1e-5)


def test_any_kind_of_array_serves_without_compiling_anew(make_batch):
    batch = make_batch(SPEC, 300)
    readonly = batch.target.copy()
    readonly.flags.writeable = False
    strided = np.repeat(batch.target, 2, axis=0)[::2]
    batches = [replace(batch, target=t) for t in (readonly, strided, batch.target.astype(np.float64))]
    batches.append(replace(batch, x=np.asfortranarray(batch.x), normal=batch.normal.astype(np.float64)))
    expected, _ = trained(NumbaBackend(2).stepper(SPEC, new_state(SPEC, Seed(1)), StepOptions()), [batch])
    for other in batches:
        found, _ = trained(NumbaBackend(2).stepper(SPEC, new_state(SPEC, Seed(1)), StepOptions()), [other])
        assert found == expected
    assert len(train.signatures) == 1


def test_what_has_no_kernel_is_named(monkeypatch):
    from irradia.field.backends import numba_encoding

    monkeypatch.delitem(numba_encoding.ACCELERATED, "identity")
    backend = NumbaBackend(1)
    assert backend.lacks(FieldSpec(SPEC.position, Identity())) == "the encoding identity"
    assert backend.lacks(FieldSpec(Composite((SPEC.position, Identity())), SphericalHarmonics(2)))
    assert backend.lacks(SPEC) is None
