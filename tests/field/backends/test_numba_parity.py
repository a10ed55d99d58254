"""Numba's values and gradients against the definition in double precision, over all that is registered."""

from __future__ import annotations

from typing import get_args

import numpy as np
import pytest

from irradia.core.errors import InputError
from irradia.field.activations import ACTIVATIONS
from irradia.field.backend import Batch, LossName
from irradia.field.backends.numba_backend import NumbaBackend
from irradia.field.encodings import Composite, HashGrid, Identity, SphericalHarmonics, TriPlane
from irradia.field.heads import HEADS
from irradia.field.registry import ENCODINGS
from irradia.field.spec import FieldSpec

from . import parity

N = 300  # one tile and a part of another
GRID = HashGrid(3, 6, 2, 3, 11)


def check_gradients(spec: FieldSpec, batch: Batch, loss: LossName = "relative_l2") -> None:
    parity.check_gradients(NumbaBackend(2), spec, batch, loss, loss_tolerance=2e-6)


def check_values(spec: FieldSpec, batch: Batch) -> None:
    parity.check_values(NumbaBackend(2), spec, batch)


def test_every_encoding_has_a_fast_version():
    missing = {name: NumbaBackend(1).lacks(FieldSpec(ENCODINGS[name](), Identity())) for name in ENCODINGS}
    assert not any(missing.values()), missing


def test_outputs_are_the_definitions(small_encoding, make_batch):
    spec = FieldSpec(small_encoding, Identity(), width=12)
    check_values(spec, make_batch(spec, N))


def test_gradients_are_the_definitions(small_encoding, make_batch):
    spec = FieldSpec(small_encoding, Identity(), width=12)
    check_gradients(spec, make_batch(spec, N))


def test_gradients_of_an_encoding_of_directions_are_the_definitions(small_encoding, make_batch):
    spec = FieldSpec(GRID, small_encoding, width=12)
    check_gradients(spec, make_batch(spec, N))


@pytest.mark.parametrize("activation", list(ACTIVATIONS))
def test_every_activation(activation, make_batch):
    spec = FieldSpec(GRID, SphericalHarmonics(2), width=24, n_hidden_layers=3, activation=activation)
    batch = make_batch(spec, N)
    check_values(spec, batch)
    check_gradients(spec, batch)


@pytest.mark.parametrize("head", list(HEADS))
@pytest.mark.parametrize("loss", get_args(LossName))
def test_every_loss_with_every_head(head, loss, make_batch):
    if (head, loss) == ("linear", "log"):
        return  # refused; see test_backends.py
    spec = FieldSpec(GRID, Identity(), width=8, n_hidden_layers=1, head=head)
    check_gradients(spec, make_batch(spec, N), loss)


@pytest.mark.parametrize("n_hidden_layers", [1, 2, 4, 6])
@pytest.mark.parametrize("width", [1, 5, 64, 128])
def test_every_shape_of_network(n_hidden_layers, width, make_batch):
    spec = FieldSpec(GRID, Identity(), width=width, n_hidden_layers=n_hidden_layers, activation="leaky_relu")
    check_gradients(spec, make_batch(spec, N))


@pytest.mark.parametrize("mode", ["sh1", "sh2"])
@pytest.mark.parametrize("loss", ["relative_l2", "relative_l2_luminance"])
def test_spherical_harmonics_as_outputs(mode, loss, make_batch):
    spec = FieldSpec(GRID, width=16, head="linear", mode=mode)
    batch = make_batch(spec, N)
    check_values(spec, batch)
    check_gradients(spec, batch, loss)


@pytest.mark.parametrize("n", [1, 255, 256, 257, 512])
def test_every_size_of_batch(n, make_batch):
    spec = FieldSpec(GRID, Identity(), width=8)
    batch = make_batch(spec, n)
    check_values(spec, batch)
    check_gradients(spec, batch)


@pytest.mark.parametrize(
    "grid",
    [
        HashGrid(16, 12, 2, 16, 2048),
        HashGrid(4, 8, 1, 4, 64),
        HashGrid(4, 8, 4, 4, 64),
        HashGrid(4, 8, 3, 4, 64, full_levels=True),
        HashGrid(4, 8, 2, 4, 64, hash_all=True),
        HashGrid(3, 12, 2, 3, 7, hash_all=True),
        HashGrid(4, 8, 2, 4, 64, convention="floor"),
        HashGrid(4, 8, 2, 4, 64, primes=(73856093, 19349663, 83492791)),
    ],
    ids=str,
)
def test_every_convention_of_hash_grids(grid, make_batch):
    spec = FieldSpec(grid, Identity(), width=8)
    batch = make_batch(spec, N)
    batch.x[:8] = np.array([[i >> 2 & 1, i >> 1 & 1, i & 1] for i in range(8)])  # the box's corners
    batch.x[8] = (-0.5, 1.5, 0.5)  # clamped
    check_values(spec, batch)
    check_gradients(spec, batch)


def test_many_tiles_of_a_large_grid(make_batch):
    spec = FieldSpec(HashGrid(16, 15, 2, 16, 2048), Identity(), width=64)
    check_gradients(spec, make_batch(spec, 20_000))


def test_composed_encodings_learn_each_their_own_part(make_batch):
    position = Composite((TriPlane(6, 3), GRID, Identity(), HashGrid(2, 5, 1, 2, 9)))
    spec = FieldSpec(position, Identity(), width=16)
    check_gradients(spec, make_batch(spec, N))


def test_an_evaluation_of_many_chunks_is_whole(make_batch, monkeypatch):
    from irradia.field.backends import numba_backend

    monkeypatch.setattr(numba_backend, "_CHUNK", 1)
    spec = FieldSpec(GRID, Identity(), width=8)
    check_values(spec, make_batch(spec, 700))


def test_no_points_give_no_outputs():
    spec = FieldSpec(GRID, Identity(), width=8)
    none = np.zeros((0, 3), np.float32)
    assert NumbaBackend(1).evaluator(spec, parity.parameters_of(spec))(none, none).shape == (0, 3)


def test_normals_that_are_missing_are_not_made_of_positions():
    spec = FieldSpec(GRID, Identity(), width=8)
    with pytest.raises(InputError, match="normals"):
        NumbaBackend(1).evaluator(spec, parity.parameters_of(spec))(np.zeros((5, 3), np.float32), None)
