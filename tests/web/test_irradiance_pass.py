"""Light evaluated once a pixel, before the scene is drawn, is the light that materials evaluate."""

from __future__ import annotations

import pytest

from .drawn import FIRST, PASSES
from .pixels import BACKENDS, steps_apart

MAX_STEPS = 2.0  # of 255


@pytest.mark.parametrize("source", [source for source, how in PASSES if how == "full"])
@pytest.mark.parametrize("backend", BACKENDS)
def test_at_full_resolution_pixels_are_those_of_the_reference(draw, backend: str, source: str) -> None:
    drawn = draw("cornell", backend)
    found = drawn.found(FIRST, f"{source} full")
    assert steps_apart(found, drawn.expected(FIRST, source)).max() <= MAX_STEPS


@pytest.mark.parametrize("source", ["sh", "indirect"])
@pytest.mark.parametrize("backend", BACKENDS)
def test_at_half_resolution_smooth_light_stays_smooth_and_edges_sharp(
    draw, backend: str, source: str
) -> None:
    """The room's walls meet at edges of light that a mean across them would shift by tens of steps."""
    drawn = draw("cornell", backend)
    steps = steps_apart(drawn.found(FIRST, f"{source} half"), drawn.expected(FIRST, source))
    assert steps.mean() <= 0.15
    assert steps.max() <= 6.0


@pytest.mark.parametrize("backend", BACKENDS)
def test_at_half_resolution_most_pixels_are_means(draw, backend: str) -> None:
    """Light that changes from pixel to pixel shows it."""
    drawn = draw("cornell", backend)
    steps = steps_apart(drawn.found(FIRST, "hash-int8 half"), drawn.expected(FIRST, "hash-int8"))
    assert (steps.max(axis=1) > MAX_STEPS).mean() > 0.25
