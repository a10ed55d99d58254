"""The terrain is as large as it says, and what stands on it stands on dry ground."""

from __future__ import annotations

import numpy as np
import pytest

from irradia.scene.builtin.terrain import CELLS, N_ROCKS, N_TREES, SIZE_M, WATER_M, heights, slopes
from irradia.scene.lightmap_uv.projection import projected_charts


@pytest.fixture(scope="module")
def ground(parts):
    return next(part for part in parts("terrain") if part.node == "ground")


def test_ground_has_over_a_million_triangles_in_one_mesh(ground):
    assert len(ground.indices) == 2 * CELLS**2 > 1_000_000
    assert np.ptp(ground.positions, axis=0)[[0, 2]] == pytest.approx([SIZE_M, SIZE_M])


def test_most_of_the_land_is_dry_and_little_of_it_is_steep():
    height = heights()
    assert 0.6 < (height > WATER_M).mean() < 0.9
    assert (slopes(height) > np.sqrt(3.0)).mean() < 0.03  # 60°


def test_rocks_and_trees_stand_above_the_water(document):
    nodes = document("terrain").json["nodes"]
    things = [node for node in nodes if node["name"].startswith(("rock", "tree"))]
    assert len(things) == N_ROCKS + N_TREES
    assert min(node["translation"][1] for node in things) > WATER_M - 0.5


@pytest.mark.slow
def test_ground_unfolds_into_few_charts_of_little_stretch(ground):
    charts = projected_charts(ground.positions.astype(np.float64), ground.indices.astype(np.uint32))
    assert charts is not None
    assert charts.n_charts < 200
    largest = np.bincount(charts.chart).max()
    assert largest > 0.9 * len(ground.indices)
