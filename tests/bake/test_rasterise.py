"""Laws of the texel list: nothing touched is missed, and every sample lies where it says."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from irradia.bake.rasterise import rasterise, warm_up
from irradia.bake.texels import SUBSAMPLES, TexelSet
from irradia.scene.merge import MergedMesh

SIZE = 64


def random_triangles(n: int, reach: float, seed: int = 5) -> np.ndarray:
    rng = np.random.default_rng(seed)
    centre = rng.uniform(reach, SIZE - reach, (n, 1, 2))
    return centre + rng.uniform(-reach, reach, (n, 3, 2))


def points_in(triangles: np.ndarray, n: int, seed: int = 6) -> tuple[np.ndarray, np.ndarray]:
    """Points inside each triangle, dense, with some close to its edges; and their triangle."""
    rng = np.random.default_rng(seed)
    weights = rng.dirichlet((0.4, 0.4, 0.4), (len(triangles), n))
    points = np.einsum("tnk,tkc->tnc", weights, triangles).reshape(-1, 2)
    return points, np.repeat(np.arange(len(triangles)), n)


def sample_positions(texels: TexelSet, mesh: MergedMesh) -> np.ndarray:
    """(N, SUBSAMPLES, 2) where on the page the sub-samples' weights put them."""
    triangle, weights = texels.locate(mesh)
    return np.einsum("nsk,nskc->nsc", weights, SIZE * mesh.lightmap_uv[mesh.indices[triangle]])


def triangles_of(texels: TexelSet) -> np.ndarray:
    """(N, SUBSAMPLES) the triangle under each sub-sample."""
    return texels.samples.unpack()[0]


def grid_triangles(n: int, low: float, high: float, turn_rad: float) -> np.ndarray:
    """A turned square of n × n quads, two triangles each."""
    ticks = np.linspace(low, high, n + 1) - SIZE / 2
    x, y = np.meshgrid(ticks, ticks)
    cos, sin = np.cos(turn_rad), np.sin(turn_rad)
    points = np.stack([cos * x - sin * y, sin * x + cos * y], -1) + SIZE / 2
    a, b, c, d = points[:-1, :-1], points[:-1, 1:], points[1:, 1:], points[1:, :-1]
    return np.stack([np.stack([a, b, c], 2), np.stack([a, c, d], 2)], 2).reshape(-1, 3, 2)


@pytest.mark.parametrize("reach", [0.3, 2.0, 25.0])
def test_every_texel_that_holds_a_point_of_a_triangle_is_listed(page_mesh, reach):
    triangles = random_triangles(60, reach)
    texels = rasterise(*page_mesh(triangles, SIZE))
    points, _ = points_in(triangles, 3000)
    # Points within a snapping step of a texel border may lie on either side of it.
    clear = np.all(np.abs(points - np.rint(points)) > 1e-4, axis=1)
    x, y = np.floor(points[clear]).astype(int).T
    assert np.isin(y * SIZE + x, texels.pixel).all()


def test_no_texel_is_listed_that_no_triangle_touches(page_mesh):
    triangles = random_triangles(40, 6.0)
    texels = rasterise(*page_mesh(triangles, SIZE))
    listed = set(texels.pixel.tolist())
    points, _ = points_in(triangles, 60_000)
    x, y = np.floor(points).astype(int).T
    seen = set((y * SIZE + x).tolist())
    # What the dense points did not find must be corners that are hardly touched.
    missed = np.isin(texels.pixel, list(listed - seen))
    assert texels.coverage[missed].max(initial=0.0) < 0.01


def test_the_list_ascends_and_names_no_texel_twice(page_mesh):
    texels = rasterise(*page_mesh(random_triangles(50, 10.0), SIZE))
    assert (np.diff(texels.pixel.astype(np.int64)) > 0).all()


