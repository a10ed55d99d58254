"""Where samples lie: by area, in free space, never inside anything."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from irradia.core.errors import InputError
from irradia.core.rng import Seed
from irradia.scene.builtin.rooms import DOOR_HEIGHT_M, DOOR_Z_M, HEIGHT_M, LENGTH_M, WALL_M, WIDTH_M
from irradia.scene.builtin.shapes import box, centred_box, floor, quad
from irradia.scene.merge import merge
from irradia.scene.types import Material

from ..lit_scenes import lit
from ..probes.places import scene_of

pytestmark = pytest.mark.usefixtures("cpu_device")

SEED = Seed(1)
ROOMS = np.array([(-LENGTH_M, 0.0, -WIDTH_M / 2), (LENGTH_M + WALL_M, HEIGHT_M, WIDTH_M / 2)])


def world_of(scene):
    from irradia.transport.world import World

    mesh = merge(scene)
    return World(scene, mesh), mesh


def on_surfaces(scene, n=4096, **options):
    from irradia.bake.datasets.placement import SurfacePlaces
    from irradia.bake.datasets.supply import Buffer

    return Buffer(SurfacePlaces(*world_of(scene), SEED, **options)).take(n)


def in_the_rooms(points) -> np.ndarray:
    """Whether points lie in either room or in the doorway between them."""
    x, y, z = points.T
    inside = ((points >= ROOMS[0]) & (points <= ROOMS[1])).all(axis=1)
    doorway = (y <= DOOR_HEIGHT_M) & (z >= DOOR_Z_M[0]) & (z <= DOOR_Z_M[1])
    return inside & ((x <= 0.0) | (x >= WALL_M) | doorway)


@pytest.mark.parametrize("stratified", [False, True])
def test_surfaces_get_points_by_their_area_and_evenly(stratified):
    small = quad((0.0, 0.0, 0.0), (0.0, 0.0, 1.0), (1.0, 0.0, 0.0))
    large = quad((5.0, 0.0, 0.0), (0.0, 0.0, 1.0), (3.0, 0.0, 0.0))
    places = on_surfaces(scene_of(small, large), 4000, stratified=stratified)
    x, z = places.positions[:, 0], places.positions[:, 2]
    assert (x < 2.0).mean() == pytest.approx(0.25, abs=0.02)
    cells, *_ = np.histogram2d(x[x > 2.0], z[x > 2.0], bins=(6, 2), range=((5, 8), (0, 1)))
    chi2 = float(((cells - cells.mean()) ** 2).sum() / cells.mean())
    assert chi2 < (3.0 if stratified else 31.3)  # 0.1 % of independent points lie above the latter
    np.testing.assert_allclose(places.normals, np.tile((0.0, 1.0, 0.0), (4000, 1)), atol=1e-6)


def test_double_sided_surfaces_get_points_on_both_sides_and_unlit_ones_none():
    scene = scene_of(floor(1.0, 1.0), floor(1.0, 1.0, y=2.0))
    two_sided = replace(scene.materials[0], double_sided=True)
    unlit = Material("sign", unlit=True)
    scene = replace(
        scene,
        materials=(two_sided, unlit),
        primitives=(scene.primitives[0], replace(scene.primitives[1], material=1)),
    )
    places = on_surfaces(scene)
    assert np.abs(places.positions[:, 1]).max() < 1e-6
    assert (places.normals[:, 1] > 0.0).mean() == pytest.approx(0.5, abs=0.03)
    np.testing.assert_array_equal(np.sign(places.origins[:, 1]), np.sign(places.normals[:, 1]))


def test_what_alpha_cuts_out_gets_no_points():
    scene = scene_of(floor(1.0, 1.0))
    ghost = Material("ghost", base_color=(1.0, 1.0, 1.0, 0.2), alpha_mode="mask")
    with pytest.raises(InputError, match="free space"):
        on_surfaces(replace(scene, materials=(ghost,)))


def test_surfaces_inside_solids_get_no_points():
    """A block sunk into another by half: of its six sides, the lower halves are hidden."""
    scene = scene_of(box((-4, -1, -4), (4, 0, 4)), centred_box((1, 1, 1)))
    places = on_surfaces(scene, 20_000)
    x, y, z = places.positions.T
    assert not ((np.abs(x) < 0.49) & (np.abs(z) < 0.49) & (y < 0.01) & (y > -0.99)).any()
    assert ((np.abs(x) <= 0.5) & (np.abs(z) <= 0.5) & (y > 0.01)).any()


def test_free_points_lie_in_free_space_evenly_under_any_normal():
    from irradia.bake.datasets.placement import random_free_places

    world, _ = world_of(lit("rooms"))
    places = random_free_places(world, ROOMS, 4000, SEED)
    assert in_the_rooms(places.positions).all()
    assert (places.positions[:, 0] < 0.0).mean() == pytest.approx(0.5, abs=0.03)
    assert np.abs(places.normals.mean(axis=0)).max() < 0.05
    np.testing.assert_allclose(np.linalg.norm(places.normals, axis=1), 1.0, atol=1e-6)
    around = random_free_places(world, ROOMS + np.array([[-1.0], [1.0]]), 2000, SEED).positions
    walls = (np.abs(around[:, 0] - WALL_M / 2) < 0.049) & (np.abs(around[:, 2]) < 1.7) & ~in_the_rooms(around)
    assert not (walls & (around[:, 1] > 0.0) & (around[:, 1] < HEIGHT_M)).any()


def test_lattice_gives_each_free_site_once_from_all_over_the_box():
    from irradia.bake.datasets.placement import LatticePlaces
    from irradia.bake.datasets.supply import Buffer

    world, _ = world_of(lit("rooms"))
    places = Buffer(LatticePlaces(world, ROOMS, 0.25)).take(10_000).positions
    sites = np.unique(np.round(places / 1e-3).astype(int), axis=0)
    assert len(sites) == len(places)
    assert in_the_rooms(places).all()
    assert 0.97 * 32 * 14 * 10 < len(places) < 32 * 14 * 10  # some sites lie in furniture
    np.testing.assert_allclose(places[:200].mean(axis=0), places.mean(axis=0), atol=0.25)


def test_places_do_not_depend_on_how_many_are_asked_for_at_once():
    from irradia.bake.datasets.placement import FreePlaces, SurfacePlaces
    from irradia.bake.datasets.supply import MixedPlaces, batches

    world, mesh = world_of(lit("rooms"))

    def mixed(size: int) -> np.ndarray:
        free, surface = FreePlaces(world, ROOMS, SEED), SurfacePlaces(world, mesh, SEED, within=ROOMS)
        parts = batches(MixedPlaces(free, surface, 0.2, SEED), size, 5000)
        return np.concatenate([part.positions for part in parts])

    np.testing.assert_array_equal(mixed(700), mixed(5000))


def test_a_fifth_of_a_mixture_lies_on_surfaces():
    from irradia.bake.datasets.nearest import NearestSurface
    from irradia.bake.datasets.placement import FreePlaces, SurfacePlaces
    from irradia.bake.datasets.supply import Buffer, MixedPlaces

    world, mesh = world_of(lit("rooms"))
    free, surface = FreePlaces(world, ROOMS, SEED), SurfacePlaces(world, mesh, SEED, within=ROOMS)
    places = Buffer(MixedPlaces(free, surface, 0.2, SEED)).take(5000)
    on_surface = NearestSurface(mesh).distance_m(places.positions) < 1e-5
    assert on_surface.mean() == pytest.approx(0.2, abs=0.02)
    assert in_the_rooms(places.positions[~on_surface]).all()
