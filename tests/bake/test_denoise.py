"""The denoiser removes noise, keeps energy, and carries no light from chart to chart."""

from __future__ import annotations

import sys

import numpy as np
import pytest

from irradia.bake.denoise import denoise
from irradia.bake.texels import TexelSet
from irradia.core.errors import MissingDependencyError
from irradia.core.progress import silent_progress
from irradia.transport.subsample_set import SubsampleSet

SIZE = 96


def texels_of(charts: list[tuple[int, int, int, int]]) -> TexelSet:
    """Charts as rectangles (y, x, height, width) on one page."""
    page = np.full((SIZE, SIZE), -1, np.int64)
    for number, (y, x, height, width) in enumerate(charts):
        page[y : y + height, x : x + width] = number
    pixel = np.flatnonzero(page.ravel() >= 0)
    n = len(pixel)
    return TexelSet(
        n_pages=1,
        height_px=SIZE,
        width_px=SIZE,
        pixel=pixel.astype(np.uint32),
        triangle=np.zeros(n, np.uint32),
        samples=SubsampleSet.none(),
        coverage=np.ones(n, np.float32),
        chart=page.ravel()[pixel].astype(np.uint32),
    )


def truth_of(texels: TexelSet) -> np.ndarray:
    y, x = np.divmod(texels.pixel.astype(float), SIZE)
    value = 1.0 + 0.6 * np.sin(y / 11) * np.cos(x / 13)
    return np.stack([value, 0.7 * value, 0.4 * value], 1).astype(np.float32)


def noisy(truth: np.ndarray, seed: int = 3) -> np.ndarray:
    return (truth * np.random.default_rng(seed).gamma(2.0, 0.5, truth.shape)).astype(np.float32)


@pytest.fixture(scope="module")
def two_charts() -> TexelSet:
    return texels_of([(2, 2, 60, 40), (2, 44, 60, 50)])


def test_denoised_is_far_nearer_to_the_truth(two_charts):
    truth = truth_of(two_charts)
    values = noisy(truth)
    clean = denoise(values, two_charts, silent_progress())
    assert np.mean((clean - truth) ** 2) < 0.03 * np.mean((values - truth) ** 2)


def test_each_chart_keeps_its_mean(two_charts):
    values = noisy(truth_of(two_charts))
    clean = denoise(values, two_charts, silent_progress())
    for chart in (0, 1):
        own = two_charts.chart == chart
        assert clean[own].mean(axis=0) == pytest.approx(values[own].mean(axis=0), rel=1e-4)


def test_no_light_passes_from_chart_to_chart(two_charts):
    # Both inputs have one mean log luminance, so that the exposure that all charts share is the same.
    values = noisy(truth_of(two_charts))
    left, right = two_charts.chart == 0, two_charts.chart == 1
    y = two_charts.pixel // SIZE
    changed = values.copy()
    bright = right & (y % 2 == 0)
    changed[bright] *= 50.0
    changed[right & ~bright] /= 50.0
    one = denoise(values, two_charts, silent_progress())
    other = denoise(changed, two_charts, silent_progress())
    assert np.abs(one[right] - other[right]).max() > 0.1
    assert np.abs(one[left] - other[left]).max() < 1e-5


def test_a_black_chart_stays_exactly_black(two_charts):
    values = noisy(truth_of(two_charts))
    values[two_charts.chart == 0] = 0.0
    clean = denoise(values, two_charts, silent_progress())
    assert (clean[two_charts.chart == 0] == 0).all()
    assert clean[two_charts.chart == 1].min() > 0


def test_texels_with_black_neighbourhood_stay_black_on_a_lit_chart(two_charts):
    values = noisy(truth_of(two_charts))
    x = two_charts.pixel % SIZE
    values[(two_charts.chart == 1) & (x < 70)] = 0.0
    clean = denoise(values, two_charts, silent_progress())
    assert (clean[(two_charts.chart == 1) & (x < 66)] == 0).all()


def test_all_black_stays_black(two_charts):
    values = np.zeros((len(two_charts.pixel), 3), np.float32)
    assert not denoise(values, two_charts, silent_progress()).any()


def test_scaling_the_light_scales_the_result(two_charts):
    values = noisy(truth_of(two_charts))
    once = denoise(values, two_charts, silent_progress())
    scaled = denoise(values * 1024, two_charts, silent_progress())
    assert np.allclose(scaled / 1024, once, rtol=1e-3)


def test_charts_of_one_texel_and_of_one_row_are_denoised():
    texels = texels_of([(4, 4, 1, 1), (8, 8, 1, 40), (20, 20, 40, 1)])
    values = noisy(truth_of(texels))
    clean = denoise(values, texels, silent_progress())
    assert np.isfinite(clean).all()
    assert clean[texels.chart == 0] == pytest.approx(values[texels.chart == 0], rel=1e-4)


def test_one_and_two_threads_give_the_same_bytes(two_charts):
    values = noisy(truth_of(two_charts))
    alone = denoise(values, two_charts, silent_progress(), n_threads=1)
    together = denoise(values, two_charts, silent_progress(), n_threads=2)
    assert alone.tobytes() == together.tobytes()
    assert alone.tobytes() == denoise(values, two_charts, silent_progress(), n_threads=1).tobytes()


def test_a_missing_denoiser_is_named(two_charts, monkeypatch):
    monkeypatch.setitem(sys.modules, "pyoidn", None)
    with pytest.raises(MissingDependencyError, match="Open Image Denoise"):
        denoise(noisy(truth_of(two_charts)), two_charts, silent_progress())
