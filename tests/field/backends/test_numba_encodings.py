"""Fast versions of encodings against their definitions: features, gradients, and bits on any threads."""

from __future__ import annotations

import numpy as np
import pytest

from irradia.field.backend import AdamOptions
from irradia.field.backends.numba_adam import Learned, adam_of_step
from irradia.field.backends.numba_encoding import STRIDE, TILE, accelerate, lacks_acceleration
from irradia.field.backends.numba_team import Team
from irradia.field.encoding import Encoding
from irradia.field.encodings import (
    Composite,
    Frequency,
    HashGrid,
    Identity,
    OneBlob,
    SphericalHarmonics,
    TriPlane,
)
from irradia.field.registry import ENCODINGS

N_POINTS = 2 * TILE + 77
ROW = 2  # rows above that belong to someone else
UNTOUCHED = np.float32(7.25)

# What every path of a kernel is taken by; of encodings that aren't named, their defaults.
VARIANTS: dict[str, list[Encoding]] = {
    "hash": [HashGrid(4, 10, 2, 4, 40), HashGrid(3, 8, 3, 4, 40)],
    "triplane": [
        TriPlane(16, 16),
        TriPlane(9, 8, align_corners=True),
        TriPlane(7, 3),
        TriPlane(5, 11),
        TriPlane(2, 1),
    ],
    "frequency": [Frequency(10), Frequency(24, include_identity=True)],
    "one_blob": [OneBlob(1), OneBlob(16), OneBlob(128)],
    "sh": [SphericalHarmonics(degree) for degree in (1, 2, 3, 4, 5)],
    "composite": [
        Composite((TriPlane(6, 2), OneBlob(4), HashGrid(2, 6, 2, 4, 8), Identity(), Frequency(2))),
        Composite((Identity(), Composite((SphericalHarmonics(2), TriPlane(4, 8))))),
    ],
}
ALL = [variant for name in ENCODINGS for variant in VARIANTS.get(name, [ENCODINGS[name]()])]


@pytest.fixture(params=ALL, ids=lambda encoding: str(encoding)[:60])
def encoding(request: pytest.FixtureRequest) -> Encoding:
    return request.param


@pytest.fixture
def x(rng) -> np.ndarray:
    """Points with the box's corners and the borders of cells among them."""
    points = rng.random((N_POINTS, 3), np.float32)
    points[:8] = np.stack(np.meshgrid(*[(0.0, 1.0)] * 3), axis=-1).reshape(-1, 3)
    points[8:40] = rng.integers(0, 17, (32, 3)) / np.float32(16.0)
    return points


def tiled(points: np.ndarray) -> np.ndarray:
    """(3, n_tiles · 256), filled up with the last point."""
    n_tiles = -(-len(points) // TILE)
    filled = np.concatenate([points, np.repeat(points[-1:], n_tiles * TILE - len(points), axis=0)])
    return np.ascontiguousarray(filled.T)


def tiles_of(features: np.ndarray) -> np.ndarray:
    """(N, F) as (n_tiles, ROW + F, 272), with 0 where there is no sample."""
    n, width = features.shape
    n_tiles = -(-n // TILE)
    filled = np.zeros((n_tiles * TILE, width), np.float32)
    filled[:n] = features
    tiles = np.full((n_tiles, ROW + width, STRIDE), UNTOUCHED)
    tiles[:, ROW:, :TILE] = filled.reshape(n_tiles, TILE, width).transpose(0, 2, 1)
    return tiles


def fast_features(
    encoding: Encoding, points: np.ndarray, parameters: np.ndarray, n_threads: int
) -> np.ndarray:
    tiles = tiles_of(np.zeros((len(points), encoding.n_outputs), np.float32))
    accelerate(encoding, Team(n_threads)).forward(tiled(points), parameters, tiles, ROW)
    return tiles


def learned_from(parameters: np.ndarray) -> Learned:
    zeros = np.zeros_like(parameters)
    return Learned(parameters.copy(), zeros, zeros.copy(), np.zeros(0, np.float32))


ADAM = adam_of_step(AdamOptions(beta1=0.0, skip_zero=True), step=1, rate=0.01, mean_decay=0.0)


def fast_gradient(encoding: Encoding, points: np.ndarray, gradient: np.ndarray, n_threads: int) -> Learned:
    """Adam after a step with β1 = 0, whose first moments are the gradient itself."""
    learned = learned_from(np.zeros(encoding.n_parameters, np.float32))
    accelerate(encoding, Team(n_threads)).learn(tiled(points), tiles_of(gradient), ROW, learned, ADAM)
    return learned


def parameters_of(encoding: Encoding, rng: np.random.Generator) -> np.ndarray:
    return rng.normal(size=encoding.n_parameters).astype(np.float32)


def test_every_encoding_has_a_fast_version(encoding):
    assert lacks_acceleration(encoding) is None


def test_features_agree_with_the_definition(encoding, x, rng):
    parameters = parameters_of(encoding, rng)
    expected = encoding.forward(x, parameters.astype(np.float64))
    tiles = fast_features(encoding, x, parameters, 2)
    found = tiles[:, ROW:, :TILE].transpose(0, 2, 1).reshape(-1, encoding.n_outputs)[:N_POINTS]
    np.testing.assert_allclose(found, expected, rtol=0, atol=2e-6)


def test_rows_and_columns_of_others_stay_as_they_are(encoding, x, rng):
    tiles = fast_features(encoding, x, parameters_of(encoding, rng), 1)
    assert (tiles[:, :ROW] == UNTOUCHED).all()
    assert (tiles[:, :, TILE:] == UNTOUCHED).all()


def test_gradients_agree_with_the_definition(encoding, x, rng):
    gradient = rng.normal(size=(N_POINTS, encoding.n_outputs)).astype(np.float32)
    expected = encoding.backward(x, np.zeros(encoding.n_parameters), gradient.astype(np.float64))
    found = fast_gradient(encoding, x, gradient, 2).first
    np.testing.assert_allclose(
        found, expected, rtol=0, atol=3e-6 * max(np.abs(expected).max(initial=0.0), 1.0)
    )


def test_a_second_step_starts_from_no_gradient(encoding, x, rng):
    gradient = rng.normal(size=(N_POINTS, encoding.n_outputs)).astype(np.float32)
    fast, learned = accelerate(encoding, Team(2)), learned_from(np.zeros(encoding.n_parameters, np.float32))
    fast.learn(tiled(x), tiles_of(gradient), ROW, learned, ADAM)
    once = learned.first.copy()
    fast.learn(tiled(x), tiles_of(gradient), ROW, learned, ADAM)
    np.testing.assert_array_equal(learned.first, once)


@pytest.mark.parametrize("n_threads", [2, 3])
def test_one_thread_and_many_give_the_same_bits(encoding, n_threads, x, rng):
    parameters = parameters_of(encoding, rng)
    gradient = rng.normal(size=(N_POINTS, encoding.n_outputs)).astype(np.float32)
    one, many = (fast_features(encoding, x, parameters, n) for n in (1, n_threads))
    assert one.tobytes() == many.tobytes()
    one, many = (fast_gradient(encoding, x, gradient, n) for n in (1, n_threads))
    assert all(a.tobytes() == b.tobytes() for a, b in zip(one, many, strict=True))


def test_points_that_are_not_numbers_touch_no_memory_but_their_own(encoding, rng):
    x = np.full((TILE, 3), np.nan, np.float32)
    tiles = fast_features(encoding, x, parameters_of(encoding, rng), 1)
    assert (tiles[:, :ROW] == UNTOUCHED).all()
