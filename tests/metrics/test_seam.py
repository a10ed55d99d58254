"""The seam measure reads what a viewer's filtering reads."""

from __future__ import annotations

import numpy as np
import pytest

from irradia.metrics.seam import bilinear, seam_difference


def two_strips(left: float, right: float) -> np.ndarray:
    """A page of 4 × 8 whose left half holds one value and whose right half another."""
    page = np.full((1, 4, 8, 3), left, np.float32)
    page[:, :, 4:] = right
    return page


def test_filtering_is_linear_between_texel_centres():
    page = np.arange(8, dtype=np.float32).reshape(1, 2, 4, 1)
    at = np.array([[0.5, 0.5], [1.5, 0.5], [1.25, 0.5], [0.5, 1.0], [3.0, 1.5]])
    assert bilinear(page, np.zeros(5, int), at)[:, 0] == pytest.approx([0.0, 1.0, 0.75, 2.0, 6.5])


def test_filtering_stops_at_the_page_border():
    page = np.arange(8, dtype=np.float32).reshape(1, 2, 4, 1)
    at = np.array([[0.0, 0.0], [4.0, 2.0], [-3.0, 0.5]])
    assert bilinear(page, np.zeros(3, int), at)[:, 0] == pytest.approx([0.0, 7.0, 0.0])


def test_equal_light_has_no_difference():
    sides = np.array([[[1.0, 2.0], [6.0, 2.0]]])
    assert seam_difference(two_strips(3.0, 3.0), np.zeros((1, 2), int), sides) == pytest.approx([0.0])


def test_difference_is_relative_to_the_mean_of_both_sides():
    sides = np.array([[[1.0, 2.0], [6.0, 2.0]]])
    assert seam_difference(two_strips(0.9, 1.1), np.zeros((1, 2), int), sides) == pytest.approx(
        [0.2], rel=1e-6
    )


def test_darkness_is_compared_with_a_share_of_the_mean():
    page = two_strips(100.0, 100.0)
    page[0, :, 0], page[0, :, 7] = 0.0, 0.01
    sides = np.array([[[0.0, 2.0], [8.0, 2.0]]])
    mean = float(page.mean())
    found = seam_difference(page, np.zeros((1, 2), int), sides, dark=0.1)
    assert found == pytest.approx([0.01 / (0.1 * mean)], rel=1e-5)


def test_sides_may_lie_on_different_pages():
    pages = np.concatenate([np.full((1, 4, 4, 1), 1.0), np.full((1, 4, 4, 1), 2.0)])
    sides = np.full((1, 2, 2), 2.0)
    assert seam_difference(pages, np.array([[0, 1]]), sides) == pytest.approx([1.0 / 1.5])
