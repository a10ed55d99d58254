"""Grids of SH probes."""

from __future__ import annotations

import numpy as np
import pytest

from irradia.core.errors import InputError
from irradia.core.sh import irradiance
from irradia.field.baselines import ShGrid, probe_bytes, spacing_for

ORIGIN, SPACING, SHAPE = np.float32([1.0, 2.0, 3.0]), np.float32([0.5, 0.25, 1.0]), (3, 4, 2)


def _coefficients(seed: int = 0) -> np.ndarray:
    """(N, 9, 3), all E above 0."""
    result = np.random.default_rng(seed).uniform(-0.1, 0.1, (24, 9, 3)).astype(np.float32)
    result[:, 0] += 2.0
    return result


def _places() -> np.ndarray:
    z, y, x = np.meshgrid(np.arange(2), np.arange(4), np.arange(3), indexing="ij")
    return ORIGIN + SPACING * np.stack([x.ravel(), y.ravel(), z.ravel()], axis=1).astype(np.float32)


def _normals(n: int) -> np.ndarray:
    normals = np.random.default_rng(1).standard_normal((n, 3))
    return (normals / np.linalg.norm(normals, axis=1, keepdims=True)).astype(np.float32)


@pytest.mark.parametrize("order", [1, 2])
def test_at_its_own_place_a_probe_says_what_it_holds(order):
    coefficients = _coefficients()
    grid = ShGrid.of(ORIGIN, SPACING, SHAPE, coefficients, order)
    kept = np.zeros_like(coefficients)
    kept[:, : (order + 1) ** 2] = coefficients[:, : (order + 1) ** 2]
    normals = _normals(24)
    np.testing.assert_allclose(grid.irradiance(_places(), normals), irradiance(kept, normals), rtol=2e-3)


def test_between_probes_light_that_grows_evenly_is_met_exactly():
    places, normals = _places(), _normals(50)
    coefficients = np.zeros((24, 9, 3), np.float32)
    coefficients[:, 0] = 1.0 + (places - ORIGIN) / 4.0
    between = ORIGIN + np.random.default_rng(3).random((50, 3)) * SPACING * (2, 3, 1)
    grid = ShGrid.of(ORIGIN, SPACING, SHAPE, coefficients, 2)
    expected = np.pi * 0.2820947918 * (1.0 + (between - ORIGIN) / 4.0)
    np.testing.assert_allclose(grid.irradiance(between.astype(np.float32), normals), expected, rtol=2e-3)


def test_outside_its_lattice_a_grid_has_the_light_of_its_border():
    grid = ShGrid.of(ORIGIN, SPACING, SHAPE, _coefficients(), 2)
    normals = _normals(1)
    far = grid.irradiance(np.float32([[99.0, 99.0, 99.0]]), normals)
    np.testing.assert_array_equal(far, grid.irradiance(_places()[-1:], normals))


@pytest.mark.parametrize("brightness", [1e6, 1e-7])
def test_light_beyond_what_halves_hold_is_kept_as_well(brightness):
    normals = _normals(24)
    plain = ShGrid.of(ORIGIN, SPACING, SHAPE, _coefficients(), 2).irradiance(_places(), normals)
    coefficients = np.float32(brightness) * _coefficients()
    found = ShGrid.of(ORIGIN, SPACING, SHAPE, coefficients, 2).irradiance(_places(), normals)
    np.testing.assert_allclose(found, brightness * plain, rtol=2e-3)


def test_light_is_never_negative():
    coefficients = np.zeros((24, 9, 3), np.float32)
    coefficients[:, 1] = 1.0
    grid = ShGrid.of(ORIGIN, SPACING, SHAPE, coefficients, 1)
    assert grid.irradiance(_places(), np.tile(np.float32([0, -1, 0]), (24, 1))).min() == 0.0


@pytest.mark.parametrize(("order", "n_bytes"), [(1, 24), (2, 54)])
def test_bytes_are_those_of_halves(order, n_bytes):
    assert probe_bytes(order) == n_bytes
    assert ShGrid.of(ORIGIN, SPACING, SHAPE, _coefficients(), order).n_bytes == 24 * n_bytes


def test_a_spacing_uses_up_its_probes_and_no_more():
    extent = np.array([10.0, 4.0, 7.0])
    for n in (1, 30, 1000, 5000):
        spacing_m = spacing_for(extent, n)
        n_probes = np.prod(np.maximum(np.round(extent / spacing_m), 1.0))
        assert 0.5 * n <= n_probes <= n


def test_without_room_for_a_probe_there_is_no_grid():
    with pytest.raises(InputError, match="room for one probe"):
        spacing_for(np.ones(3), 0)
