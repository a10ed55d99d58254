"""Light evaluated once a pixel, before the scene is drawn, is the light that materials evaluate."""

from __future__ import annotations

import numpy as np
import pytest

from .drawn import FIRST, PAIRS, PASSES, SUBPIXEL
from .pixels import BACKENDS, srgb_steps

MAX_STEPS = 2.0  # of 255


@pytest.mark.parametrize("source", [source for source, how in PASSES if how == "full"])
@pytest.mark.parametrize(("name", "backend"), PAIRS)
def test_at_full_resolution_pixels_are_those_of_the_reference(
    draw, name: str, backend: str, source: str
) -> None:
    drawn = draw(name, backend)
    steps = srgb_steps(drawn.found(FIRST, f"{source} full"), drawn.expected(FIRST, source))
    # Triangles that are seen from the side: materials know where they lie, the pass where the pixel looks.
    is_behind = drawn.offsets <= SUBPIXEL
    assert is_behind.mean() > 0.99
    assert steps[is_behind].max() <= MAX_STEPS


@pytest.mark.parametrize("source", ["sh", "indirect"])
@pytest.mark.parametrize("backend", BACKENDS)
def test_at_half_resolution_smooth_light_stays_smooth_and_edges_sharp(
    draw, backend: str, source: str
) -> None:
    """The room's walls meet at edges of light that a mean across them would shift by tens of steps."""
    drawn = draw("cornell", backend)
    steps = srgb_steps(drawn.found(FIRST, f"{source} half"), drawn.expected(FIRST, source))
    assert steps.mean() <= 0.15
    assert steps.max() <= 6.0


@pytest.mark.parametrize("backend", BACKENDS)
def test_at_half_resolution_light_that_changes_from_pixel_to_pixel_is_smoothed(draw, backend: str) -> None:
    """Where neighbours have no kin the light is evaluated, so most pixels still are what they should be."""
    drawn = draw("cornell", backend)
    steps = srgb_steps(drawn.found(FIRST, "hash-int8 half"), drawn.expected(FIRST, "hash-int8"))
    assert 0.2 < (steps.max(axis=1) > MAX_STEPS).mean() < 0.35
    assert np.median(steps) <= 0.2
    assert steps.mean() <= 1.3
    assert np.quantile(steps, 0.99) <= 13.0
