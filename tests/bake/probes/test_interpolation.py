"""Reading between probes: exact where it must be, smooth, and tight at walls."""

from __future__ import annotations

import numpy as np
import pytest

from irradia.bake.probes.gather import bake_probes
from irradia.bake.probes.interpolation import interpolate, irradiance_at, probe_weights
from irradia.bake.probes.options import ProbeOptions
from irradia.formats.probes import EMPTY, NO_PROBE, VALID, ProbeOctree, ProbeSet

from .places import WALL_M, blank_probes, two_rooms, unit_grid


def ramp(positions: np.ndarray) -> np.ndarray:
    """Coefficients that grow linearly in space: trilinear filtering is exact for them."""
    series = np.zeros((len(positions), 9, 3), np.float32)
    series[:, 0] = (positions @ (1.0, 2.0, 4.0))[:, None] + 10.0
    return series


def test_linear_light_is_exact_between_probes_in_the_open():
    grid, positions = unit_grid((3, 4, 2))
    probes = blank_probes(positions, coefficients=ramp(positions), structure=grid)
    points = np.random.default_rng(5).uniform(0, (2, 3, 1), (200, 3))
    expected = points @ (1.0, 2.0, 4.0) + 10.0
    np.testing.assert_allclose(interpolate(probes, points)[:, 0, 0], expected, rtol=1e-6)


def test_beyond_the_outermost_probes_light_stays_what_it_is_there():
    grid, positions = unit_grid((3, 4, 2))
    probes = blank_probes(positions, coefficients=ramp(positions), structure=grid)
    outside, edge = np.array([(-3.0, 1.5, 0.5)]), np.array([(0.0, 1.5, 0.5)])
    np.testing.assert_allclose(interpolate(probes, outside), interpolate(probes, edge), rtol=1e-5)


@pytest.mark.parametrize("shape", [(1, 1, 1), (1, 3, 1), (2, 1, 2)])
def test_flat_grids_work(shape):
    grid, positions = unit_grid(shape)
    probes = blank_probes(positions, coefficients=ramp(positions), structure=grid)
    np.testing.assert_allclose(interpolate(probes, positions)[:, 0, 0], ramp(positions)[:, 0, 0], rtol=1e-6)


def test_probes_in_walls_do_not_count():
    grid, positions = unit_grid((2, 2, 2))
    state = np.full(8, EMPTY, np.uint8)
    state[5] = VALID
    series = ramp(positions)
    series[:5] = 1e30
    probes = blank_probes(positions, coefficients=series, structure=grid, state=state)
    index, weight = probe_weights(probes, np.array([(0.3, 0.3, 0.3)]))
    assert weight[0, index[0] == 5].sum() == pytest.approx(1.0)


def test_octree_finds_the_cell_of_either_level():
    """One coarse cell at x < 1, and at x ≥ 1 one whose lowest child is all there is."""
    cells = np.array([(0, 0, 0, 0), (2, 0, 0, 1)], np.int32)
    corner = np.array([(i & 1, i >> 1 & 1, i >> 2 & 1) for i in range(8)], np.float32)
    positions = np.concatenate([corner, (1, 0, 0) + 0.5 * corner])
    tree = ProbeOctree(np.zeros(3, np.float32), 1.0, cells, np.arange(16, dtype=np.uint32).reshape(2, 8))
    probes = blank_probes(positions, coefficients=ramp(positions), structure=tree)
    points = np.array([(0.5, 0.25, 0.75), (1.25, 0.25, 0.4)])
    index, weight = probe_weights(probes, points)
    assert set(index[0]) == set(range(8))
    assert set(index[1]) == set(range(8, 16))
    np.testing.assert_allclose(weight.sum(axis=1), 1.0)
    expected = points @ (1.0, 2.0, 4.0) + 10.0
    np.testing.assert_allclose(interpolate(probes, points)[:, 0, 0], expected, rtol=1e-6)


def test_missing_corners_of_an_octree_leave_their_share_to_the_others():
    corner = np.array([(i & 1, i >> 1 & 1, i >> 2 & 1) for i in range(8)], np.float32)
    corners = np.arange(8, dtype=np.uint32)[None]
    corners[0, 1:] = NO_PROBE
    tree = ProbeOctree(np.zeros(3, np.float32), 1.0, np.zeros((1, 4), np.int32), corners)
    probes = blank_probes(corner[:1], coefficients=ramp(corner[:1]), structure=tree)
    point = np.array([(0.9, 0.9, 0.9)])
    np.testing.assert_allclose(interpolate(probes, point)[0, 0, 0], 10.0, rtol=1e-6)


def test_loose_probes_are_exact_where_they_stand_and_continuous_between():
    positions = np.random.default_rng(6).uniform(0, 1, (60, 3)).astype(np.float32)
    probes = blank_probes(positions, coefficients=ramp(positions))
    at = interpolate(probes, positions.astype(np.float64))[:, 0, 0]
    np.testing.assert_allclose(at, ramp(positions)[:, 0, 0], rtol=1e-4)
    line = np.linspace((0.1, 0.2, 0.3), (0.8, 0.7, 0.9), 4001)
    values = interpolate(probes, line)[:, 0, 0]
    assert np.abs(np.diff(values)).max() < 0.05


@pytest.fixture(scope="module")
def lit_and_dark(cpu_device) -> dict[str, ProbeSet]:
    """Probes of the two rooms, grids that fall differently on the wall, an octree and loose ones."""
    choices = ["grid:0.5", "grid:0.37", "grid:0.61", "random:400"]
    options = {text: ProbeOptions.parse(text, samples=64) for text in choices}
    options["auto"] = ProbeOptions("auto", count=500, samples=64)
    return {text: bake_probes(two_rooms(), None, None, option) for text, option in options.items()}


@pytest.mark.parametrize("placement", ["grid:0.5", "grid:0.37", "grid:0.61", "auto", "random:400"])
def test_light_does_not_come_through_a_thin_wall(lit_and_dark, placement):
    probes = lit_and_dark[placement]
    rng = np.random.default_rng(7)
    at = rng.uniform((0.02, 0.02, -0.98), (1.98, 1.98, 0.98), (3000, 3))
    at[:1000, 0] = 0.001  # on the dark side of the wall itself
    at[:, 0] += WALL_M / 2
    normals = rng.normal(size=at.shape)
    normals[:1000] = (1.0, 0.0, 0.0)
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    for which, on_surface in ((slice(1000), True), (slice(1000, None), False)):
        places, facing = at[which], normals[which]
        dark = irradiance_at(probes, places, facing, on_surface=on_surface)
        other_side = places * (-1.0, 1.0, 1.0), facing * (-1.0, 1.0, 1.0)
        lit = irradiance_at(probes, *other_side, on_surface=on_surface)
        assert lit.mean() > 1.0
        assert dark.mean() < 2e-4 * lit.mean()
        assert dark.max() < 1e-2 * lit.mean()


def test_plain_trilinear_would_leak_there(lit_and_dark):
    """So the scene does test what it claims to."""
    from irradia.bake.probes.neighbours import probes_around
    from irradia.core.sh import irradiance

    probes = lit_and_dark["grid:0.5"]
    at = np.array([(WALL_M / 2 + 0.05, 1.0, 0.0)])
    index, weight = probes_around(probes, at)
    series = np.einsum("qk,qkic->qic", weight, probes.coefficients[index])
    assert irradiance(series, np.array([(1.0, 0.0, 0.0)])).mean() > 0.1
