"""Metrics against values worked out by hand, and the invariances that they promise."""

from __future__ import annotations

import math

import numpy as np
import pytest

from irradia.core.errors import InputError
from irradia.metrics import (
    compare,
    flip,
    flip_exposures,
    mae,
    mean_ratio,
    psnr,
    relative_error_p95,
    relmse,
    relmse_between_means,
    relmse_without_reference_noise,
    smape,
)


@pytest.fixture
def reference() -> np.ndarray:
    return np.exp(np.random.default_rng(16).normal(0, 1, (48, 64, 3))).astype(np.float32)


def test_values_worked_out_by_hand() -> None:
    reference, test = np.array([[1.0, 1.0, 1.0]]), np.array([[1.0, 1.5, 0.5]])
    assert relmse(test, reference) == pytest.approx(2 * 0.25 / 1.01 / 3)
    assert smape(test, reference) == pytest.approx((0.5 / 2.51 + 0.5 / 1.51) / 3)
    assert mae(test, reference) == pytest.approx(1 / 3)
    assert mean_ratio(test * 1.02, reference) == pytest.approx(1.02)
    assert relative_error_p95(np.full(100, 1.1), np.ones(100)) == pytest.approx(0.1 / 1.01)


def test_psnr_of_a_known_display_error() -> None:
    reference = np.full((4, 4, 3), 5.0, np.float32)  # shown as middle grey
    test = reference * 1.0
    test[0, 0] = 0.0
    shown = 1.055 * 0.18 ** (1 / 2.4) - 0.055
    assert psnr(test, reference) == pytest.approx(-10 * math.log10(shown**2 / 16), abs=1e-4)


@pytest.mark.parametrize("metric", [relmse, smape, relative_error_p95, psnr, mean_ratio])
def test_units_of_light_change_no_relative_metric(metric, reference: np.ndarray) -> None:
    test = reference * np.random.default_rng(17).normal(1, 0.1, reference.shape)
    expected = metric(test, reference)
    assert metric(test * 683.0, reference * 683.0) == pytest.approx(expected, rel=1e-5)


def test_equal_images_have_no_error(reference: np.ndarray) -> None:
    result = compare(reference, reference)
    assert (result.relmse, result.smape, result.mae, result.relative_error_p95, result.flip) == (0,) * 5
    assert result.mean_ratio == 1.0
    assert result.psnr_db == math.inf
    assert result.to_json()["psnr_db"] is None


def test_reference_noise_is_removed() -> None:
    rng = np.random.default_rng(18)
    truth = 1.0 + 0.5 * np.sin(np.arange(600_000.0).reshape(-1, 3))
    noisy_a, noisy_b = (truth * rng.normal(1, 0.04, truth.shape) for _ in range(2))
    test = truth * 1.04
    expected = relmse(test, truth)
    assert relmse(test, noisy_a) > 1.8 * expected  # what the plain metric says
    assert relmse_without_reference_noise(test, noisy_a, noisy_b) == pytest.approx(expected, rel=0.1)


def test_noise_of_both_sides_is_removed() -> None:
    rng = np.random.default_rng(19)
    four = [rng.normal(mean, 0.03, (400_000, 3)) for mean in (1.03, 1.03, 1.0, 1.0)]
    bias = relmse_between_means((four[0], four[1]), (four[2], four[3]))
    assert bias == pytest.approx(0.03**2, rel=0.1)
    dependent = relmse_between_means((four[0], four[0]), (four[2], four[2]))
    assert dependent > 2.5 * 0.03**2


def test_flip_sees_an_error_where_it_is(reference: np.ndarray) -> None:
    test = reference.copy()
    test[20:28, 30:38] *= 4.0
    result = flip(test, reference)
    assert result.error.shape == (48, 64)
    assert result.error[20:28, 30:38].mean() > 0.1
    assert result.error[:8, :8].max() == 0.0


def test_flip_sees_errors_in_images_of_hardly_any_contrast() -> None:
    """One exposure would do for them, but flip-evaluator finds no error at one."""
    flat = np.full((16, 16, 3), 0.5, np.float32)
    assert flip(flat * 1.5, flat).mean > 0.05
    assert flip(flat, np.zeros_like(flat)).mean > 0.05


def test_flip_exposures_ignore_a_firefly(reference: np.ndarray) -> None:
    spiked = reference.copy()
    spiked[0, 0] = 1e5
    assert flip_exposures(spiked) == flip_exposures(reference)
    assert flip_exposures(reference * 4.0).start_ev == flip_exposures(reference).start_ev - 2
    assert flip_exposures(reference).count >= 2


def test_flip_is_the_same_every_time(reference: np.ndarray) -> None:
    test = reference * 1.1
    first = flip(test, reference).error
    for _ in range(3):
        np.testing.assert_array_equal(flip(test, reference).error, first)


def test_masked_pixels_do_not_count(reference: np.ndarray) -> None:
    mask = np.zeros(reference.shape[:2], bool)
    mask[:, :32] = True
    test = reference.copy()
    test[:, 32:] = np.nan
    result = compare(test, reference, mask)
    assert (result.n_pixels, result.relmse, result.flip) == (48 * 32, 0.0, 0.0)
    assert result.reference_mean == pytest.approx(float(reference[:, :32].mean()), rel=1e-5)


def test_flip_that_bleeds_out_of_the_mask_does_not_count(reference: np.ndarray) -> None:
    mask = np.zeros(reference.shape[:2], bool)
    mask[:, :32] = True
    test, black = reference * 1.5, np.where(mask[..., None], reference, 0.0)
    result = compare(test, reference, mask)
    exposures = flip_exposures(reference[mask])
    error = flip(np.where(mask[..., None], test, 0.0), black, exposures).error
    assert error[~mask].max() > 0.0
    assert result.flip == pytest.approx(float(error[mask].mean()), rel=1e-5)


def test_pages_compare_as_one_image_does(reference: np.ndarray) -> None:
    test = reference * 1.2
    pages = compare(np.stack([test, test]), np.stack([reference, reference]))
    single = compare(test, reference)
    assert pages.n_pixels == 2 * single.n_pixels
    assert pages.relmse == pytest.approx(single.relmse)
    assert pages.flip == pytest.approx(single.flip)


def test_black_references_give_finite_numbers() -> None:
    black = np.zeros((16, 16, 3), np.float32)
    assert compare(black, black).mean_ratio == 1.0
    assert compare(black + 1.0, black).to_json()["mean_ratio"] is None


@pytest.mark.parametrize(
    ("test_shape", "mask", "message"),
    [
        ((8, 8, 3), None, "one size"),
        ((8, 9, 4), None, "one size"),
        ((8, 9, 3), np.zeros((8, 9), bool), "no pixel"),
        ((8, 9, 3), np.ones((9, 8), bool), "mask of"),
    ],
)
def test_images_that_do_not_fit_are_input_errors(test_shape, mask, message: str) -> None:
    with pytest.raises(InputError, match=message):
        compare(np.ones(test_shape), np.ones((8, 9, 3)), mask)


def test_nan_is_an_input_error() -> None:
    bad = np.ones((8, 8, 3))
    bad[2, 3, 1] = np.nan
    with pytest.raises(InputError, match="second image has 1 pixels"):
        compare(np.ones((8, 8, 3)), bad)
