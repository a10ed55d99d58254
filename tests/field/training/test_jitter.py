"""Displaced copies and smoothed values."""

from __future__ import annotations

import numpy as np
import pytest

from irradia.core.rng import Seed
from irradia.field.training.jitter import jittered_in_space, jittered_on_surfaces
from irradia.field.training.smoothing import smoothed

SEED = Seed(1)
UP = np.array([0.0, 1.0, 0.0])


def drained(working):
    while True:
        try:
            next(working)
        except StopIteration as end:
            return end.value


def sheet(n, low, high, normal, rng):
    """Samples on an axis-aligned rectangle."""
    position = np.asarray(low) + rng.random((n, 3)) * (np.asarray(high) - np.asarray(low))
    return position.astype(np.float32), np.tile(np.asarray(normal, np.float32), (n, 1))


def joined(*sheets):
    return tuple(np.concatenate(parts) for parts in zip(*sheets, strict=True))


@pytest.fixture
def rooms():
    """The floors of two rooms with a wall of 2 cm between them, both its faces sampled."""
    rng = np.random.default_rng(0)
    return joined(
        sheet(800, (-1, 0, 0), (-0.01, 0, 1), (0, 1, 0), rng),
        sheet(800, (0.01, 0, 0), (1, 0, 1), (0, 1, 0), rng),
        sheet(800, (-0.01, 0, 0), (-0.01, 1, 1), (-1, 0, 0), rng),
        sheet(800, (0.01, 0, 0), (0.01, 1, 1), (1, 0, 0), rng),
    )


@pytest.fixture
def thin_sheet():
    """The two faces of a sheet of 1 mm."""
    rng = np.random.default_rng(0)
    return joined(
        sheet(1000, (0, 0.0005, 0), (1, 0.0005, 1), UP, rng),
        sheet(1000, (0, -0.0005, 0), (1, -0.0005, 1), -UP, rng),
    )


def test_no_copy_crosses_the_wall_between_rooms(rooms):
    position, normal = rooms
    source, place = drained(jittered_on_surfaces(position, normal, 8, 0.5, SEED))
    on_floor = normal[source, 1] > 0.5
    near_wall = on_floor & (np.abs(position[source, 0]) < 0.05)
    assert near_wall.sum() > 100
    assert np.all(np.sign(place[on_floor, 0]) == np.sign(position[source[on_floor], 0]))


def test_no_copy_goes_to_the_other_face_of_a_thin_sheet(thin_sheet):
    position, normal = thin_sheet
    source, place = drained(jittered_on_surfaces(position, normal, 4, 0.1, SEED))
    assert len(source) > 0.5 * 4 * len(position)
    assert np.allclose(place[:, 1], position[source, 1], atol=1e-6)


def test_copies_stay_in_the_tangent_plane_within_the_radius(rooms):
    position, normal = rooms
    source, place = drained(jittered_on_surfaces(position, normal, 4, 0.02, SEED))
    way = place - position[source]
    assert np.abs(np.einsum("nc,nc->n", way, normal[source])).max() < 1e-5
    length = np.linalg.norm(way, axis=1)
    assert length.max() <= 0.02 * (1 + 1e-5)
    assert np.median(length) == pytest.approx(0.02 / np.sqrt(2), rel=0.05)  # uniform over the disc


def test_copies_of_an_open_floor_are_hardly_lost():
    position, normal = sheet(2000, (0, 0, 0), (1, 0, 1), UP, np.random.default_rng(0))
    source, _ = drained(jittered_on_surfaces(position, normal, 2, 0.01, SEED))
    assert len(source) == 2 * len(position)


def test_copies_depend_on_the_seed_alone(rooms):
    one, other = (drained(jittered_on_surfaces(*rooms, 2, 0.05, SEED)) for _ in range(2))
    assert np.array_equal(one[1], other[1])
    third = drained(jittered_on_surfaces(*rooms, 2, 0.05, Seed(2)))
    assert len(third[1]) != len(one[1]) or not np.array_equal(third[1], one[1])


