"""Whether points see each other."""

from __future__ import annotations

import numpy as np
import pytest

from irradia.core.rng import Seed
from irradia.field.training.jitter import jittered_in_space
from irradia.scene.merge import merge

from .flat_scenes import Sheet, matte, stacked


def test_points_see_each_other_unless_a_surface_lies_between():
    from irradia.transport.between import Between

    see = Between(merge(stacked([Sheet(matte(0.5))])))
    start = np.array([[0.1, 1.0, 0.1], [0.1, 1.0, 0.1], [0.1, 1.0, 0.1], [0.1, -1.0, 0.1]], np.float32)
    end = np.array([[0.2, -1.0, 0.1], [0.2, 0.5, 0.1], [3.0, -1.0, 0.1], [0.2, 1.0, 0.1]], np.float32)
    assert see(start, end).tolist() == [False, True, True, False]


def test_a_point_sees_itself_and_nothing_is_asked_of_nothing():
    from irradia.transport.between import Between

    see = Between(merge(stacked([Sheet(matte(0.5))])))
    point = np.array([[0.1, 1.0, 0.1]], np.float32)
    assert see(point, point).tolist() == [True]
    assert see(point[:0], point[:0]).tolist() == []


@pytest.mark.parametrize("tilt", [0.0, 0.7])
def test_copies_of_samples_on_a_sheet_stay_on_their_side_however_it_is_turned(tilt):
    from irradia.transport.between import Between

    turn = np.eye(4)
    turn[:2, :2] = [[np.cos(tilt), -np.sin(tilt)], [np.sin(tilt), np.cos(tilt)]]
    see = Between(merge(stacked([Sheet(matte(0.5), instance={"world_from_object": turn})])))
    flat = np.zeros((2000, 3))
    flat[:, ::2] = np.random.default_rng(0).random((2000, 2)) * 0.8 - 0.4
    position = (flat @ turn[:3, :3].T).astype(np.float32)
    normal = np.tile(turn[:3, 1].astype(np.float32), (2000, 1))
    source, place = _drained(jittered_in_space(position, normal, 1, 0.05, Seed(0), see))
    assert len(source) > 1700
    assert np.einsum("nc,nc->n", place, normal[source]).min() > -1e-6


def _drained(working):
    while True:
        try:
            next(working)
        except StopIteration as end:
            return end.value
