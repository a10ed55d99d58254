"""Tables in few bits: codes by hand, errors within half a step, and a decoder that learns to live with it."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from irradia.core.errors import InputError
from irradia.core.rng import Seed
from irradia.core.sh import fibonacci_sphere
from irradia.field.backend import AdamOptions, Parameters, Rates, StepOptions, Stepper, TrainState
from irradia.field.backends import backend
from irradia.field.backends.numpy_backend import NumpyBackend
from irradia.field.encodings import Frequency, HashGrid, Identity, TriPlane
from irradia.field.field import Field
from irradia.field.init import new_state
from irradia.field.native_fields import decode_field, encode_field
from irradia.field.quantise import FinishOptions, finish, round_tables, train_on
from irradia.field.quantised import pack_nibbles, quantise, unpack_nibbles
from irradia.field.spec import FieldFrame, FieldSpec
from irradia.field.training.batches import MemorySource
from irradia.field.training.rows import HeldOut, Rows, pack
from irradia.formats.samples import SampleFile, SampleInfo

BOX = ((-1.0, 0.0, 0.0), (1.0, 2.0, 4.0))


def test_codes_are_those_computed_by_hand() -> None:
    values = np.array([[7.0, -3.5, 0.0], [1.0, 14.0, -14.0]], np.float32)
    found = quantise(values, 4, 3)
    assert (found.codes.tolist(), found.scales.tolist()) == ([[7, -4, 0], [0, 7, -7]], [1.0, 2.0])
    np.testing.assert_array_equal(found.values(), [[7, -4, 0], [0, 14, -14]])
    eight = quantise(np.array([254.0, -127.0, 1.0], np.float32), 8, 3)
    assert (eight.codes.tolist(), eight.scales.tolist()) == ([127, -64, 0], [2.0])


def test_nibbles_lie_first_in_the_lower_bits() -> None:
    packed = pack_nibbles(np.array([-8, 7, 0, 1, -1], np.int8))
    assert packed.tolist() == [0xF0, 0x98, 0x87]
    assert unpack_nibbles(packed, 5).tolist() == [-8, 7, 0, 1, -1]


@pytest.mark.parametrize("size", [1, 2, 63, 64, 65])
@pytest.mark.parametrize("bits", [4, 8])
@pytest.mark.parametrize("block", [1, 7, 64, 1000])
def test_error_is_at_most_half_a_step_where_nothing_is_clipped(size: int, bits, block: int) -> None:
    values = np.random.default_rng(1).uniform(-1, 1, size).astype(np.float32)
    found = quantise(values, bits, block)
    steps = np.repeat(found.scales.astype(np.float32), min(block, size))[:size]
    largest = (7 if bits == 4 else 127) * steps
    inside = np.abs(values) <= largest
    assert np.abs(found.values() - values)[inside].max() <= 0.5001 * steps.max()
    assert np.all(np.abs(found.values()[~inside]) == largest[~inside])
    assert len(found.scales) == -(-size // block)


def test_rare_large_values_are_clipped_if_that_errs_less() -> None:
    values = np.random.default_rng(1).normal(0, 1, 1 << 12).astype(np.float32)
    values[0] = 8.0
    found = quantise(values, 4, values.size)
    reach_all = np.rint(values / (8 / 7)) * (8 / 7)
    assert np.square(found.values() - values).mean() < 0.5 * np.square(reach_all - values).mean()


@pytest.mark.parametrize("value", [0.0, 1e-12, 1e-7, 60000.0, 1e7])
@pytest.mark.parametrize("bits", [4, 8])
def test_extremes_stay_finite_and_zero_stays_zero(value: float, bits) -> None:
    found = quantise(np.array([value, -value, 0.0], np.float32), bits, 3).values()
    assert np.isfinite(found).all()
    assert found[2] == 0.0
    assert found[0] == -found[1]
    assert found[0] <= 1.02 * value + 1e-7
    assert found[0] >= min(0.5 * value, 1e5) - 1e-7


def world(n: int = 20_000) -> SampleFile:
    """Light of a lamp above a floor, without noise."""
    rng = np.random.default_rng(4)
    positions = rng.uniform(*BOX, (n, 3)).astype(np.float32)
    normals = fibonacci_sphere(n).astype(np.float32)
    rng.shuffle(normals)
    offset = np.float32([0.2, 2.5, 1.0]) - positions
    distance = np.linalg.norm(offset, axis=1, keepdims=True)
    cosine = np.maximum(np.einsum("ni,ni->n", normals, offset)[:, None] / distance, 0.0)
    light = (0.2 + 4.0 * cosine / distance**2) * np.float32([1.0, 0.8, 0.5])
    rows = np.hstack([positions, normals, light, np.zeros((n, 1))]).astype(np.float32)
    return SampleFile(Path("lamp.samples"), SampleInfo("volume", BOX), rows)


WORLD = world()
FRAME = FieldFrame(WORLD.aabb, 1.0)


def trained(encoding, steps: int = 600) -> Field:
    spec = FieldSpec(encoding, Identity(), width=16, n_hidden_layers=2)
    options = StepOptions(encoding_adam=AdamOptions(epsilon=1e-15, skip_zero=True), average=0.0)
    stepper = backend("numba", spec).stepper(spec, new_state(spec, Seed(1), options), options)
    source = MemorySource(Rows(pack(WORLD.rows.copy(), 3, FRAME), has_normals=True))
    for step in range(steps):
        left = 0.05 ** (step / steps)
        stepper.step(source.batch(step, 2048, Seed(2)), Rates(0.01 * left, 0.01 * left))
    return Field(spec, FRAME, stepper.state().parameters, "numba")


def error(field: Field) -> float:
    normals = WORLD.normals
    assert normals is not None
    found = field.irradiance(WORLD.positions, normals)
    return float(np.mean((found - WORLD.values) ** 2 / (found**2 + 0.01)))


@pytest.fixture(scope="module")
def grid_field() -> Field:
    return trained(HashGrid(4, 9, 2, 4, 32))


def test_rounding_leaves_halves_and_codes(grid_field: Field) -> None:
    found = round_tables(grid_field, 8)
    for name, values in found.field.parameters.items():
        if name.startswith("mlp."):
            np.testing.assert_array_equal(values, values.astype(np.float16).astype(np.float32))
    assert list(found.tensors) == [f"position.level.{i}" for i in range(4)]
    assert error(found.field) < 1.05 * error(grid_field) + 1e-6


def test_untouched_entries_become_zero(grid_field: Field) -> None:
    parameters = {name: values.copy() for name, values in grid_field.parameters.items()}
    parameters["position"][-100:] = np.linspace(-1e-4, 1e-4, 100)
    found = round_tables(replace(grid_field, parameters=parameters), 8, 16)
    assert not found.field.parameters["position"][-96:].any()
    assert not found.tensors["position.level.3"].codes.reshape(-1)[-96:].any()


def test_finishing_wins_back_what_rounding_lost(grid_field: Field) -> None:
    options = FinishOptions(rounds=6, round_steps=5, steps=60, batch_size=2048)
    rounded = round_tables(grid_field, 4, options.block)
    found = finish(grid_field, 4, WORLD, options, backend="numba")
    assert error(rounded.field) > 1.05 * error(grid_field)
    assert error(found.field) < error(rounded.field)
    assert all(np.abs(tensor.codes).max() <= 7 for tensor in found.tensors.values())


def test_codes_move_where_rounding_hurts(grid_field: Field) -> None:
    options = FinishOptions(rounds=12, round_steps=5, steps=0, batch_size=2048, lr_network=0.0)
    found = finish(grid_field, 4, WORLD, options, backend="numba")
    assert error(found.field) < 0.99 * error(round_tables(grid_field, 4).field)


def test_tables_are_frozen_while_the_decoder_learns(grid_field: Field) -> None:
    rounded = round_tables(grid_field, 8)
    found = finish(grid_field, 8, WORLD, FinishOptions(rounds=0, steps=3, batch_size=256), backend="numba")
    np.testing.assert_array_equal(found.field.parameters["position"], rounded.field.parameters["position"])
    assert (found.field.parameters["mlp.0.weight"] != rounded.field.parameters["mlp.0.weight"]).any()


class Recording(NumpyBackend):
    """Notes what is asked of it."""

    def __init__(self) -> None:
        self.seen: list[StepOptions] = []

    def stepper(self, spec: FieldSpec, state: TrainState, options: StepOptions) -> Stepper:
        self.seen.append(options)
        return super().stepper(spec, state, options)


def test_decoder_learns_with_the_tables_that_are_shipped(grid_field: Field) -> None:
    computing = Recording()
    options = FinishOptions(rounds=2, round_steps=1, steps=2, batch_size=64)
    finish(grid_field, 8, WORLD, options, backend=computing)
    assert [options.frozen for options in computing.seen] == [frozenset(), frozenset(), {"position"}]


def test_what_bits_cost_is_measured_against_as_many_steps(grid_field: Field) -> None:
    options = FinishOptions(rounds=6, round_steps=5, steps=60, batch_size=2048)
    further = train_on(grid_field, WORLD, options, backend="numba")
    assert error(further) < error(grid_field)
    assert error(further) <= error(finish(grid_field, 4, WORLD, options, backend="numba").field)


def test_each_level_or_plane_has_a_scale_of_its_own(grid_field: Field) -> None:
    levels = round_tables(grid_field, 8).tensors
    assert [tensor.scales.size for tensor in levels.values()] == [1, 1, 1, 1]
    planes = round_tables(trained(TriPlane(8, 4), 1), 8).tensors["position.planes"]
    assert (planes.scales.size, planes.block) == (3, 8 * 8 * 4)


def test_same_seed_finishes_to_the_same_bytes(grid_field: Field) -> None:
    def made(seed: int) -> bytes:
        options = FinishOptions(rounds=2, round_steps=2, steps=4, batch_size=256, seed=seed)
        return encode_field(finish(grid_field, 4, WORLD, options, backend="numba"))

    assert made(0) == made(0)
    assert made(0) != made(1)


@pytest.mark.parametrize("bits", [4, 8])
def test_shipped_file_gives_the_finished_field(grid_field: Field, bits) -> None:
    found = finish(grid_field, bits, WORLD, FinishOptions(rounds=1, steps=2, batch_size=256), backend="numba")
    data = encode_field(found, compress=True)
    assert error(decode_field(data).field) == error(found.field)
    assert len(data) < 1.1 * (grid_field.parameters["position"].size * bits / 8 + 2 * 800 + 1500)


@pytest.mark.parametrize("encoding", [TriPlane(8, 4), Frequency(4)])
def test_other_encodings_are_finished_too(encoding) -> None:
    field = trained(encoding, 30)
    found = finish(field, 8, WORLD, FinishOptions(rounds=2, steps=20, batch_size=1024), backend="numba")
    assert error(found.field) < error(field)
    assert len(found.tensors) == (1 if isinstance(encoding, TriPlane) else 0)


def test_samples_of_another_kind_are_refused(grid_field: Field) -> None:
    info = SampleInfo("sh", BOX, n_coefficients=4)
    probes = SampleFile(Path("p.samples"), info, np.ones((4, info.n_columns), np.float32))
    with pytest.raises(InputError, match="mode irradiance"):
        finish(grid_field, 8, probes)


def test_what_training_did_not_see_finishing_does_not_see(grid_field: Field) -> None:
    rows = WORLD.rows.copy()
    kept_back = HeldOut(0.5, 0.0, FRAME.aabb, 7)
    rows[kept_back.rows_of(np.arange(len(rows))), 6:9] = 1e6
    options = FinishOptions(rounds=1, round_steps=2, steps=4, batch_size=256)

    def made(samples: SampleFile, kept: HeldOut | None) -> bytes:
        return encode_field(finish(grid_field, 8, samples, options, kept_back=kept, backend="numba"))

    wrong = replace(WORLD, rows=rows)
    assert made(wrong, kept_back) == made(WORLD, kept_back)
    assert made(wrong, None) != made(WORLD, None)


def test_nothing_to_learn_from_is_refused(grid_field: Field) -> None:
    with pytest.raises(InputError, match="left to learn"):
        finish(grid_field, 8, WORLD, kept_back=HeldOut(1.0, 0.0, FRAME.aabb, 7))


def test_absurd_options_are_refused() -> None:
    for wrong in ({"rounds": -1}, {"round_steps": 0}, {"steps": -1}, {"batch_size": 0}, {"block": -1}):
        with pytest.raises(InputError):
            FinishOptions(**wrong)


def test_parameters_passed_in_are_left_alone(grid_field: Field) -> None:
    before: Parameters = {name: values.copy() for name, values in grid_field.parameters.items()}
    rows = WORLD.rows.copy()
    finish(grid_field, 4, WORLD, FinishOptions(rounds=1, steps=2, batch_size=256), backend="numba")
    np.testing.assert_array_equal(WORLD.rows, rows)
    for name, values in before.items():
        np.testing.assert_array_equal(grid_field.parameters[name], values)
