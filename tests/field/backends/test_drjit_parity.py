"""Dr.Jit's values and gradients against the definition in double precision, over all that is registered."""

from __future__ import annotations

from typing import get_args

import numpy as np
import pytest

from irradia.field.activations import ACTIVATIONS
from irradia.field.backend import LossName
from irradia.field.backends.drjit_backend import DrJitBackend
from irradia.field.backends.drjit_catalogue import ACCELERATED
from irradia.field.encodings import Composite, HashGrid, Identity, SphericalHarmonics, TriPlane
from irradia.field.heads import HEADS
from irradia.field.network import evaluate
from irradia.field.registry import ENCODINGS
from irradia.field.spec import FieldSpec

from .parity import check_gradients, check_values, exact, parameters_of

N = 600  # one tile and a part of another
GRID = HashGrid(3, 6, 2, 3, 11)
TOLERANCE = {"cpu": 4e-6, "cuda": 2e-5}  # CUDA's exp and sine are good to 22 bits


@pytest.fixture(params=["cpu", pytest.param("cuda", marks=pytest.mark.cuda)])
def device(request) -> str:
    return request.param


@pytest.fixture
def drjit(device) -> DrJitBackend:
    return DrJitBackend(device=device)


@pytest.fixture
def check(drjit, device, make_batch):
    """Values and gradients of a spec: ``check(spec)``."""

    def checked(spec: FieldSpec, batch=None, loss: LossName = "relative_l2") -> None:
        batch = batch or make_batch(spec, N)
        check_values(drjit, spec, batch, TOLERANCE[device])
        check_gradients(drjit, spec, batch, loss, TOLERANCE[device])

    return checked


def test_every_encoding_has_a_fast_version():
    missing = {name: DrJitBackend().lacks(FieldSpec(ENCODINGS[name](), Identity())) for name in ENCODINGS}
    assert not any(missing.values()), missing


def test_an_encoding_without_a_fast_version_is_named_also_within_others(monkeypatch):
    monkeypatch.delitem(ACCELERATED, "frequency")
    position = Composite((Identity(), Composite((ENCODINGS["frequency"](),))))
    assert DrJitBackend().lacks(FieldSpec(position, Identity())) == "the encoding frequency"
    assert DrJitBackend().lacks(FieldSpec(Identity(), position)) == "the encoding frequency"
    assert DrJitBackend().lacks(FieldSpec(Identity(), Identity())) is None


def test_a_table_beyond_its_indices_is_refused():
    grid = HashGrid(16, 28, 16, 16, 1 << 20)
    lack = DrJitBackend().lacks(FieldSpec(grid, Identity()))
    assert lack is not None
    assert str(grid.n_parameters) in lack


def test_every_encoding_of_positions(small_encoding, check):
    check(FieldSpec(small_encoding, Identity(), width=12))


def test_every_encoding_of_directions(small_encoding, check):
    check(FieldSpec(GRID, small_encoding, width=12))


@pytest.mark.parametrize("activation", list(ACTIVATIONS))
def test_every_activation(activation, check):
    check(FieldSpec(GRID, SphericalHarmonics(2), width=24, n_hidden_layers=3, activation=activation))


@pytest.mark.parametrize("head", list(HEADS))
@pytest.mark.parametrize("loss", get_args(LossName))
def test_every_loss_with_every_head(head, loss, check):
    if (head, loss) == ("linear", "log"):
        return  # refused; see test_backends.py
    check(FieldSpec(GRID, Identity(), width=8, n_hidden_layers=1, head=head), loss=loss)


@pytest.mark.parametrize("head", list(HEADS))
def test_outputs_far_from_zero(head, drjit, make_batch):
    spec = FieldSpec(GRID, Identity(), width=8, n_hidden_layers=1, head=head)
    parameters = parameters_of(spec)
    parameters["mlp.1.weight"][:] *= 20.0
    parameters["mlp.1.bias"][:] = (-17.0, 0.0, 17.0)
    batch = make_batch(spec, N)
    expected = evaluate(spec, exact(parameters), batch.x, batch.normal)
    found = drjit.evaluator(spec, parameters)(batch.x, batch.normal)
    np.testing.assert_allclose(found, expected, rtol=1e-4, atol=1e-12)


@pytest.mark.parametrize(("width", "n_hidden_layers"), [(1, 1), (5, 2), (8, 6), (128, 2)])
def test_every_shape_of_network(width, n_hidden_layers, check):
    check(FieldSpec(GRID, Identity(), width, n_hidden_layers, activation="leaky_relu"))


@pytest.mark.parametrize("mode", ["sh1", "sh2"])
def test_spherical_harmonics_as_outputs(mode, check):
    check(FieldSpec(GRID, width=16, head="linear", mode=mode), loss="relative_l2_luminance")


@pytest.mark.parametrize("n", [1, 511, 512, 513])
def test_every_size_of_batch(n, check, make_batch):
    spec = FieldSpec(GRID, Identity(), width=8)
    check(spec, make_batch(spec, n))


@pytest.mark.parametrize(
    "grid",
    [
        HashGrid(16, 12, 2, 16, 2048),
        HashGrid(4, 8, 1, 4, 64),
        HashGrid(4, 8, 4, 4, 64),
        HashGrid(4, 8, 3, 4, 64, full_levels=True),
        HashGrid(4, 8, 16, 4, 64, hash_all=True),
        HashGrid(3, 12, 2, 3, 7, hash_all=True),
        HashGrid(4, 8, 2, 4, 64, convention="floor"),
        HashGrid(4, 8, 2, 4, 64, primes=(73856093, 19349663, 83492791)),
    ],
    ids=str,
)
def test_every_convention_of_hash_grids(grid, check, make_batch):
    spec = FieldSpec(grid, Identity(), width=8)
    check(spec, at_the_edges(make_batch(spec, N)))


@pytest.mark.parametrize("planes", [TriPlane(5, 3), TriPlane(2, 16, align_corners=True)], ids=str)
def test_every_convention_of_tri_planes(planes, check, make_batch):
    spec = FieldSpec(planes, Identity(), width=8)
    check(spec, at_the_edges(make_batch(spec, N)))


def at_the_edges(batch):
    """Some points at the box's corners and one outside."""
    batch.x[:8] = np.array([[i >> 2 & 1, i >> 1 & 1, i & 1] for i in range(8)])
    batch.x[8] = (-0.5, 1.5, 0.5)  # clamped
    return batch


def test_composed_encodings_learn_each_their_own_part(check):
    position = Composite((TriPlane(3, 3), GRID, Identity(), HashGrid(2, 5, 4, 2, 9)))  # 81 values, then pairs
    check(FieldSpec(position, Composite((Identity(), SphericalHarmonics(2))), width=16))


@pytest.mark.parametrize("position", [GRID, TriPlane(5, 2)], ids=str)
def test_a_point_that_is_no_number_has_no_light_and_takes_none(position, drjit, make_batch):
    spec = FieldSpec(position, Identity(), width=8)
    batch, evaluator = make_batch(spec, N), drjit.evaluator(spec, parameters_of(spec))
    expected = evaluator(batch.x, batch.normal)
    batch.x[3, 1] = np.nan
    found = evaluator(batch.x, batch.normal)
    assert np.isnan(found[3]).all()
    np.testing.assert_array_equal(np.delete(found, 3, 0), np.delete(expected, 3, 0))