@pytest.mark.parametrize("reach", [0.3, 2.0, 25.0])
def test_every_sample_maps_back_into_its_texel(page_mesh, reach):
    mesh, layout = page_mesh(random_triangles(60, reach), SIZE)
    texels = rasterise(mesh, layout)
    corner = np.stack([texels.pixel % SIZE, texels.pixel // SIZE], -1)[:, None]
    offset = sample_positions(texels, mesh) - corner
    # Slivers are sampled to the nearest 64th of a texel.
    assert offset.min() > -1 / 64
    assert offset.max() < 1 + 1 / 64


def test_samples_of_a_full_texel_stand_in_eight_rows_and_columns(page_mesh):
    square = np.array([[[8, 8], [40, 8], [40, 40]], [[8, 8], [40, 40], [8, 40]]], float)
    mesh, layout = page_mesh(square, SIZE)
    texels = rasterise(mesh, layout)
    corner = np.stack([texels.pixel % SIZE, texels.pixel // SIZE], -1)[:, None]
    inside = sample_positions(texels, mesh) - corner
    for axis in range(2):
        steps = np.sort(np.floor(inside[..., axis] * SUBSAMPLES), axis=1)
        assert (steps == np.arange(SUBSAMPLES)).all()


def test_coverage_is_the_share_of_the_square(page_mesh):
    # The right edge halves column 20, the bottom edge leaves a quarter of row 30.
    corners = np.array([[[10, 10], [20.5, 10], [20.5, 30.25]], [[10, 10], [20.5, 30.25], [10, 30.25]]])
    texels = rasterise(*page_mesh(corners, SIZE))
    x, y = texels.pixel % SIZE, texels.pixel // SIZE
    assert texels.coverage[(x == 20) & (y == 15)] == pytest.approx(0.5, abs=1e-4)
    assert texels.coverage[(x == 12) & (y == 30)] == pytest.approx(0.25, abs=1e-4)
    assert texels.coverage[(x == 15) & (y == 15)] == pytest.approx(1.0, abs=1e-4)
    assert texels.coverage.sum() == pytest.approx(10.5 * 20.25, rel=1e-4)


def test_an_edge_on_the_texel_grid_touches_no_further_texel(page_mesh):
    corners = np.array([[[8, 8], [12, 8], [12, 12]], [[8, 8], [12, 12], [8, 12]]], float)
    texels = rasterise(*page_mesh(corners, SIZE))
    assert len(texels.pixel) == 16
    assert texels.coverage.min() == 1.0


@pytest.mark.parametrize("turn_rad", [0.0, 0.3, np.pi / 4])
def test_each_sample_of_a_tiled_square_has_one_triangle(page_mesh, turn_rad):
    # Grid lines pass exactly through sub-samples where the square is not turned.
    triangles = grid_triangles(32, 16.0625, 48.0625, turn_rad)
    mesh, layout = page_mesh(triangles, SIZE)
    forward = rasterise(mesh, layout)
    backward = rasterise(*page_mesh(triangles[::-1].copy(), SIZE))
    # If two triangles claimed a sample, the order would decide; if none did, samples would be repeated.
    full = forward.coverage > 0.9999
    assert full.sum() > 800
    mirrored = len(triangles) - 1 - triangles_of(backward)[full].astype(int)
    assert np.array_equal(mirrored, triangles_of(forward)[full])
    position = sample_positions(forward, mesh)[full]
    assert len(np.unique(position[0].round(3), axis=0)) == SUBSAMPLES


def test_a_mirrored_triangle_is_sampled_like_its_twin(page_mesh):
    triangle = np.array([[[5.2, 6.1], [30.7, 9.3], [14.4, 28.8]]])
    turned = triangle[:, [0, 2, 1]]
    meshes = page_mesh(triangle, SIZE), page_mesh(turned, SIZE)
    plain, mirrored = (rasterise(*mesh) for mesh in meshes)
    assert np.array_equal(plain.pixel, mirrored.pixel)
    weights, turned_weights = plain.locate(meshes[0][0])[1], mirrored.locate(meshes[1][0])[1]
    assert np.allclose(weights, turned_weights[..., [0, 2, 1]])


def test_a_sliver_between_sub_samples_is_sampled_nearest_to_the_centre(page_mesh):
    sliver = np.array([[[10.0, 10.96], [20.0, 10.96], [20.0, 10.97]]])
    mesh, layout = page_mesh(sliver, SIZE)
    texels = rasterise(mesh, layout)
    assert np.array_equal(texels.pixel, 10 * SIZE + np.arange(10, 20))
    position = sample_positions(texels, mesh)[5, 0]
    assert position == pytest.approx([15.5, 10.96], abs=2e-3)
    assert (texels.coverage > 0).all()


def test_triangles_without_area_on_the_page_still_have_texels(page_mesh):
    point, line = [[5.5, 5.5]] * 3, [[20.2, 7.5], [23.8, 7.5], [22.0, 7.5]]
    mesh, layout = page_mesh(np.array([point, line]), SIZE)
    texels = rasterise(mesh, layout)
    assert texels.pixel.tolist() == [5 * SIZE + 5, *(7 * SIZE + np.arange(20, 24))]
    x, y = sample_positions(texels, mesh)[1:, 0].T
    assert y == pytest.approx(7.5, abs=1e-4)
    assert x == pytest.approx([20.5, 21.5, 22.5, 23.5], abs=0.01)


def test_a_texel_that_two_charts_touch_belongs_to_the_larger_share(page_mesh):
    def square(x0: float, x1: float) -> list:
        return [[[x0, 4], [x1, 4], [x1, 9]], [[x0, 4], [x1, 9], [x0, 9]]]

    corners = np.array(square(4, 10.25) + square(10.25, 16))
    chart = np.array([0, 0, 1, 1])
    texels = rasterise(*page_mesh(corners, SIZE, chart=chart))
    shared = texels.pixel % SIZE == 10
    assert (texels.chart[shared] == 1).all()
    assert (chart[triangles_of(texels)] == texels.chart[:, None]).all()
    assert texels.coverage[shared] == pytest.approx(0.75, abs=1e-4)


def test_among_overlapping_triangles_the_lowest_number_wins(page_mesh):
    triangle = np.array([[10.0, 10.0], [30.0, 10.0], [10.0, 30.0]])
    texels = rasterise(*page_mesh(np.stack([triangle, triangle]), SIZE))
    assert (triangles_of(texels) == 0).all()
    assert texels.coverage.max() == 1.0


def test_triangles_without_a_page_are_left_out(page_mesh):
    mesh, layout = page_mesh(random_triangles(10, 5.0), SIZE)
    page = mesh.page.copy()
    page[:5] = -1
    texels = rasterise(dataclasses.replace(mesh, page=page), layout)
    assert triangles_of(texels).min() == 5


def test_later_pages_follow_in_the_flat_index(page_mesh):
    triangles = random_triangles(10, 5.0)
    first = rasterise(*page_mesh(triangles, SIZE, n_pages=2, page=0))
    second = rasterise(*page_mesh(triangles, SIZE, n_pages=2, page=1))
    assert np.array_equal(second.pixel, first.pixel + SIZE * SIZE)


def test_a_scene_without_lightmapped_triangles_gives_an_empty_list(page_mesh):
    mesh, layout = page_mesh(random_triangles(3, 5.0), SIZE, page=-1)
    assert len(rasterise(mesh, layout).pixel) == 0


def test_one_and_two_threads_give_the_same_bytes(page_mesh):
    import numba

    arguments = page_mesh(random_triangles(300, 8.0), SIZE)
    before = numba.get_num_threads()
    try:
        numba.set_num_threads(1)
        alone = rasterise(*arguments)
        numba.set_num_threads(before)
        together = rasterise(*arguments)
    finally:
        numba.set_num_threads(before)
    for name in ("pixel", "coverage", "chart"):
        assert getattr(alone, name).tobytes() == getattr(together, name).tobytes()
    for name in ("code", "first", "triangle"):
        assert getattr(alone.samples, name).tobytes() == getattr(together.samples, name).tobytes()


def test_a_texel_lists_the_triangles_that_it_sees_and_no_others(page_mesh):
    mesh, layout = page_mesh(grid_triangles(24, 10.3, 40.7, 0.2), SIZE)
    texels = rasterise(mesh, layout)
    ends = np.append(texels.samples.first[1:], len(texels.samples.triangle))
    seen = triangles_of(texels)
    for first, end, here in zip(texels.samples.first, ends, seen, strict=True):
        assert sorted(texels.samples.triangle[first:end]) == sorted(set(here))


def test_taking_texels_takes_their_samples_along(page_mesh):
    mesh, layout = page_mesh(random_triangles(50, 10.0), SIZE)
    texels = rasterise(mesh, layout)
    chosen = np.arange(3, len(texels.pixel), 7)
    for whole, part in zip(texels.locate(mesh), texels.take(chosen).locate(mesh), strict=True):
        assert np.array_equal(whole[chosen], part)


def test_a_texel_keeps_its_samples_in_under_32_bytes(page_mesh):
    samples = rasterise(*page_mesh(grid_triangles(16, 4.0, 60.0, 0.0), SIZE)).samples
    kept = samples.code.nbytes + samples.first.nbytes + samples.triangle.nbytes
    assert kept < 32 * len(samples.first)


def test_warm_up_leaves_nothing_to_compile():
    from irradia.bake import raster_kernels

    warm_up()
    assert len(raster_kernels.resolve.signatures) == 1
    assert len(raster_kernels.touched_texels.signatures) == 1
