"""The octahedral map: where directions lie, and that filtering has no seams."""

from __future__ import annotations

import numpy as np
import pytest

from irradia.bake.probes.octahedral import bilinear_taps, octahedral_directions, octahedral_uv
from irradia.core.sh import fibonacci_sphere


@pytest.mark.parametrize(
    ("direction", "uv"),
    [
        ((0, 1, 0), (0.5, 0.5)),
        ((1, 0, 0), (1.0, 0.5)),
        ((0, 0, 1), (0.5, 1.0)),
        ((-1, 0, 0), (0.0, 0.5)),
        ((0, 0, -1), (0.5, 0.0)),
        ((0, -1, 0), (1.0, 1.0)),
        ((0.6, 0, 0.8), (0.7142857, 0.7857143)),
    ],
)
def test_axes_lie_where_the_document_says(direction, uv):
    np.testing.assert_allclose(octahedral_uv(direction), uv, atol=1e-6)


@pytest.mark.parametrize("size", [4, 7, 8])
def test_texel_centres_are_their_own_directions(size):
    uv = octahedral_uv(octahedral_directions(size))
    centre = (np.arange(size) + 0.5) / size
    v, u = np.meshgrid(centre, centre, indexing="ij")
    np.testing.assert_allclose(uv, np.stack([u.ravel(), v.ravel()], axis=1), atol=1e-12)


def test_weights_are_a_partition_and_exact_at_centres():
    uv = octahedral_uv(octahedral_directions(8))
    taps, weights = bilinear_taps(uv, 8)
    np.testing.assert_allclose(weights.sum(axis=1), 1.0)
    np.testing.assert_array_equal(taps[np.arange(64), weights.argmax(axis=1)], np.arange(64))


def test_filtering_has_no_seam_where_the_square_is_folded():
    """A smooth function of direction comes back within what its curvature allows, everywhere."""
    size = 16

    def smooth(d):
        return d @ (0.3, -0.5, 0.8) + 0.5 * d[:, 0] * d[:, 2]

    stored = smooth(octahedral_directions(size))
    directions = fibonacci_sphere(20_000)
    taps, weights = bilinear_taps(octahedral_uv(directions), size)
    error = np.abs((stored[taps] * weights).sum(axis=1) - smooth(directions))
    edge = np.abs(octahedral_uv(directions) - 0.5).max(axis=1) > 0.5 - 0.5 / size
    assert error[~edge].max() < 0.12
    assert error[edge].max() < 0.12
