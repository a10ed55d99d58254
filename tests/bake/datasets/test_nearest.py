"""Distances to surfaces, against looking at every triangle."""

from __future__ import annotations

import numpy as np
import pytest

from irradia.bake.datasets.nearest import NearestSurface
from irradia.scene.load import load_scene
from irradia.scene.merge import merge


def closest(point, a, b, c):
    """Distance by minimising over barycentrics: on a fine grid, then the plane's own foot point."""
    u, v = np.meshgrid(np.linspace(0, 1, 200), np.linspace(0, 1, 200))
    inside = u + v <= 1.0
    places = a + u[inside][:, None] * (b - a) + v[inside][:, None] * (c - a)
    return np.linalg.norm(places - point, axis=1).min()


def test_every_region_around_a_triangle_is_measured():
    from irradia.bake.datasets.nearest_kernels import build, nearest

    rng = np.random.default_rng(2)
    corners = rng.normal(size=(1, 3, 3))
    points = rng.normal(size=(60, 3)) * 2.0
    found = np.sqrt(nearest(points, corners, *build(corners))[0])
    expected = [closest(point, *corners[0]) for point in points]
    np.testing.assert_allclose(found, expected, atol=0.02)
    assert (found <= np.array(expected) + 1e-12).all()


@pytest.mark.parametrize("same", [(0, 0, 1), (0, 1, 0), (0, 1, 1), (0, 0, 0)])
def test_a_triangle_without_area_is_as_far_as_its_edges(same):
    from irradia.bake.datasets.nearest_kernels import build, nearest

    rng = np.random.default_rng(4)
    a, b, c = corners = rng.normal(size=(2, 3))[list(same)]
    points = rng.normal(size=(50, 3)) * 2.0
    found = np.sqrt(nearest(points, corners[None], *build(corners[None]))[0])
    np.testing.assert_allclose(found, [closest(point, a, b, c) for point in points], atol=0.02)


def test_tree_finds_what_a_look_at_every_triangle_finds():
    from irradia.bake.datasets.nearest_kernels import build, nearest

    rng = np.random.default_rng(3)
    corners = rng.normal(size=(300, 1, 3)) + 0.3 * rng.normal(size=(300, 3, 3))
    corners[:20] = corners[0]  # coincident ones can't be parted
    points = rng.normal(size=(500, 3))
    distance2, triangle = nearest(points, corners, *build(corners))
    each = np.array([nearest(points, c[None], *build(c[None]))[0] for c in corners])
    np.testing.assert_array_equal(distance2, each.min(axis=0))
    np.testing.assert_array_equal(each[triangle, np.arange(500)], distance2)


def test_points_of_the_two_rooms_know_their_wall():
    surfaces = NearestSurface(merge(load_scene("builtin:rooms")))
    points = np.array([(-0.03, 1.2, -1.0), (0.15, 1.2, -1.0), (0.05, 1.0, 0.75), (-2.0, 1.4, -1.0)])
    assert surfaces.distance_m(points) == pytest.approx([0.03, 0.05, 0.45, 0.75], abs=1e-6)
