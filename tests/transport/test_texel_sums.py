"""Sums of samples, and what is known of their noise."""

from __future__ import annotations

import numpy as np
import pytest

from irradia.transport.backend import dr, mi
from irradia.transport.texel_noise import NoiseMeter
from irradia.transport.texel_sums import TexelSums

SHAPE = (1, 6, 7)
N_CHANNELS = 2


def _sums(seed: int, n_texels: int, n_rays: int = 8) -> TexelSums:
    rng = np.random.default_rng(seed)
    columns = rng.random((2, N_CHANNELS, 3, n_texels)).astype(np.float32)
    counts = np.full(n_texels, n_rays, np.uint32)
    arrays = {"gathered": columns[0], "arrived": columns[1], "rays": counts, "samples": counts.copy()}
    return TexelSums.from_arrays(arrays)


def test_absorbed_sums_are_added_bit_for_bit_and_gone():
    total, part = _sums(1, 50), _sums(2, 50)
    expected = total.plus(part).to_arrays()
    total.absorb(part)
    for name, found in total.to_arrays().items():
        np.testing.assert_array_equal(found, expected[name])
    assert len(part.rays) == len(part.gathered[0].x) == 0


def test_sums_that_begin_with_next_event_samples_leave_these_as_they_are():
    direct = _sums(1, 50)
    before = direct.to_arrays()["arrived"].copy()
    total = direct.without_rays()
    total.absorb(_sums(2, 50))
    np.testing.assert_array_equal(direct.to_arrays()["arrived"], before)
    assert not np.array_equal(total.to_arrays()["arrived"], before)


def test_zeros_are_read_without_taking_memory():
    sums = TexelSums.empty(50, N_CHANNELS)
    assert not sums.to_arrays()["gathered"].any()
    assert all(row.state == dr.VarState.Literal for colour in sums.gathered for row in colour)


@pytest.fixture
def meter() -> NoiseMeter:
    """A page with a gap in its middle, and two charts that touch."""
    _, height, width = SHAPE
    pixel = np.flatnonzero(np.arange(height * width) % 11 != 5).astype(np.uint32)
    chart = (pixel % width > 3).astype(np.uint32)
    return NoiseMeter(pixel, chart, SHAPE)


def test_noise_is_pooled_over_the_nearest_texels_of_the_chart(meter: NoiseMeter):
    _, height, width = SHAPE
    pixel = np.flatnonzero(np.arange(height * width) % 11 != 5)
    y, x = np.divmod(pixel, width)
    rounds = [_sums(seed, len(pixel)) for seed in (3, 4, 5)]
    means = np.array([np.array(mi.luminance(each.mean())) for each in rounds], np.float64)
    total = TexelSums.empty(len(pixel), N_CHANNELS)
    for part in rounds:
        meter.fold(total, part)
    error, mean = meter.standard_error(total)

    deviations = 8 * ((means - means.mean(axis=0)) ** 2).sum(axis=0)
    for i in range(len(pixel)):
        near = (np.abs(y - y[i]) <= 1) & (np.abs(x - x[i]) <= 1) & ((x > 3) == (x[i] > 3))
        pooled = deviations[near].sum() / (2 * near.sum())
        assert error[i] == pytest.approx(np.sqrt(pooled / 24), rel=1e-3)
        assert mean[i] == pytest.approx(means[:, near].mean(), rel=1e-5)
