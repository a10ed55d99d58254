"""What texels pass on: all their light, whatever the noise, but none of it into closed rooms."""

from __future__ import annotations

import functools

import numpy as np
import pytest
from numpy.typing import NDArray

from irradia.bake.lightmap import BakeOptions, LightmapBake, start_bake
from irradia.core import silent_progress
from irradia.scene.builtin.builder import SceneBuilder
from irradia.scene.builtin.matte import matte
from irradia.scene.builtin.mesh import Mesh, join
from irradia.scene.builtin.shapes import box, floor
from irradia.scene.gltf.to_scene import document_to_scene
from irradia.scene.lightmap_uv import LayoutOptions, layout_lightmap

pytestmark = pytest.mark.usefixtures("cpu_device")

FLOOR_M, WALL_M = 4.0, 0.02
LOW, HIGH = np.array((-0.985, -0.1, -1.01)), np.array((1.005, 1.0, 1.03))  # of the room, inside
RAYS = 64


@functools.cache
def _bake(name: str) -> LightmapBake:
    """A set-up bake of a floor with something on it; its own light doesn't matter."""
    scene = SceneBuilder(name)
    white = scene.material(matte("white", (0.7, 0.7, 0.7)))
    scene.object("floor", (floor(FLOOR_M, FLOOR_M), white))
    scene.object(name, (_comb() if name == "comb" else _room(), white))
    scene.environment_color((1.0, 1.0, 1.0))
    scene = document_to_scene(scene.build())
    layout = layout_lightmap(scene, LayoutOptions(resolution=96, use_cache=False), silent_progress())
    return start_bake(scene, layout, BakeOptions(samples=8, denoise=False))


def _comb() -> Mesh:
    """Walls thinner than a texel, open to all sides."""
    places = np.arange(-1.73, 1.9, 0.41)
    return join(*(box((x - 0.01, -0.2, -1.9), (x + 0.01, 0.6, 1.9)) for x in places))


def _room() -> Mesh:
    """A closed room that stands on the floor."""
    return join(box(LOW - WALL_M, HIGH + WALL_M), box(LOW, HIGH).inside_out())


def _gathered(bake: LightmapBake, light: NDArray[np.float64]) -> NDArray[np.float64]:
    """(N,) what the texels receive from surfaces with this much light (N,) on them, of RAYS rays each."""
    from irradia.transport.backend import mi
    from irradia.transport.texel_light import Draw

    texels = bake.light
    arriving = mi.Color3f(*[mi.Float(light.astype(np.float32))] * 3)
    cache = texels.cache(arriving, texels.reflectance())
    every = texels.lanes(np.flatnonzero(bake.valid).astype(np.uint32))
    sums = texels.add_rays(texels.empty_sums(), every, Draw(RAYS, 0, 1, 2), cache)
    return texels.to_host(sums.mean())[:, 0].astype(np.float64)


def _inside(bake: LightmapBake) -> NDArray[np.bool_]:
    """(N,) which texels lie in the room."""
    from irradia.transport.backend import dr, mi

    texels = bake.light
    every = dr.arange(mi.UInt32, texels.n_texels)
    place = np.array(texels.subsamples.point(texels.world, every, dr.opaque(mi.UInt32, 0)).position).T
    return ((place > LOW - 1e-3) & (place < HIGH + 1e-3)).all(axis=1)


def test_noisy_maps_pass_on_as_much_light_as_clean_ones():
    bake = _bake("comb")
    n = bake.light.n_texels
    sky = _gathered(bake, np.zeros(n))
    clean = (_gathered(bake, np.ones(n)) - sky).sum()
    rng = np.random.default_rng(3)
    noisy = [(_gathered(bake, 4.0 * (rng.random(n) < 0.25)) - sky).sum() for _ in range(8)]
    assert (bake.footprints.behind != np.arange(n)).sum() > 100
    assert np.mean(noisy) == pytest.approx(clean, rel=0.01)


def test_no_light_of_texels_that_a_closed_room_shares_gets_in():
    bake = _bake("room")
    inside = _inside(bake)
    received = _gathered(bake, np.where(inside, 0.0, 1.0))
    assert (bake.valid & inside).sum() > 100
    assert (received[bake.valid & inside] == 0.0).all()


def test_walls_of_closed_rooms_cost_those_outside_no_light():
    bake = _bake("room")
    inside = _inside(bake)
    others = np.arange(bake.light.n_texels)
    outside = bake.valid & ~inside
    everything = _gathered(bake, np.ones(len(others)))
    received = _gathered(bake, np.where(inside, 0.0, 1.0))
    for standing_inside in (True, False):  # the texels that the room shares with the outside
        assert (inside == standing_inside)[bake.footprints.behind != others].any()
    assert np.array_equal(received[outside], everything[outside])


def test_a_dim_room_sees_its_own_light_on_the_texels_that_it_shares():
    bake = _bake("room")
    inside = _inside(bake)
    dim = 1e-5
    received = _gathered(bake, np.where(inside, dim, 1.0))
    alone = _gathered(bake, np.full(len(inside), dim))
    there = bake.valid & inside
    assert received[there] == pytest.approx(alone[there], rel=1e-4)
