"""The finishing steps together."""

from __future__ import annotations

import io
import sys

import numpy as np
import pytest

from irradia.bake.finish import Finisher, FinishOptions
from irradia.bake.rasterise import rasterise
from irradia.core.progress import Progress, silent_progress

SIZE = 64


@pytest.fixture
def texels(page_mesh):
    square = [[[6, 6], [46, 6], [46, 46]], [[6, 6], [46, 46], [6, 46]]]
    return rasterise(*page_mesh(np.array(square, float), SIZE))


@pytest.fixture
def noisy(texels) -> np.ndarray:
    return np.random.default_rng(4).gamma(2.0, 0.5, (len(texels.pixel), 3)).astype(np.float32)


def finish(texels, values, valid, *, denoise: bool, progress: Progress) -> np.ndarray:
    """The pages of a bake's only map."""
    return Finisher(texels, valid, FinishOptions(denoise=denoise), progress).irradiance(values)


def all_valid(texels) -> np.ndarray:
    return np.ones(len(texels.pixel), np.bool_)


def test_finished_pages_are_smooth_and_full(texels, noisy):
    pages = finish(texels, noisy, all_valid(texels), denoise=True, progress=silent_progress())
    assert pages.shape == (1, SIZE, SIZE, 3)
    assert pages.dtype == np.float32
    assert pages.std() < 0.1 * noisy.std()
    assert pages.mean() == pytest.approx(noisy.mean(), rel=0.02)
    assert pages.min() > 0


def test_without_denoising_covered_texels_are_what_was_gathered(texels, noisy):
    pages = finish(texels, noisy, all_valid(texels), denoise=False, progress=silent_progress())
    assert np.array_equal(pages.reshape(-1, 3)[texels.pixel], noisy)


def test_invalid_texels_leave_no_trace(texels, noisy):
    valid = texels.pixel % SIZE > 20
    poisoned = np.where(valid[:, None], noisy, np.float32(1e6))
    pages = finish(texels, poisoned, valid, denoise=True, progress=silent_progress())
    assert pages.max() < 2 * noisy.max()


def test_a_missing_denoiser_is_said_and_left_out(texels, noisy, monkeypatch):
    monkeypatch.setitem(sys.modules, "pyoidn", None)
    lines = io.StringIO()
    pages = finish(texels, noisy, all_valid(texels), denoise=True, progress=Progress(stream=lines))
    assert "not denoised" in lines.getvalue()
    assert np.array_equal(pages.reshape(-1, 3)[texels.pixel], noisy)


def test_the_same_input_gives_the_same_bytes(texels, noisy):
    def once() -> bytes:
        return finish(texels, noisy, all_valid(texels), denoise=True, progress=silent_progress()).tobytes()

    assert once() == once()


def finisher_of(texels, valid, region=None, **options) -> Finisher:
    return Finisher(texels, valid, FinishOptions(**options), silent_progress(), region=region)


def two_rooms(texels) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """A hidden strip of two texels divides the chart: dark left of it, bright right; valid, region, light."""
    x = texels.pixel % SIZE
    valid = (x < 24) | (x >= 26)
    region = np.where(x < 24, 0, np.where(x >= 26, 1, 0xFFFFFFFF)).astype(np.uint32)
    light = np.where(x < 24, 0.0, 1.0)[:, None] * np.ones(3)
    return valid, region, light.astype(np.float32)


def test_light_does_not_pass_a_hidden_strip(texels, noisy):
    valid, region, light = two_rooms(texels)
    pages = finisher_of(texels, valid, region).irradiance(light * noisy)
    dark = texels.pixel[region == 0]
    assert not pages.reshape(-1, 3)[dark].any()


def test_without_regions_light_does_pass(texels, noisy):
    """The law above isn't true of itself."""
    valid, region, light = two_rooms(texels)
    pages = finisher_of(texels, valid).irradiance(light * noisy)
    assert pages.reshape(-1, 3)[texels.pixel[region == 0]].any()


def test_a_hidden_strip_takes_half_from_either_side(texels):
    valid, region, light = two_rooms(texels)
    pages = finisher_of(texels, valid, region, denoise=False).irradiance(light)
    assert not pages[0, 10:40, 24].any()
    assert pages[0, 10:40, 25].min() == 1.0


def test_companion_maps_may_have_any_channels_and_signs(texels):
    values = np.random.default_rng(6).normal(0.0, 1.0, (len(texels.pixel), 5)).astype(np.float32)
    finisher = finisher_of(texels, all_valid(texels), denoise=False)
    plain = finisher.irradiance(np.ones((len(values), 3), np.float32))
    pages = finisher.companion(values, plain)
    assert pages.shape == (1, SIZE, SIZE, 5)
    assert np.array_equal(pages.reshape(-1, 5)[texels.pixel], values)
    assert pages.min() < 0.0


def test_a_companion_is_denoised_by_what_it_is_given(texels, noisy):
    finisher = finisher_of(texels, all_valid(texels))
    plain = finisher.irradiance(noisy)
    seen = []

    def halve(values, own_texels):
        seen.append(len(own_texels.pixel))
        return values / 2

    pages = finisher.companion(noisy, plain, denoiser=halve)
    assert seen == [len(texels.pixel)]
    assert np.array_equal(pages.reshape(-1, 3)[texels.pixel], noisy / 2)


def test_without_dilation_texels_far_from_charts_stay_empty(texels, noisy):
    pages = finisher_of(texels, all_valid(texels), denoise=False, dilate=False).irradiance(noisy)
    assert not pages[0, 52:, 52:].any()
    assert pages[0, 20, 5].any()
