"""A new encoding is one class and one line of registration; then it trains, evaluates and prints."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
import pytest

from irradia.core.rng import Seed
from irradia.field.backend import Rates, StepOptions
from irradia.field.backends import backend
from irradia.field.cost import counted_cost
from irradia.field.encoding import Array, Encoding, TensorSlot
from irradia.field.encodings import Identity
from irradia.field.field import Field
from irradia.field.files import load_field, save_field
from irradia.field.init import new_parameters, new_state
from irradia.field.registry import ENCODINGS, print_spec, read_spec, register
from irradia.field.spec import FieldFrame, FieldSpec
from irradia.field.training.start import inference_parameters


@dataclass(frozen=True)
class Ladder(Encoding):
    """A learned value for each slab along y, for the sake of this test."""

    name: ClassVar[str] = "ladder"

    n_rungs: int = 8

    @property
    def n_outputs(self) -> int:
        return 1

    def tensors(self) -> tuple[TensorSlot, ...]:
        return (TensorSlot("rungs", (self.n_rungs,)),)

    def init(self, rng: np.random.Generator) -> np.ndarray:
        return rng.uniform(-0.1, 0.1, self.n_rungs).astype(np.float32)

    def forward(self, x: Array, parameters: Array) -> Array:
        return parameters[self._rung(x)][:, None]

    def backward(self, x: Array, parameters: Array, gradient: Array) -> Array:
        found = np.zeros_like(parameters)
        np.add.at(found, self._rung(x), gradient[:, 0])
        return found

    def _rung(self, x: Array) -> np.ndarray:
        return np.minimum((x[:, 1] * self.n_rungs).astype(int), self.n_rungs - 1)


@pytest.fixture
def spec(monkeypatch: pytest.MonkeyPatch) -> FieldSpec:
    monkeypatch.setattr("irradia.field.registry.ENCODINGS", dict(ENCODINGS))
    register(Ladder)
    return FieldSpec(Ladder(), Identity(), 8, 1)


def test_a_new_encoding_trains_and_evaluates(spec, make_batch):
    batch = make_batch(spec, 128)
    batch.target[:] = 0.2 + (batch.x[:, 1:2] > 0.5)
    options = StepOptions()
    stepper = backend("auto", spec).stepper(spec, new_state(spec, Seed(1)), options)
    losses = [stepper.step(batch, Rates(0.05, 0.02)) for _ in range(80)]
    assert losses[-1] < 0.1 * losses[0]
    frame = FieldFrame(np.float32([[0, 0, 0], [1, 1, 1]]))
    field = Field(spec, frame, inference_parameters(stepper.state(), options))
    below, above = field.irradiance(np.float32([[0.5, 0.2, 0.5], [0.5, 0.8, 0.5]]), batch.normal[:2])
    assert above.mean() > 3.0 * below.mean()


def test_a_new_encoding_counts_what_a_query_costs_or_nobody_does(spec, monkeypatch):
    assert counted_cost(spec) is None
    monkeypatch.setattr(Ladder, "cost", lambda self: (1, 1))
    cost = counted_cost(spec)
    assert cost is not None
    assert (cost.encoding_flops, cost.encoding_values) == (1, 1)


def test_a_new_encoding_is_printed_and_read(spec):
    assert read_spec(print_spec(spec)) == spec
    assert '"type": "ladder"' in print_spec(spec)


def test_a_new_encoding_is_saved_and_loaded(spec, tmp_path, rng):
    frame = FieldFrame(np.float32([[0, 0, 0], [1, 1, 1]]))
    saved = Field(spec, frame, new_parameters(spec, Seed(1)))
    save_field(tmp_path / "ladder.safetensors", saved, precision="fp32")
    loaded = load_field(tmp_path / "ladder.safetensors")
    positions, normals = rng.random((4, 3), np.float32), np.float32([[0, 1, 0]] * 4)
    assert loaded.spec == spec
    np.testing.assert_array_equal(loaded.irradiance(positions, normals), saved.irradiance(positions, normals))
