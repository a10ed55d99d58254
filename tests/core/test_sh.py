"""Spherical harmonics: order, signs and constants by hand, irradiance by brute force."""

from __future__ import annotations

import numpy as np
import pytest

from irradia.core.sh import CONSTANTS, COSINE_LOBE, fibonacci_sphere, irradiance, sh_basis

GOLDEN = {
    # direction: Y00, Y1-1 (y), Y10 (z), Y11 (x), Y2-2 (xy), Y2-1 (yz), Y20, Y21 (xz), Y22 (x² − y²)
    (1, 0, 0): (0.282095, 0, 0, 0.488603, 0, 0, -0.315392, 0, 0.546274),
    (0, 1, 0): (0.282095, 0.488603, 0, 0, 0, 0, -0.315392, 0, -0.546274),
    (0, 0, 1): (0.282095, 0, 0.488603, 0, 0, 0, 0.630783, 0, 0),
    (0.6, 0.8, 0): (0.282095, 0.390882, 0, 0.293162, 0.524423, 0, -0.315392, 0, -0.152957),
    (0, 0.6, 0.8): (0.282095, 0.293162, 0.390882, 0, 0, 0.524423, 0.290160, 0, -0.196659),
    (-0.8, 0, 0.6): (0.282095, 0, 0.293162, -0.390882, 0, 0, 0.025231, -0.524423, 0.349615),
}


@pytest.mark.parametrize("direction", GOLDEN)
def test_light_from_one_direction_has_these_coefficients(direction):
    np.testing.assert_allclose(sh_basis(direction), GOLDEN[direction], atol=1e-6)


def test_constants_are_positive_and_the_documented_ones():
    np.testing.assert_allclose(CONSTANTS, (0.282095, 0.488603, 1.092548, 0.315392, 0.546274), atol=5e-7)


def test_functions_are_orthonormal():
    basis = sh_basis(fibonacci_sphere(20_000))
    np.testing.assert_allclose(basis.T @ basis * (4 * np.pi / 20_000), np.eye(9), atol=1e-4)


def test_cosine_lobe_is_the_projection_of_a_clamped_cosine():
    directions = fibonacci_sphere(200_000)
    lobe = sh_basis(directions).T @ np.maximum(directions[:, 2], 0.0) * (4 * np.pi / len(directions))
    zonal = sh_basis((0, 0, 1))
    np.testing.assert_allclose(lobe[[0, 2, 6]], COSINE_LOBE * zonal[[0, 2, 6]], atol=1e-4)


def test_constant_radiance_gives_pi_times_it_in_every_direction():
    series = np.zeros((9, 3))
    series[0] = np.array((1.0, 2.0, 3.0)) * np.sqrt(4 * np.pi)
    e = irradiance(series, fibonacci_sphere(100))
    np.testing.assert_allclose(e, np.tile(np.pi * np.array((1.0, 2.0, 3.0)), (100, 1)), rtol=1e-9)


def test_irradiance_agrees_with_cosine_weighted_sampling_at_random_normals():
    rng = np.random.default_rng(3)
    series = rng.normal(size=(9, 3))
    for normal in fibonacci_sphere(7):
        u = rng.random((400_000, 2))
        local = np.stack(
            [
                np.sqrt(u[:, 0]) * np.cos(2 * np.pi * u[:, 1]),
                np.sqrt(u[:, 0]) * np.sin(2 * np.pi * u[:, 1]),
                np.sqrt(1 - u[:, 0]),
            ],
            axis=1,
        )
        tangent = np.cross(normal, (0.3, 0.9, -0.2))
        tangent /= np.linalg.norm(tangent)
        directions = local @ np.stack([tangent, np.cross(normal, tangent), normal])
        sampled = np.pi * (sh_basis(directions) @ series)
        error = sampled.std(axis=0) / np.sqrt(len(u))
        assert np.all(np.abs(sampled.mean(axis=0) - irradiance(series, normal)) < 4.5 * error)


def test_fibonacci_directions_are_unit_and_even():
    directions = fibonacci_sphere(1000)
    np.testing.assert_allclose(np.linalg.norm(directions, axis=1), 1.0)
    nearest = np.sort(directions @ directions.T, axis=1)[:, -2]
    gaps = np.arccos(np.clip(nearest, -1, 1))
    assert gaps.min() > 0.06
    assert gaps.max() < 0.15
