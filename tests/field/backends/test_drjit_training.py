"""Dr.Jit's steps against the reference's, and what a training may rely on."""

from __future__ import annotations

import re
import subprocess
import sys
from collections import Counter

import numpy as np
import pytest

from irradia.core.rng import Seed
from irradia.field.backend import AdamOptions, Batch, Rates, StepOptions, Stepper, TrainState
from irradia.field.backends.drjit_backend import DrJitBackend
from irradia.field.backends.drjit_device import array_types
from irradia.field.backends.numpy_backend import NumpyBackend
from irradia.field.encodings import Composite, Frequency, HashGrid, SphericalHarmonics, TriPlane
from irradia.field.init import new_parameters, new_state
from irradia.field.spec import FieldSpec

from .parity import GROUPS, check_same_bits

POSITION = Composite((HashGrid(4, 11, 2, 4, 64), TriPlane(5, 2), Frequency(2)))
SPEC = FieldSpec(POSITION, SphericalHarmonics(2), width=12)
RATES = Rates(encoding=0.01, network=0.001)
SIZES = (600, 40, 601, 1024, 1025, 40)  # so that some entries learn and then are met no more


@pytest.fixture(params=["cpu", pytest.param("cuda", marks=pytest.mark.cuda)])
def drjit(request) -> DrJitBackend:
    return DrJitBackend(2, request.param)


def trained(stepper: Stepper, batches: list[Batch]) -> tuple[list[float], TrainState]:
    return [stepper.step(batch, RATES) for batch in batches], stepper.state()


@pytest.mark.parametrize(
    "options",
    [
        StepOptions(),
        StepOptions(encoding_adam=AdamOptions(skip_zero=False), average=0.0),
        StepOptions(network_adam=AdamOptions(0.8, 0.95, 1e-3, skip_zero=True)),
        StepOptions(
            frozen=frozenset({"position", "mlp.0.weight", "mlp.1.bias", "mlp.2.weight", "mlp.2.bias"})
        ),
    ],
    ids=["defaults", "no skipping and no mean", "other decays", "frozen parts"],
)
def test_steps_follow_the_reference(options, drjit, make_batch):
    batches, start = [make_batch(SPEC, n) for n in SIZES], new_state(SPEC, Seed(1), options)
    losses, ours = trained(drjit.stepper(SPEC, start, options), batches)
    expected, theirs = trained(NumpyBackend().stepper(SPEC, start, options), batches)
    assert losses == pytest.approx(expected, rel=1e-5)
    assert ours.step == theirs.step == len(SIZES)
    for group in GROUPS:
        mine, reference = getattr(ours, group), getattr(theirs, group)
        assert mine.keys() == reference.keys()
        for name in mine:
            size = np.abs(reference[name]).max()
            # Adam divides by the gradient's own size, so a tiny gradient's roundings show in full.
            np.testing.assert_allclose(mine[name], reference[name], rtol=1e-3, atol=2e-3 * size)
            assert np.mean(np.abs(mine[name] - reference[name])) <= 2e-5 * size


def test_any_number_of_threads_gives_the_same_bits(make_batch):
    batches = [make_batch(SPEC, 5000) for _ in range(2)]
    # Few entries, so that many samples meet in each.
    runs = [
        trained(DrJitBackend(n, "cpu").stepper(SPEC, new_state(SPEC, Seed(1)), StepOptions()), batches)
        for n in (1, 2, 2)
    ]
    for losses, state in runs[1:]:
        assert losses == runs[0][0]
        check_same_bits(state, runs[0][1])


def test_a_training_goes_on_from_its_state_as_if_it_had_not_stopped(drjit, make_batch):
    batches = [make_batch(SPEC, 300) for _ in range(4)]
    _, whole = trained(drjit.stepper(SPEC, new_state(SPEC, Seed(1)), StepOptions()), batches)
    _, half = trained(drjit.stepper(SPEC, new_state(SPEC, Seed(1)), StepOptions()), batches[:2])
    _, rest = trained(drjit.stepper(SPEC, half, StepOptions()), batches[2:])
    check_same_bits(whole, rest)


def test_a_state_or_batch_given_in_or_out_is_a_copy(drjit, make_batch):
    batches = [make_batch(SPEC, 5000) for _ in range(2)]
    _, expected = trained(drjit.stepper(SPEC, new_state(SPEC, Seed(1)), StepOptions()), batches)
    start = new_state(SPEC, Seed(1))
    stepper = drjit.stepper(SPEC, start, StepOptions())
    spoil(start)
    for batch in batches:
        stepper.step(batch, RATES)
        for values in (batch.x, batch.normal, batch.target):
            values[:] = np.nan
        spoil(stepper.state())
    check_same_bits(stepper.state(), expected)


def spoil(state: TrainState) -> None:
    for group in GROUPS:
        for values in getattr(state, group).values():
            values[:] = np.nan


def test_an_evaluator_keeps_its_own_parameters_and_cuts_long_queries(drjit, make_batch, monkeypatch):
    parameters, batch = new_parameters(SPEC, Seed(1)), make_batch(SPEC, 700)
    whole = drjit.evaluator(SPEC, parameters)(batch.x, batch.normal)
    monkeypatch.setattr("irradia.field.backends.drjit_field.CHUNK", 128)
    evaluator = drjit.evaluator(SPEC, parameters)
    for values in parameters.values():
        values[:] = np.nan
    np.testing.assert_array_equal(evaluator(batch.x, batch.normal), whole)
    none = np.zeros((0, 3), np.float32)
    assert evaluator(none, none).shape == (0, 3)


