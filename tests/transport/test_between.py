"""Whether points see each other."""

from __future__ import annotations

import numpy as np

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
