"""Pixels in Chromium, by three.js' WebGPURenderer on both backends and by its WebGLRenderer, are NumPy's."""

from __future__ import annotations

import numpy as np
import pytest

from .drawn import PAIRS, SOURCES, SUBPIXEL
from .pixels import srgb_steps

MAX_STEPS = 2.0  # of 255
CASES = [pytest.param(*pair.values, *source, marks=pair.marks) for pair in PAIRS for source in SOURCES]


@pytest.mark.parametrize(("name", "backend"), PAIRS)
def test_the_renderer_draws_by_the_backend_asked_for(draw, name: str, backend: str) -> None:
    assert {answer.backend for answer in draw(name, backend).answers.values()} == {backend}


@pytest.mark.parametrize(("name", "backend"), PAIRS)
def test_positions_lie_behind_their_pixels(draw, name: str, backend: str) -> None:
    # Triangles that are seen from the side have no place behind their pixels.
    assert np.quantile(draw(name, backend).offsets, 0.998) <= SUBPIXEL


@pytest.mark.parametrize(("name", "backend", "light", "source"), CASES)
def test_pixels_are_those_of_the_reference(draw, name: str, backend: str, light: str, source: str) -> None:
    drawn = draw(name, backend)
    expected = drawn.expected(light, source)
    assert (expected > 0.1 * np.quantile(expected, 0.8)).mean() > 0.3  # there is something to see
    assert srgb_steps(drawn.found(light, source), expected).max() <= MAX_STEPS