def test_steps_launch_few_kernels_and_compile_none(drjit, make_batch):
    stepper = drjit.stepper(SPEC, new_state(SPEC, Seed(1)), StepOptions())
    sizes = (600, 601, 1024, 1025, 1500, 600)
    launches = [launched(lambda n=n: stepper.step(make_batch(SPEC, n), RATES)) for n in sizes]
    kernels = [each for each in launches[0] if each["type"].name == "JIT"]
    # Four encodings, the bias's ones, two activations and their slopes, the loss; the largest gradient, two
    # tables back, Adam for the array that they are in and for three matrices.
    assert len(kernels) == 4 + 1 + 2 * 2 + 1 + 1 + 2 + 1 + 3
    for later in launches[1:]:
        assert all(each["cache_hit"] for each in later if each["type"].name == "JIT")
        assert Counter(each["type"].name for each in later)["JIT"] == len(kernels)


def test_evaluations_of_any_size_share_their_kernels(drjit, make_batch):
    evaluator, batch = drjit.evaluator(SPEC, new_parameters(SPEC, Seed(1))), make_batch(SPEC, 5000)
    evaluator(batch.x, batch.normal)
    later = launched(lambda: [evaluator(batch.x[:n], batch.normal[:n]) for n in (2, 2500, 4000)])
    assert all(each["cache_hit"] for each in later if each["type"].name == "JIT")


def launched(work) -> list:
    import drjit as dr

    with dr.scoped_set_flag(dr.JitFlag.KernelHistory):
        work()
        return dr.kernel_history()


@pytest.mark.parametrize("scale", [1e-24, 1.0, 1e30])
def test_sums_in_fixed_point_are_as_good_as_doubles(scale, rng):
    jit = array_types("cpu")
    from irradia.field.backends.drjit_fixed_point import add, room_for, scale_of, total

    n = 5000
    values = (scale * rng.standard_normal(n)).astype(np.float32)
    index = rng.integers(0, 7, n).astype(np.uint32)
    sums = jit.UInt64(np.zeros(8, np.uint64))
    before, after = scale_of(jit, jit.Float(values), jit.UInt(room_for(n)))
    add(jit, sums, jit.Float(values) * before, jit.UInt(index))
    expected = np.bincount(index, values.astype(np.float64), minlength=8)
    np.testing.assert_allclose(total(jit, sums, after).numpy(), expected, rtol=1e-7)


def test_gradients_that_are_no_numbers_are_seen(drjit, make_batch):
    batch = make_batch(SPEC, 600)
    batch.target[5] = np.inf
    stepper = drjit.stepper(SPEC, new_state(SPEC, Seed(1)), StepOptions())
    assert not np.isfinite(stepper.step(batch, RATES))
    end = stepper.state().parameters
    assert not np.isfinite(end["position"]).any()
    assert not np.isfinite(end["mlp.0.weight"]).any()


def test_it_runs_beside_mitsuba(cpu_device, make_batch):
    from irradia.transport.backend import dr, mi

    batch = make_batch(SPEC, 600)
    before = mi.variant()
    evaluator = DrJitBackend(device="cpu").evaluator(SPEC, new_parameters(SPEC, Seed(1)))
    expected = NumpyBackend().evaluator(SPEC, new_parameters(SPEC, Seed(1)))(batch.x, batch.normal)
    np.testing.assert_allclose(evaluator(batch.x, batch.normal), expected, rtol=1e-5)
    assert mi.variant() == before
    assert dr.flag(dr.JitFlag.FastMath)  # rendering stays as it was


def test_asking_what_it_can_do_loads_no_compiler():
    asked = (
        "import sys; from irradia.field.backends import matrix_text; print(matrix_text());"
        "assert not {'drjit', 'mitsuba'} & set(sys.modules)"
    )
    shown = subprocess.run([sys.executable, "-c", asked], capture_output=True, text=True, check=True).stdout
    column = shown.splitlines()[0].split().index("drjit")
    assert [line.split()[column] for line in shown.splitlines()[1:] if line][:3] == ["yes"] * 3


def test_of_all_that_computes_fields_only_its_own_modules_import_dr_jit(repo_root):
    modules = (repo_root / "src" / "irradia" / "field").rglob("*.py")
    importing = [
        path.name
        for path in modules
        if re.search(r"^\s*(import|from) drjit\b", path.read_text("utf-8"), re.M)
    ]
    assert len(importing) > 5
    assert all(name.startswith("drjit_") for name in importing)


def test_a_gpu_that_is_not_there_is_no_device(monkeypatch):
    from irradia.core.device import CudaStatus
    from irradia.core.errors import MissingDependencyError

    for module in ("irradia.field.backends.drjit_device", "irradia.core.device"):
        monkeypatch.setattr(f"{module}.cuda_status", lambda: CudaStatus(None, False, "no driver"))
    with pytest.raises(MissingDependencyError, match="no driver"):
        DrJitBackend(device="cuda").evaluator(SPEC, new_parameters(SPEC, Seed(1)))
