"""Regions: texels of a chart that hang together without passing through anything hidden."""

from __future__ import annotations

import numpy as np
import pytest

from irradia.bake.regions import NOWHERE, find_regions
from irradia.bake.texels import TexelSet
from irradia.transport.subsample_set import SubsampleSet

WIDTH, HEIGHT = 8, 4
NOTHING_MOVED = np.zeros((0, 2), np.uint32)


def texels_of(picture: str) -> TexelSet:
    """A page drawn in letters, a chart for each; dots are free."""
    rows = picture.split()
    letters = np.array([list(row) for row in rows])
    pixel = np.flatnonzero(letters.ravel() != ".")
    charts = np.unique(letters[letters != "."], return_inverse=True)[1]
    n = len(pixel)
    return TexelSet(
        n_pages=1,
        height_px=HEIGHT,
        width_px=WIDTH,
        pixel=pixel.astype(np.uint32),
        triangle=np.zeros(n, np.uint32),
        samples=SubsampleSet.none(),
        coverage=np.ones(n, np.float32),
        chart=charts.astype(np.uint32),
    )


def regions_of(
    picture: str, *, hidden: str = "#", cut: np.ndarray | None = None
) -> tuple[np.ndarray, TexelSet]:
    """Regions on the page, −1 where there are none; ``#`` is a hidden texel of chart a."""
    texels = texels_of(picture.replace(hidden, "a"))
    marks = np.array(list("".join(picture.split())))[texels.pixel]
    cut = np.zeros(len(texels.pixel), np.uint8) if cut is None else cut
    region = find_regions(texels, marks != hidden, cut, NOTHING_MOVED).astype(np.int64)
    page = np.full(WIDTH * HEIGHT, -1)
    page[texels.pixel] = np.where(region == NOWHERE, -2, region)
    return page.reshape(HEIGHT, WIDTH), texels


def test_a_whole_chart_is_one_region():
    page, _ = regions_of("aaaa.... aaaa.... aaaa.... aaaa....")
    assert set(page[:, :4].ravel()) == {0}


def test_charts_that_touch_are_two():
    page, _ = regions_of("aaaabbbb aaaabbbb aaaabbbb aaaabbbb")
    assert set(page[:, :4].ravel()) == {0}
    assert set(page[:, 4:].ravel()) == {4}


def test_a_hidden_strip_divides_a_chart():
    page, _ = regions_of("aaa#aaaa aaa#aaaa aaa#aaaa aaa#aaaa")
    assert set(page[:, :3].ravel()) == {0}
    assert set(page[:, 3]) == {-2}
    assert set(page[:, 4:].ravel()) == {4}


def test_a_hidden_strip_that_ends_does_not_divide():
    page, _ = regions_of("aaa#aaaa aaa#aaaa aaa#aaaa aaaaaaaa")
    assert set(page[page >= 0]) == {0}


@pytest.mark.parametrize("step", [1, -1])
def test_texels_that_touch_at_corners_hang_together(step):
    rows = ["a.......", ".a......", "..a.....", "...a...."][::step]
    page, _ = regions_of(" ".join(rows))
    assert len(set(page[page >= 0])) == 1


def test_rows_do_not_wrap_round_the_page():
    page, _ = regions_of(".......a a....... ........ ........")
    assert len(set(page[page >= 0])) == 2


def test_a_thin_wall_between_texels_divides_them():
    texels = texels_of("aaaaaaaa aaaaaaaa aaaaaaaa aaaaaaaa")
    x = texels.pixel % WIDTH
    # Left and upper left of column 4, upper right of column 3: all ways across the line between them.
    cut = np.where(x == 4, 0b0011, np.where(x == 3, 0b1000, 0)).astype(np.uint8)
    page, _ = regions_of("aaaaaaaa aaaaaaaa aaaaaaaa aaaaaaaa", cut=cut)
    assert set(page[:, :4].ravel()) == {0}
    assert set(page[:, 4:].ravel()) == {4}


def test_a_moved_texel_belongs_to_the_one_that_it_stands_for():
    texels = texels_of("aaaaaaaa aaaaaaaa aaaaaaaa aaaaaaaa")
    visible = texels.pixel % WIDTH != 3
    moved = np.array([[3, 4]], np.uint32)
    region = find_regions(texels, visible, np.zeros(len(visible), np.uint8), moved)
    assert region[3] == region[4] != region[2]
