"""The device finds sub-samples where the host's reference does."""

from __future__ import annotations

import numpy as np
import pytest

from irradia.bake.rasterise import rasterise
from irradia.core.progress import silent_progress
from irradia.scene.lightmap_uv import LayoutOptions, layout_lightmap
from irradia.scene.load import load_scene
from irradia.scene.merge import merge
from irradia.transport.subsample_set import SUBSAMPLES, weights_at

RESOLUTION = 160


@pytest.fixture(scope="module")
def objects_on_a_page(cpu_device):
    """Cones and spheres of a few texels each: slivers, shared texels and whole ones."""
    from irradia.transport.subsamples import Subsamples
    from irradia.transport.world import World

    scene = load_scene("builtin:foliage")
    layout = layout_lightmap(scene, LayoutOptions(resolution=RESOLUTION), silent_progress())
    mesh = merge(scene, layout)
    texels = rasterise(mesh, layout)
    world = World(scene, mesh, (layout.width_px, layout.height_px))

    def upload() -> Subsamples:
        return Subsamples(world, texels.pixel, texels.samples)

    return mesh, texels, upload


def fetch(subsamples, number: int) -> tuple[np.ndarray, np.ndarray]:
    """Triangle (N,) and weights (N, 3) of every texel's sub-sample of that number."""
    from irradia.transport.backend import dr, mi

    triangle, bary = subsamples.fetch(dr.arange(mi.UInt32, subsamples.n_texels), mi.UInt32(number))
    second, third = np.array(bary)
    return np.array(triangle), np.stack([1.0 - second - third, second, third], axis=-1)


def test_device_finds_the_places_of_the_reference(objects_on_a_page):
    mesh, texels, upload = objects_on_a_page
    subsamples = upload()
    triangles, weights = texels.locate(mesh)
    for number in range(SUBSAMPLES):
        triangle, found = fetch(subsamples, number)
        assert np.array_equal(triangle, triangles[:, number])
        corners = RESOLUTION * mesh.lightmap_uv[mesh.indices[triangle]].astype(np.float64)
        apart = np.einsum("nk,nkc->nc", found - weights[:, number], corners)
        assert np.abs(apart).max() < 1e-3


def test_a_copy_changes_that_sub_sample_alone(objects_on_a_page):
    from irradia.transport.backend import mi

    _, texels, upload = objects_on_a_page
    chosen = np.arange(0, len(texels.pixel), 3, dtype=np.uint32)
    subsamples = upload()
    before = [fetch(subsamples, number) for number in range(SUBSAMPLES)]
    subsamples.copy(mi.UInt32(chosen), mi.UInt32(6), mi.UInt32(3))
    after = [fetch(subsamples, number) for number in range(SUBSAMPLES)]
    before[3][0][chosen], before[3][1][chosen] = before[6][0][chosen], before[6][1][chosen]
    for (triangle, weights), (old_triangle, old_weights) in zip(after, before, strict=True):
        assert np.array_equal(triangle, old_triangle)
        assert np.array_equal(weights, old_weights)


def test_a_moved_texel_has_the_chosen_places_of_the_other(objects_on_a_page):
    from irradia.transport.backend import mi

    _, texels, upload = objects_on_a_page
    moved = np.arange(0, len(texels.pixel) - 1, 2, dtype=np.uint32)
    other = len(texels.pixel) - 1 - moved - (len(texels.pixel) % 2)
    order = [5, 5, 0, 1, 2, 7, 6, 3]
    subsamples = upload()
    before = [fetch(subsamples, number) for number in range(SUBSAMPLES)]
    subsamples.move(mi.UInt32(moved), mi.UInt32(other), [mi.UInt32(number) for number in order])
    kept = np.setdiff1d(np.arange(len(texels.pixel)), moved)
    for number, source in enumerate(order):
        after = fetch(subsamples, number)
        for found, own, others in zip(after, before[number], before[source], strict=True):
            assert np.array_equal(found[moved], others[other])
            assert np.array_equal(found[kept], own[kept])


def test_what_changes_on_the_device_stays_as_it_was_on_the_host(objects_on_a_page):
    from irradia.transport.backend import mi

    _, texels, upload = objects_on_a_page
    kept = texels.pixel.copy(), texels.samples.code.copy(), texels.samples.first.copy()
    subsamples = upload()
    subsamples.copy(mi.UInt32([0, 1, 2]), mi.UInt32(5), mi.UInt32(0))
    subsamples.move(mi.UInt32([3, 4]), mi.UInt32([7, 8]), [mi.UInt32(1)] * SUBSAMPLES)
    for before, after in zip(kept, (texels.pixel, texels.samples.code, texels.samples.first), strict=True):
        assert np.array_equal(before, after)


def test_a_point_outside_takes_the_nearest_of_the_triangle():
    triangle = np.array([[0.0, 0.0], [4.0, 0.0], [0.0, 2.0]])
    points = np.array([[1.0, -3.0], [-2.0, 1.0], [-1.0, -1.0], [3.0, 2.5]])
    nearest = np.array([[1.0, 0.0], [0.0, 1.0], [0.0, 0.0], [2.2, 0.9]])
    weights = weights_at(points, np.broadcast_to(triangle, (4, 3, 2)))
    np.testing.assert_allclose(weights @ triangle, nearest, atol=1e-12)


def test_a_triangle_without_area_has_places_along_its_longest_edge():
    line = np.array([[0.0, 0.0], [4.0, 0.0], [1.0, 0.0]])
    weights = weights_at(np.array([[3.0, 1.0], [9.0, 1.0]]), np.broadcast_to(line, (2, 3, 2)))
    np.testing.assert_allclose(weights @ line, [[3.0, 0.0], [4.0, 0.0]], atol=1e-12)
