"""The finishing steps together."""

from __future__ import annotations

import io
import sys

import numpy as np
import pytest

from irradia.bake.finish import finish
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
