"""After dilation no texel is empty, and none that was covered has changed."""

from __future__ import annotations

import numpy as np
import pytest

from irradia.bake.dilate import dilate, fill_invalid
from irradia.bake.rasterise import rasterise

SIZE = 50  # not a power of two, so that mip levels have odd edges


def two_squares() -> np.ndarray:
    """Two charts, two free texels apart."""

    def square(x0: float, x1: float) -> list:
        return [[[x0, 10], [x1, 10], [x1, 20]], [[x0, 10], [x1, 20], [x0, 20]]]

    return np.array(square(10, 20) + square(22, 32), float)


@pytest.fixture
def squares(page_mesh):
    return rasterise(*page_mesh(two_squares(), SIZE, chart=np.array([0, 0, 1, 1])))


def colours(squares) -> np.ndarray:
    """Red on the first chart, green on the second."""
    return np.where(squares.chart[:, None] == 0, np.float32([1, 0, 0]), np.float32([0, 1, 0]))


def test_covered_texels_keep_their_value_exactly(squares):
    values = np.random.default_rng(1).random((len(squares.pixel), 3), np.float32)
    pages = dilate(values, squares)
    assert np.array_equal(pages.reshape(-1, 3)[squares.pixel], values)


def test_no_texel_of_a_page_stays_black(squares):
    pages = dilate(np.ones((len(squares.pixel), 3), np.float32), squares)
    assert pages == pytest.approx(np.ones((1, SIZE, SIZE, 3)), abs=1e-6)


def test_the_texel_beside_a_chart_has_that_charts_colour(squares):
    page = dilate(colours(squares), squares)[0]
    assert np.array_equal(page[10:20, 20], np.tile(np.float32([1, 0, 0]), (10, 1)))
    assert np.array_equal(page[10:20, 21], np.tile(np.float32([0, 1, 0]), (10, 1)))


def test_filling_creates_no_energy(squares):
    values = np.random.default_rng(2).random((len(squares.pixel), 3), np.float32)
    pages = dilate(values, squares)
    assert pages.min() >= values.min() - 1e-6
    assert pages.max() <= values.max() + 1e-6


def test_a_page_without_covered_texels_is_black(page_mesh):
    texels = rasterise(*page_mesh(two_squares(), SIZE, n_pages=2, page=1))
    pages = dilate(np.ones((len(texels.pixel), 3), np.float32), texels)
    assert not pages[0].any()
    assert pages[1].min() == pytest.approx(1.0, abs=1e-6)


def test_invalid_texels_take_light_from_their_own_chart(squares):
    valid = squares.pixel % SIZE != 19  # the column next to the other chart
    values = np.where(valid[:, None], colours(squares), np.float32([9, 9, 9]))
    filled = fill_invalid(values, valid, squares)
    assert np.array_equal(filled, colours(squares))


def test_far_invalid_texels_are_reached_ring_by_ring(squares):
    valid = (squares.pixel % SIZE == 10) | (squares.chart == 1)
    filled = fill_invalid(colours(squares), valid, squares)
    assert np.array_equal(filled, colours(squares))


def test_a_chart_without_valid_texels_becomes_black(squares):
    filled = fill_invalid(np.ones((len(squares.pixel), 3), np.float32), squares.chart == 1, squares)
    assert not filled[squares.chart == 0].any()
    assert (filled[squares.chart == 1] == 1).all()


def test_light_does_not_pass_between_charts_that_abut(page_mesh):
    corners = two_squares()
    corners[2:, :, 0] -= 2
    texels = rasterise(*page_mesh(corners, SIZE, chart=np.array([0, 0, 1, 1])))
    valid = texels.pixel % SIZE != 19
    filled = fill_invalid(colours(texels), valid, texels)
    assert np.array_equal(filled, colours(texels))
