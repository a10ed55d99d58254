"""Pixels in Chromium, by three.js' WebGPURenderer on both backends and by its WebGLRenderer, are NumPy's."""

from __future__ import annotations

import numpy as np
import pytest

from irradia.scene.load import load_scene

from .drawn import PAIRS, SOURCES
from .pixels import srgb_steps

MAX_STEPS = 2.0  # of 255
SUBPIXEL = 1 / 16  # to which rasterisers may round vertices
CASES = [pytest.param(*pair.values, *source, marks=pair.marks) for pair in PAIRS for source in SOURCES]


@pytest.mark.parametrize(("name", "backend"), PAIRS)
def test_the_renderer_draws_by_the_backend_asked_for(draw, name: str, backend: str) -> None:
    assert {answer.backend for answer in draw(name, backend).answers.values()} == {backend}


@pytest.mark.parametrize(("name", "backend"), PAIRS)
def test_positions_lie_behind_their_pixels(draw, name: str, backend: str) -> None:
    camera, pixels = load_scene(f"builtin:{name}").cameras[0], draw(name, backend).pixels
    camera_from_world = np.linalg.inv(camera.world_from_camera)
    x, y, z = (pixels.position @ camera_from_world[:3, :3].T + camera_from_world[:3, 3]).T
    height, width = pixels.hit.shape
    scale = 0.5 * height / np.tan(0.5 * camera.yfov_rad)
    rows, columns = np.nonzero(pixels.hit)
    across = np.abs(0.5 * width + scale * x / -z - columns - 0.5)
    along = np.abs(0.5 * height - scale * y / -z - rows - 0.5)
    # Triangles that are seen from the side have no place behind their pixels.
    assert np.quantile(np.maximum(across, along), 0.998) <= SUBPIXEL


@pytest.mark.parametrize(("name", "backend", "light", "source"), CASES)
def test_pixels_are_those_of_the_reference(draw, name: str, backend: str, light: str, source: str) -> None:
    drawn = draw(name, backend)
    expected = drawn.expected(light, source)
    assert (expected > 0.1 * np.quantile(expected, 0.8)).mean() > 0.3  # there is something to see
    assert srgb_steps(drawn.found(light, source), expected).max() <= MAX_STEPS
