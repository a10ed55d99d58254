"""Laws of the quick charts of large meshes: little stretch, no overlap, nothing left out."""

from __future__ import annotations

import numpy as np
import pytest

from irradia.scene.lightmap_uv.blocks import block_charts, halved
from irradia.scene.lightmap_uv.charts import Charts, triangle_areas
from irradia.scene.lightmap_uv.overlap import overlapping_charts
from irradia.scene.lightmap_uv.projection import MIN_COSINE, projected_charts

Mesh = tuple[np.ndarray, np.ndarray]


def sheet(points: np.ndarray) -> Mesh:
    """Triangles over a (rows, columns, 3) grid, front where rows × columns points."""
    n_rows, n_columns = points.shape[:2]
    corner = np.arange(n_rows * n_columns).reshape(n_rows, n_columns)
    a, b, c, d = corner[:-1, :-1], corner[1:, :-1], corner[1:, 1:], corner[:-1, 1:]
    triangles = np.stack([np.stack([a, b, c], -1), np.stack([a, c, d], -1)], 2).reshape(-1, 3)
    return points.reshape(-1, 3).astype(np.float64), triangles.astype(np.uint32)


def hills(n: int = 100, steepness: float = 1.0) -> Mesh:
    z, x = np.meshgrid(np.linspace(0, 10, n), np.linspace(0, 14, n), indexing="ij")
    y = steepness * np.sin(1.1 * x) * np.cos(0.8 * z)
    return sheet(np.stack([x, y, z], -1))


def ball(n: int = 120) -> Mesh:
    theta, phi = np.meshgrid(np.linspace(0, np.pi, n), np.linspace(0, 2 * np.pi, n), indexing="ij")
    points = [np.sin(theta) * np.sin(phi), np.cos(theta), np.sin(theta) * np.cos(phi)]
    return sheet(np.stack(points, -1))


def ramp(turns: int = 4, n: int = 600) -> Mesh:
    """A spiral ramp: it faces up everywhere and lies over itself."""
    angle, radius = np.meshgrid(np.linspace(0, 2 * np.pi * turns, n), np.linspace(1, 3, 12), indexing="ij")
    return sheet(np.stack([radius * np.cos(angle), 0.3 * angle, -radius * np.sin(angle)], -1)[:, ::-1])


def check(mesh: Mesh, charts: Charts, smallest_share: float) -> None:
    """All triangles in their places, areas kept within the bound, no chart over itself."""
    positions, indices = mesh
    assert np.array_equal(charts.vertex_source[charts.indices], indices)
    world, flat = triangle_areas(positions, indices), triangle_areas(charts.uv, charts.indices)
    assert flat[charts.solid].sum() == pytest.approx(world[charts.solid].sum(), rel=1e-3)
    assert world[~charts.solid].sum() < 1e-6 * world.sum()
    ratio = (flat / np.maximum(world, 1e-30))[charts.solid]
    per_chart = (
        ratio
        / np.maximum.reduceat(
            ratio[np.argsort(charts.chart[charts.solid], kind="stable")],
            np.searchsorted(np.sort(charts.chart[charts.solid]), np.arange(charts.n_charts)),
        )[charts.chart[charts.solid]]
    )
    assert per_chart.min() > smallest_share
    corners = charts.uv[charts.indices].astype(np.float64)[charts.solid]
    assert not overlapping_charts(corners, charts.chart[charts.solid].astype(np.int64)).any()
    # Nothing is folded over: all triangles of a chart lie the same way up.
    up = np.linalg.det(corners[:, 1:] - corners[:, :1]) > 0
    ups, sizes = np.bincount(charts.chart[charts.solid], up), np.bincount(charts.chart[charts.solid])
    assert ((ups == 0) | (ups == sizes)).all()


def test_a_heightfield_is_one_chart_in_its_own_plan():
    mesh = hills()
    charts = projected_charts(*mesh)
    check(mesh, charts, MIN_COSINE)
    assert charts.n_charts == 1
    span = np.ptp(charts.uv, axis=0)
    assert span.max() / span.min() == pytest.approx(1.4, rel=1e-4)


def test_cliffs_get_charts_of_their_own():
    mesh = hills(200, steepness=6.0)
    charts = projected_charts(*mesh)
    check(mesh, charts, 0.25)
    assert 1 < charts.n_charts < 100


def test_a_ball_falls_into_a_few_caps():
    mesh = ball()
    charts = projected_charts(*mesh)
    check(mesh, charts, 0.25)
    assert charts.n_charts <= 8


def test_split_vertices_dont_split_charts():
    positions, indices = hills(60)
    apart = positions[indices].reshape(-1, 3), np.arange(indices.size, dtype=np.uint32).reshape(-1, 3)
    charts = projected_charts(*apart)
    check(apart, charts, MIN_COSINE)
    assert charts.n_charts == 1


def test_a_surface_that_lies_over_itself_is_cut_until_it_doesnt():
    mesh = ramp()
    charts = projected_charts(*mesh)
    check(mesh, charts, MIN_COSINE)
    assert charts.n_charts > 4


def test_triangles_without_area_stay_in_a_chart():
    positions, indices = hills(60)
    indices = np.concatenate([indices, [[5, 5, 9], [70, 70, 70]]]).astype(np.uint32)
    charts = projected_charts(positions, indices)
    check((positions, indices), charts, MIN_COSINE)
    assert charts.n_charts == 1
    assert charts.solid.sum() == len(indices) - 2


def rubble(n: int = 3000) -> Mesh:
    """Triangles that point everywhere."""
    corners = np.random.default_rng(5).normal(size=(n, 1, 3)) * 9 + np.random.default_rng(6).normal(
        size=(n, 3, 3)
    )
    return corners.reshape(-1, 3), np.arange(3 * n, dtype=np.uint32).reshape(-1, 3)


def test_what_is_too_rough_is_left_to_others():
    assert projected_charts(*rubble()) is None


def test_blocks_give_the_same_guarantees(monkeypatch):
    monkeypatch.setattr("irradia.scene.lightmap_uv.blocks._BLOCK", 3000)
    positions, indices = ball(70)
    charts = block_charts(positions, positions.astype(np.float32), indices)
    check((positions, indices), charts, 0.1)
    assert charts.n_charts > 4


def test_halving_keeps_every_point_once_and_groups_small():
    points = np.random.default_rng(7).normal(size=(1000, 3))
    groups = halved(points, 100)
    assert max(map(len, groups)) <= 100
    assert np.array_equal(np.sort(np.concatenate(groups)), np.arange(1000))


def test_large_meshes_take_the_quick_way(monkeypatch):
    from irradia.scene.lightmap_uv import unwrap

    monkeypatch.setattr(unwrap, "_LARGE", 1000)
    monkeypatch.setattr(unwrap, "xatlas_charts", None)  # would be called for small ones
    positions, indices = hills(40)
    assert unwrap._cut(positions, positions.astype(np.float32), indices).n_charts == 1
