"""How fields are judged."""

from __future__ import annotations

import numpy as np
import pytest

from irradia.field.spec import FieldFrame
from irradia.field.training.figures import AT_MOST, judge
from irradia.metrics import relmse


def judged(samples, answer, scale=4.0):
    """Figures of a field that answers with E or coefficients of positions and normals."""
    rows = np.arange(len(samples))
    found = judge(samples, rows, FieldFrame(samples.aabb, scale))
    low, high = samples.aabb
    return found.figures(lambda x, normal: answer(low + x * (high - low), normal).astype(np.float32) / scale)


@pytest.fixture
def flat(make):
    """Samples of E = 2 everywhere, with noise of a variance."""

    def made(variance, n=20_000):
        samples = make(n)
        noise = np.random.default_rng(1).standard_normal((n, 3)) * np.sqrt(variance)
        samples.rows[:, 6:9] = 2.0 + noise
        samples.rows[:, 9] = variance
        return samples

    return made


def test_an_exact_field_has_no_error(flat):
    figures = judged(flat(0.0), lambda position, normal: np.full((len(position), 3), 2.0))
    assert figures.relmse == 0.0
    assert figures.psnr_db == np.inf
    assert (figures.mae, figures.mean_ratio) == (0.0, 1.0)
    assert figures.noise_relmse is None
    assert not figures.under_noise


def test_an_error_of_ten_per_cent_has_the_figures_of_the_formulas(flat):
    samples = flat(0.0)
    figures = judged(samples, lambda position, normal: np.full((len(position), 3), 2.2))
    assert figures.relmse == pytest.approx(relmse(np.full((9, 3), 2.2), np.full((9, 3), 2.0)), rel=1e-5)
    assert figures.psnr_db == pytest.approx(20.0, abs=1e-3)  # a tenth of the peak
    assert figures.mae == pytest.approx(0.2, rel=1e-5)
    assert figures.mean_ratio == pytest.approx(1.1, rel=1e-5)


def test_the_noise_of_the_samples_is_taken_out(flat):
    noisy, clean = flat(0.04), flat(0.0)

    def wrong(position, normal):
        return 2.0 + 0.4 * np.sin(20.0 * position)

    with_noise, without = judged(noisy, wrong), judged(clean, wrong)
    # Noise in the denominator makes figures a little worse, as metrics.unbiased says.
    assert without.relmse <= with_noise.relmse <= 1.1 * without.relmse
    peak = np.percentile(noisy.values, 99.9)  # which noise raises
    mse = peak**2 / 10.0 ** (with_noise.psnr_db / 10.0)
    assert mse == pytest.approx(0.08, rel=0.03)
    assert with_noise.noise_relmse == pytest.approx(0.04 / 4.04, rel=0.05)
    assert not with_noise.under_noise


def test_the_noise_of_coloured_light_is_taken_out(make):
    """Each channel as noisy for its light as the others, and what is stored their mean variance."""
    noisy, light = make(50_000), np.array([3.0, 1.0, 0.3])
    clean = make(50_000)
    clean.rows[:, 6:9], clean.rows[:, 9] = light, 0.0
    noise = np.random.default_rng(2).standard_normal((len(noisy), 3)) * 0.05 * light
    noisy.rows[:, 6:9] = light + noise
    noisy.rows[:, 9] = np.mean((0.05 * light) ** 2)

    def wrong(position, normal):
        return light * (1.0 + 0.1 * np.sin(20.0 * position))

    assert judged(noisy, wrong).relmse == pytest.approx(judged(clean, wrong).relmse, rel=0.1)


def test_an_error_below_the_noise_is_flagged_and_never_nothing(flat):
    figures = judged(flat(0.04), lambda position, normal: np.full((len(position), 3), 2.0))
    assert figures.under_noise
    assert 0.0 < figures.relmse < 0.1 * figures.noise_relmse
    assert np.isfinite(figures.psnr_db)


def test_coefficients_are_judged_by_the_irradiance_that_they_give(make):
    samples = make(500, kind="sh", n_coefficients=9)
    samples.rows[:, 3:-1] = 0.0
    samples.rows[:, 3:6] = 1.0  # constant radiance 0.282095, so E = π · 0.282095

    def brighter(position, normal):
        assert normal is None
        return np.tile(np.r_[1.1, 1.1, 1.1, np.zeros(24)], (len(position), 1))

    figures = judged(samples, brighter)
    assert figures.mean_ratio == pytest.approx(1.1, rel=1e-5)
    assert figures.psnr_db == pytest.approx(20.0, abs=1e-3)
    assert figures.mae == pytest.approx(0.1 / 9, rel=1e-5)  # of all 27 numbers


def test_of_many_samples_some_are_taken_evenly(make):
    samples = make(AT_MOST + 5000)
    found = judge(samples, np.arange(len(samples)), FieldFrame(samples.aabb))
    assert len(found) == AT_MOST
    assert np.array_equal(found.values[0], samples.values[0])
    middle = samples.values[len(samples) // 2]
    assert np.array_equal(found.values[AT_MOST // 2], middle)
