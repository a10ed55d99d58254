"""The hash grid against tiny-cuda-nn's conventions, worked out by hand."""

from __future__ import annotations

import numpy as np
import pytest

from irradia.core.errors import InputError
from irradia.field.encodings import HashGrid


def only(grid: HashGrid, level: int, entry: int, feature: int = 0) -> np.ndarray:
    """Parameters that are 1 in one place."""
    table = np.zeros((grid.n_parameters // grid.n_features, grid.n_features), np.float32)
    table[grid.levels()[level].first + entry, feature] = 1.0
    return table.ravel()


def at(*x: float) -> np.ndarray:
    return np.array([x], np.float32)


def test_resolutions_grow_from_base_to_maximum():
    levels = HashGrid().levels()
    assert [level.resolution for level in levels][:6] == [16, 23, 31, 43, 59, 81]
    assert levels[0].scale == 15.0
    assert levels[15].resolution == 2048  # exp2f would give 2049
    assert levels[15].scale == 2047.0


def test_a_level_stores_its_corners_rounded_up_to_eight_or_a_full_table():
    levels = HashGrid().levels()
    assert [level.n_entries for level in levels][:6] == [16**3, 12168, 29792, 79512, 205384, 1 << 19]
    assert [level.dense for level in levels] == [True] * 5 + [False] * 11
    assert [level.first for level in levels][:3] == [0, 4096, 16264]


@pytest.mark.parametrize(("finest", "n_parameters"), [(2048, 12_196_240), (8192, 13_074_912)])
def test_sizes_are_those_that_instant_ngp_reports(finest, n_parameters):
    assert HashGrid(max_resolution=finest).n_parameters == n_parameters


def test_full_levels_store_whole_tables():
    grid = HashGrid(8, 17, 2, 16, 512, full_levels=True)
    assert {level.n_entries for level in grid.levels()} == {1 << 17}
    assert grid.n_parameters == 2_097_152


def test_dense_corners_are_numbered_along_x_first():
    grid = HashGrid(1, 12, 2, 16, 16)
    # Scale 15 puts x = 0.1, 0.3, 0.5 at 2, 5, 8; entry 2 + 16·5 + 256·8.
    features = grid.forward(at(0.1, 0.3, 0.5), only(grid, 0, 2130, 1))
    np.testing.assert_allclose(features, [[0.0, 1.0]], atol=2e-6)


def test_hashed_corners_wrap_at_32_bits():
    grid = HashGrid(2, 10, 1, 2, 65)
    # Scale 64 puts (1, 3, 5) / 128 on corner (1, 2, 3). 2·2654435761 and 3·805459861 are 1013904226 and
    # 2416379583 modulo 2³²; with 1, XOR gives 2892625372, and modulo 1024 that is 476.
    assert (grid.levels()[1].scale, grid.levels()[1].dense) == (64.0, False)
    features = grid.forward(at(1 / 128, 3 / 128, 5 / 128), only(grid, 1, 476))
    np.testing.assert_array_equal(features, [[0.0, 1.0]])


def test_features_are_interpolated_linearly_half_a_cell_off():
    grid = HashGrid(1, 12, 1, 5, 5)
    # Scale 4: (0.1875, 0.25, 0.375) lies at (1.25, 1.5, 2).
    x = at(0.1875, 0.25, 0.375)
    for entry, weight in {1 + 5 + 50: 0.375, 2 + 5 + 50: 0.125, 1 + 10 + 50: 0.375, 1 + 5 + 75: 0.0}.items():
        assert grid.forward(x, only(grid, 0, entry))[0, 0] == pytest.approx(weight, abs=1e-6)


def test_beyond_the_last_corner_an_index_runs_on_into_the_next_row():
    grid = HashGrid(1, 12, 1, 4, 4)
    # At x = 1 a point lies at 3.5 of corners 0 to 3: half of corner 4, which is corner 0 of the next row.
    features = grid.forward(at(1.0, 1 / 6, 1 / 6), only(grid, 0, 0 + 4 * 2 + 16 * 1))
    assert features[0, 0] == pytest.approx(0.5, abs=1e-6)


def test_the_corner_of_the_box_wraps_at_the_end_of_its_table():
    grid = HashGrid(1, 12, 1, 3, 3)
    # At (1, 1, 1) a point lies at 2.5: an eighth of corner (3, 3, 3), whose index 39 is 7 of 32 entries.
    assert grid.n_parameters == 32
    features = grid.forward(at(1.0, 1.0, 1.0), only(grid, 0, 39 % 32))
    assert features[0, 0] == pytest.approx(1 / 8)


def test_points_outside_the_box_are_clamped_to_it(rng):
    grid = HashGrid(4, 8, 2, 3, 30)
    table = rng.random(grid.n_parameters)
    outside = grid.forward(at(-0.3, 0.5, 1.7), table)
    np.testing.assert_array_equal(outside, grid.forward(at(0.0, 0.5, 1.0), table))


def test_positions_are_rounded_to_float_also_where_tables_are_double():
    grid = HashGrid(1, 10, 1, 2048, 2048)
    x = np.array([[0.123456789, 0.5, 0.5]])
    rounded = (np.float32(2047.0) * x.astype(np.float32) + np.float32(0.5)) % 1.0
    table = np.random.default_rng(2).normal(size=grid.n_parameters)
    level = grid.levels()[0]
    expected = 0.0
    cell = np.array([253, 1024, 1024])
    for corner in np.ndindex(2, 2, 2):
        weight = np.prod(np.where(corner, rounded[0].astype(float), 1.0 - rounded[0].astype(float)))
        mixed = [int(c + d) * p % 2**32 for c, d, p in zip(cell, corner, grid.primes, strict=True)]
        expected += weight * table[(mixed[0] ^ mixed[1] ^ mixed[2]) % level.n_entries]
    assert grid.forward(x, table)[0, 0] == pytest.approx(expected, rel=1e-12)


def test_tables_start_within_a_ten_thousandth(rng):
    table = HashGrid(4, 12).init(rng)
    assert table.dtype == np.float32
    assert 0.99e-4 < table.max() <= 1e-4
    assert -0.99e-4 > table.min() >= -1e-4


def test_the_floor_convention_has_no_half_cell():
    grid = HashGrid(2, 12, 1, 4, 9, convention="floor")
    assert [(level.scale, level.offset, level.resolution) for level in grid.levels()] == [
        (4, 0, 5),
        (9, 0, 10),
    ]
    features = grid.forward(at(0.25, 0.5, 0.75), only(grid, 0, 1 + 5 * 2 + 25 * 3))
    assert features[0, 0] == 1.0


def test_dense_levels_may_be_hashed_too():
    grid = HashGrid(1, 12, 1, 6, 6, hash_all=True)
    # Corner (1, 2, 3) as above, modulo the level's 216 entries.
    features = grid.forward(at(0.5 / 5, 1.5 / 5, 2.5 / 5), only(grid, 0, 2892625372 % 216))
    assert features[0, 0] == pytest.approx(1.0, abs=1e-5)


@pytest.mark.parametrize(
    "wrong",
    [
        {"n_levels": 0},
        {"base_resolution": 64, "max_resolution": 16},
        {"log2_table_size": 40},
        {"primes": (1, 2)},
    ],
)
def test_grids_that_cannot_be_are_refused(wrong):
    with pytest.raises(InputError, match="expected"):
        HashGrid(**wrong)