def test_a_test_by_rays_replaces_that_by_discs(rooms):
    asked = []

    def blind(start, end):
        asked.append((start, end))
        return np.zeros(len(start), bool)

    source, _ = drained(jittered_on_surfaces(*rooms, 1, 0.05, SEED, blind))
    assert len(source) == 0
    start, _ = asked[0]
    lifted = np.einsum("nc,nc->n", start - rooms[0][: len(start)], rooms[1][: len(start)])
    assert np.all(lifted > 0.0)  # or the rays would meet the surface itself


def test_copies_in_space_fill_a_ball_as_far_as_they_are_seen():
    position = np.random.default_rng(0).random((4000, 3)).astype(np.float32)

    def left_of_the_middle(start, end):
        return (start[:, 0] < 0.5) == (end[:, 0] < 0.5)

    source, place = drained(jittered_in_space(position, None, 2, 0.1, SEED, left_of_the_middle))
    assert np.all((place[:, 0] < 0.5) == (position[source, 0] < 0.5))
    length = np.linalg.norm(place - position[source], axis=1)
    assert length.max() <= 0.1 * (1 + 1e-5)
    inner = np.abs(position[source, 0] - 0.5) > 0.1
    assert np.median(length[inner]) == pytest.approx(0.1 * np.cbrt(0.5), rel=0.03)


def test_copies_of_a_volumes_samples_on_a_surface_stay_above_it():
    """On a tilted plane, where rounding puts samples on either side; others of the volume are free."""
    normal = np.array([0.36, 0.8, -0.48], np.float32)
    position = np.random.default_rng(0).random((4000, 3)).astype(np.float32)
    on_plane = np.arange(4000) < 2000
    position[on_plane] -= np.outer((position @ normal)[on_plane], normal)

    def on_one_side(start, end):
        return (start @ normal > 0.0) == (end @ normal > 0.0)

    assert 0.1 < np.mean(position[on_plane] @ normal > 0.0) < 0.9
    normals = np.tile(normal, (4000, 1))
    source, place = drained(jittered_in_space(position, normals, 2, 0.1, SEED, on_one_side))
    height = place @ normal
    assert np.all(height[on_plane[source]] > -1e-6)
    assert np.mean(on_plane[source]) > 0.45, "half the ball is enough to find places in"
    free = ~on_plane[source] & (position[source] @ normal > 0.1)
    assert np.mean(height[free] < position[source[free]] @ normal) == pytest.approx(0.5, abs=0.05)


def test_smoothing_keeps_constants(rooms):
    position, normal = rooms
    values = np.full((len(position), 12), 3.25, np.float32)
    assert np.allclose(drained(smoothed(position, normal, values, 8, 0.5)), 3.25, rtol=1e-6)


def test_smoothing_averages_noise_away():
    rng = np.random.default_rng(0)
    position, normal = sheet(5000, (0, 0, 0), (1, 0, 1), UP, rng)
    values = (5.0 + rng.standard_normal((5000, 3))).astype(np.float32)
    result = drained(smoothed(position, normal, values, 16, 0.5))
    assert result.std() == pytest.approx(values.std() / 4, rel=0.15)
    assert result.mean() == pytest.approx(5.0, abs=0.05)


def test_smoothing_keeps_the_faces_of_a_sheet_apart(thin_sheet):
    position, normal = thin_sheet
    values = np.where(normal[:, 1:2] > 0, 1.0, 9.0).astype(np.float32) * np.ones(3, np.float32)
    result = drained(smoothed(position, normal, values, 8, 0.5))
    assert np.allclose(result, values, rtol=1e-6)
    mixed = drained(smoothed(position, None, values, 8, 0.5))
    assert np.abs(mixed - values).max() > 2.0


def test_one_neighbour_is_the_sample_itself():
    position, normal = sheet(100, (0, 0, 0), (1, 0, 1), UP, np.random.default_rng(0))
    values = np.arange(300, dtype=np.float32).reshape(100, 3)
    assert np.array_equal(drained(smoothed(position, normal, values, 1, 0.5)), values)


def test_more_neighbours_than_samples_take_them_all():
    position, normal = sheet(5, (0, 0, 0), (1, 0, 1), UP, np.random.default_rng(0))
    values = np.arange(15, dtype=np.float32).reshape(5, 3)
    assert np.allclose(drained(smoothed(position, normal, values, 50, 0.5)), values.mean(axis=0))
