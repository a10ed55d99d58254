"""Four channels: none is shared by lights that overlap, and the strong come first."""

from __future__ import annotations

import numpy as np
import pytest

from irradia.bake.mask_channels import NO_CHANNEL, assign_channels


def _graph(n: int, edges) -> np.ndarray:
    overlap = np.eye(n, dtype=bool)
    for a, b in edges:
        overlap[a, b] = overlap[b, a] = True
    return overlap


def _complete(n: int) -> np.ndarray:
    return np.ones((n, n), bool)


@pytest.mark.parametrize("seed", range(8))
@pytest.mark.parametrize("density", [0.02, 0.1, 0.4])
def test_overlapping_lights_never_share(seed, density):
    rng = np.random.default_rng(seed)
    upper = np.triu(rng.random((60, 60)) < density, 1)
    overlap = upper | upper.T
    channel = assign_channels(overlap, rng.random(60))
    same = (channel[:, None] == channel[None]) & (channel != NO_CHANNEL)
    assert not (same & overlap).any()


@pytest.mark.parametrize("seed", range(8))
def test_a_light_goes_without_only_where_every_channel_is_taken_beside_it(seed):
    rng = np.random.default_rng(seed)
    upper = np.triu(rng.random((60, 60)) < 0.2, 1)
    overlap = upper | upper.T
    channel = assign_channels(overlap, rng.random(60))
    without = np.flatnonzero(channel == NO_CHANNEL)
    assert len(without) > 0
    for light in without:
        assert set(channel[overlap[light]]) >= {0, 1, 2, 3}


def test_lights_apart_share_the_first_channel():
    assert assign_channels(_graph(7, []), np.ones(7)).tolist() == [0] * 7
    assert assign_channels(np.zeros((0, 0), bool), []).tolist() == []


def test_four_that_overlap_take_all_channels():
    assert sorted(assign_channels(_complete(4), [1, 2, 3, 4])) == [0, 1, 2, 3]


def test_of_too_many_the_weakest_go_without():
    strength = np.array([3.0, 0.5, 9.0, 1.0, 4.0, 2.0])
    channel = assign_channels(_complete(6), strength)
    assert (channel == NO_CHANNEL).tolist() == [False, True, False, True, False, False]


def test_the_sun_keeps_its_channel_among_many_lamps():
    """Two rooms of four lamps each fill the channels before the sun's turn would come."""
    rooms = [(a, b) for first in (1, 5) for a in range(first, first + 4) for b in range(first, a)]
    sun = [(0, lamp) for lamp in range(1, 9)]
    strength = np.array([100.0, *range(1, 9)])
    channel = assign_channels(_graph(9, rooms + sun), strength)
    assert channel[0] != NO_CHANNEL
    assert np.flatnonzero(channel == NO_CHANNEL).tolist() == [1, 5]


def test_a_light_met_late_takes_the_channel_of_the_weakest():
    """Three weak lights, each beside three of four strong ones, have their channels before two that
    overlap them get their turn. The first of these takes the fourth channel, the second finds none.
    """
    strong = [(a, b) for a in range(4) for b in range(a)]
    weak = [(4 + w, s) for w in range(3) for s in range(4) if s != w]
    late = [(a, b) for a in (7, 8) for b in range(4, a)]
    strength = np.array([100.0, 99.0, 98.0, 97.0, 3.0, 1.0, 2.0, 60.0, 50.0])
    channel = assign_channels(_graph(9, strong + weak + late), strength)
    assert np.flatnonzero(channel == NO_CHANNEL).tolist() == [5]
    assert channel[8] == channel[1]


def test_a_grid_of_rooms_needs_no_fallback():
    """Lamps of a 12 × 12 grid that reach their eight neighbours: four channels are just enough."""
    cells = [(x, y) for x in range(12) for y in range(12)]
    near = [
        (i, j)
        for i, a in enumerate(cells)
        for j, b in enumerate(cells)
        if i < j and max(abs(a[0] - b[0]), abs(a[1] - b[1])) == 1
    ]
    channel = assign_channels(_graph(144, near), np.ones(144))
    assert (channel != NO_CHANNEL).all()


def test_lights_without_power_end_too():
    channel = assign_channels(_complete(9), np.zeros(9))
    assert (channel != NO_CHANNEL).sum() == 4
