"""Seams: which edges are one in space, and that filtered light agrees on both sides afterwards."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from irradia.bake.dilate import add_rings, page_state
from irradia.bake.rasterise import rasterise
from irradia.bake.seam_points import SeamPoints, find_seam_points
from irradia.bake.seams import close_seams, seam_system
from irradia.bake.texels import TexelSet
from irradia.metrics.seam import seam_difference
from irradia.scene.layout import LightmapLayout
from irradia.scene.merge import MergedMesh

SIZE = 64


def quad(origin, along, across, page_px, size_px=(16, 16)) -> tuple[np.ndarray, np.ndarray]:
    """Corners in space (4, 3) and on the page (4, 2) of a parallelogram."""
    origin, along, across = (np.array(v, float) for v in (origin, along, across))
    x, y = page_px
    w, h = size_px
    world = np.array([origin, origin + along, origin + along + across, origin + across])
    return world, np.array([[x, y], [x + w, y], [x + w, y + h], [x, y + h]], float)


def mesh_of(*quads, normals=None) -> tuple[MergedMesh, LightmapLayout]:
    """Every quad is a chart and an instance of its own; flat normals unless given, (4, 3) each."""
    world = np.concatenate([q[0] for q in quads])
    px = np.concatenate([q[1] for q in quads])
    flat = [np.tile(np.cross(w[1] - w[0], w[3] - w[0]), (4, 1)) for w, _ in quads]
    normal = np.concatenate(flat if normals is None else normals)
    n = len(quads)
    mesh = MergedMesh(
        positions=world.astype(np.float32),
        normals=(normal / np.linalg.norm(normal, axis=1, keepdims=True)).astype(np.float32),
        texcoords=np.zeros((4 * n, 2, 2), np.float32),
        colors=np.ones((4 * n, 4), np.float32),
        lightmap_uv=(px / SIZE).astype(np.float32),
        indices=(np.array([[0, 1, 2], [0, 2, 3]])[None] + 4 * np.arange(n)[:, None, None])
        .reshape(-1, 3)
        .astype(np.uint32),
        material=np.zeros(2 * n, np.uint32),
        instance=np.repeat(np.arange(n), 2).astype(np.uint32),
        page=np.zeros(2 * n, np.int32),
        chart=np.repeat(np.arange(n), 2).astype(np.uint32),
    )
    layout = LightmapLayout(
        n_pages=1,
        width_px=SIZE,
        height_px=SIZE,
        unwraps=(),
        page=np.zeros(n, np.int32),
        scale=np.ones((n, 2), np.float32),
        offset=np.zeros((n, 2), np.float32),
        texels_per_metre=16.0,
    )
    return mesh, layout


def side_by_side() -> tuple[MergedMesh, LightmapLayout]:
    """Two squares in one plane that touch at x = 1."""
    return mesh_of(
        quad((0, 0, 0), (1, 0, 0), (0, 1, 0), (4, 4)), quad((1, 0, 0), (1, 0, 0), (0, 1, 0), (30, 4))
    )


def ringed(texels: TexelSet, values: np.ndarray) -> np.ndarray:
    pages = texels.to_pages(values.astype(np.float32))
    add_rings(pages, page_state(texels), 1)
    return pages


def closed(mesh, layout, values_of, **options) -> tuple[np.ndarray, np.ndarray, SeamPoints, TexelSet]:
    """Pages before and after."""
    points, texels = find_seam_points(mesh, layout), rasterise(mesh, layout)
    before = ringed(texels, values_of(texels))
    after = before.copy()
    close_seams(seam_system(points, texels, before, **options), after)
    return before, after, points, texels


def differences(pages: np.ndarray, points: SeamPoints) -> np.ndarray:
    return seam_difference(pages, points.page, points.position_px)


# ---- which edges are seams ----


def test_squares_that_touch_have_one_seam_and_their_free_edges_none():
    mesh, layout = side_by_side()
    points = find_seam_points(mesh, layout)
    assert points.weight.sum() == pytest.approx(32.0)  # sixteen texels, seen from both sides
    x = points.position_px[..., 0]
    assert set(np.unique(x)) == {20.0, 30.0}
    assert points.position_px[:, 0, 1] == pytest.approx(points.position_px[:, 1, 1])


def test_an_edge_matches_along_the_stretch_where_another_touches_it():
    mesh, layout = mesh_of(
        quad((0, 0, 0), (1, 0, 0), (0, 2, 0), (4, 4), (16, 32)),
        quad((1, 0.5, 0), (1, 0, 0), (0, 1, 0), (30, 4)),
    )
    points = find_seam_points(mesh, layout)
    y = points.position_px[points.chart[:, 0] == 0, 0, 1]
    assert y.min() == pytest.approx(12.0, abs=0.5)
    assert y.max() == pytest.approx(28.0, abs=0.5)
    other = points.position_px[points.chart[:, 0] == 0, 1, 1]
    assert other == pytest.approx(y - 8.0, abs=1e-3)


def test_a_crease_is_no_seam():
    mesh, layout = mesh_of(
        quad((0, 0, 0), (1, 0, 0), (0, 1, 0), (4, 4)), quad((1, 0, 0), (0, 0, -1), (0, 1, 0), (30, 4))
    )
    assert len(find_seam_points(mesh, layout)) == 0


def test_a_fold_with_shared_normals_is_a_seam():
    first = quad((0, 0, 0), (1, 0, 0), (0, 1, 0), (4, 4))
    second = quad((1, 0, 0), (0.8, 0, -0.6), (0, 1, 0), (30, 4))
    flat, folded, between = np.array([0, 0, 1.0]), np.array([0.6, 0, 0.8]), np.array([0.316, 0, 0.949])
    normals = [np.array([flat, between, between, flat]), np.array([between, folded, folded, between])]
    mesh, layout = mesh_of(first, second, normals=normals)
    assert find_seam_points(mesh, layout).weight.sum() == pytest.approx(32.0)


def test_a_sharp_fold_is_no_seam_even_with_shared_normals():
    between = np.tile([0.707, 0, 0.707], (4, 1))
    mesh, layout = mesh_of(
        quad((0, 0, 0), (1, 0, 0), (0, 1, 0), (4, 4)),
        quad((1, 0, 0), (0, 0, -1), (0, 1, 0), (30, 4)),
        normals=[between, between],
    )
    assert len(find_seam_points(mesh, layout)) == 0


def test_squares_one_upon_the_other_have_no_seam():
    square = ((0, 0, 0), (1, 0, 0), (0, 1, 0))
    mesh, layout = mesh_of(quad(*square, (4, 4)), quad(*square, (30, 4)))
    assert len(find_seam_points(mesh, layout)) == 0


def test_edges_farther_apart_than_the_tolerance_are_no_seam():
    gap = 1.0 + 0.5 / 16  # half a texel
    mesh, layout = mesh_of(
        quad((0, 0, 0), (1, 0, 0), (0, 1, 0), (4, 4)), quad((gap, 0, 0), (1, 0, 0), (0, 1, 0), (30, 4))
    )
    assert len(find_seam_points(mesh, layout)) == 0


def test_charts_that_touch_on_the_page_too_need_no_closing():
    mesh, layout = mesh_of(
        quad((0, 0, 0), (1, 0, 0), (0, 1, 0), (4, 4)), quad((1, 0, 0), (1, 0, 0), (0, 1, 0), (20, 4))
    )
    assert len(find_seam_points(mesh, layout)) == 0


def test_levels_of_detail_of_one_object_share_no_seam():
    mesh, layout = side_by_side()
    mesh = replace(mesh, lod=np.array([256, 256, 257, 257], np.uint32))
    assert len(find_seam_points(mesh, layout)) == 0


def test_a_scene_without_lightmap_has_no_seams():
    mesh, layout = side_by_side()
    assert len(find_seam_points(replace(mesh, page=np.full(4, -1, np.int32)), layout)) == 0


# ---- closing them ----


def offset_and_noise(texels: TexelSet) -> np.ndarray:
    """The second square is a tenth brighter; both are noisy, colours apart."""
    noise = np.random.default_rng(5).normal(1.0, 0.05, (len(texels.pixel), 3))
    return np.where(texels.chart[:, None] == 0, 1.0, 1.1) * noise


def test_filtered_light_agrees_on_both_sides():
    before, after, points, _ = closed(*side_by_side(), offset_and_noise)
    assert differences(before, points).max() > 0.1
    assert differences(after, points).max() < 5e-3


def test_dark_places_are_closed_like_bright_ones():
    def dim_end(texels: TexelSet) -> np.ndarray:
        y = texels.pixel // SIZE
        return offset_and_noise(texels) * np.where(y < 12, 1.0, 0.02)[:, None]

    before, after, points, _ = closed(*side_by_side(), dim_end)
    dark = points.position_px[:, 0, 1] > 13.0
    mean = before[before > 0].mean()
    assert differences(after, points)[dark].max() < 5e-3
    assert before[0, 14:19, 6:18].max() < 0.1 * mean


def test_texels_away_from_seams_keep_their_bits():
    before, after, _, texels = closed(*side_by_side(), offset_and_noise)
    x = texels.pixel % SIZE
    far = (x < 20 - 7) | (x >= 30 + 7)
    changed = (before != after).any(axis=-1).ravel()[texels.pixel]
    assert not changed[far].any()
    assert changed[~far].any()


def test_a_seam_without_difference_changes_nothing():
    before, after, _, _ = closed(*side_by_side(), lambda texels: np.full((len(texels.pixel), 3), 2.0))
    assert after == pytest.approx(before, rel=1e-6)


def test_the_pair_keeps_its_mean():
    before, after, _, _ = closed(*side_by_side(), offset_and_noise)
    assert after.mean() == pytest.approx(before.mean(), rel=5e-3)


def test_light_does_not_pass_under_a_wall_that_stands_on_the_seam():
    _, after, _, texels = closed(
        *side_by_side(), lambda texels: np.where(texels.chart[:, None] == 0, 0.0, 1.0) * np.ones(3)
    )
    assert not after.reshape(-1, 3)[texels.pixel[texels.chart == 0]].any()


def test_a_side_without_valid_texels_moves_nothing():
    mesh, layout = side_by_side()
    valid = rasterise(mesh, layout).chart == 0
    before, after, _, _ = closed(mesh, layout, offset_and_noise, valid=valid)
    assert np.array_equal(before, after)


def test_a_change_stays_in_its_region():
    mesh, layout = side_by_side()
    texels = rasterise(mesh, layout)
    x = texels.pixel % SIZE
    behind = (texels.chart == 0) & (x < 18)
    region = np.where(behind, 7, texels.chart).astype(np.uint32)
    before, after, _, _ = closed(mesh, layout, offset_and_noise, region=region)
    changed = (before != after).any(axis=-1).ravel()[texels.pixel]
    assert not changed[behind].any()
    assert changed[(texels.chart == 0) & ~behind].any()


def test_irradiance_stays_non_negative():
    def spikes(texels: TexelSet) -> np.ndarray:
        rng = np.random.default_rng(8)
        return rng.exponential(1.0, (len(texels.pixel), 3)) ** 3

    before, after, _, _ = closed(*side_by_side(), spikes)
    assert after.min() >= 0.0
    assert not np.array_equal(before, after)


def test_signed_maps_of_any_number_of_channels_close_with_the_irradiance():
    mesh, layout = side_by_side()
    points, texels = find_seam_points(mesh, layout), rasterise(mesh, layout)
    system = seam_system(points, texels, ringed(texels, np.ones((len(texels.pixel), 3))))
    signed = ringed(texels, np.random.default_rng(1).normal(-0.5, 0.1, (len(texels.pixel), 9)))
    after = signed.copy()
    close_seams(system, after, lowest=None)
    jump = np.abs(after[0, 4:20, 19:21].mean(axis=1) - after[0, 4:20, 29:31].mean(axis=1))
    jump_before = np.abs(signed[0, 4:20, 19:21].mean(axis=1) - signed[0, 4:20, 29:31].mean(axis=1))
    assert jump[1:-1].max() < 0.1 * jump_before.max()
    assert after.min() < -0.3


def test_the_same_map_gives_the_same_bytes():
    one, other = (closed(*side_by_side(), offset_and_noise)[1].tobytes() for _ in range(2))
    assert one == other


def test_black_maps_stay_black():
    _, after, _, _ = closed(*side_by_side(), lambda texels: np.zeros((len(texels.pixel), 3)))
    assert not after.any()
