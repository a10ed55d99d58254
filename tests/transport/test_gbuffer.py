"""Pictures under somebody's E: what is asked for, where, and that it adds up to what is path-traced."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from irradia.cli.lighting import LightOptions, light_scene
from irradia.scene.environment import environment_from_color
from irradia.scene.framing import look_at
from irradia.scene.load import load_scene
from irradia.scene.types import Camera, Light, Material

from .flat_scenes import BLACK, Sheet, matte, stacked

pytestmark = pytest.mark.usefixtures("cpu_device")

LAMP = Light("point", (3.0, 2.0, 1.0), position=(0.2, 1.0, 0.0))
SKY = environment_from_color((1.0, 2.0, 3.0))
EDGE_PX = 24


def _camera(height: float) -> Camera:
    return Camera(look_at(np.array([0.3, height, 0.2]), np.zeros(3)), np.radians(40.0), 1.0)


def _options(spp: int = 16):
    from irradia.transport.render import RenderOptions

    return RenderOptions(EDGE_PX, EDGE_PX, spp)


def _under(scene, irradiance, *, height: float = 2.0, spp: int = 16) -> np.ndarray:
    from irradia.transport.gbuffer import picture_under

    return picture_under(scene, _camera(height), _options(spp), irradiance)


def _traced(scene, *, height: float = 2.0, spp: int = 16) -> np.ndarray:
    from irradia.transport.render import render

    return render(scene, _camera(height), _options(spp))


def _even(*colour: float):
    """The same E everywhere."""
    return lambda positions, normals: np.tile(np.float32(colour), (len(positions), 1))


def _look(scene, height: float = 2.0):
    from irradia.transport.gbuffer import look

    bands = list(look(scene, _camera(height), _options()))
    assert len(bands) == 1
    return bands[0]


DARKNESS = _even(0.0, 0.0, 0.0)


def test_a_sheet_under_the_sky_is_its_reflectance_times_its_irradiance():
    scene = stacked([Sheet(matte(0.5))], environment=SKY)
    picture = _under(scene, _even(np.pi, 2 * np.pi, 3 * np.pi))
    np.testing.assert_allclose(picture, _traced(scene), rtol=1e-4)


def test_what_shines_and_the_backdrop_are_pixel_by_pixel_those_of_the_renderer():
    glowing = replace(BLACK, emission=(4.0, 2.0, 1.0))
    veil = Material("veil", base_color=(0, 0, 0, 0.3), metallic=0.0, specular=0.0, alpha_mode="blend")
    scene = stacked([Sheet(glowing, width=0.5), Sheet(veil, y=0.3, depth=0.4)], environment=SKY)
    np.testing.assert_allclose(_under(scene, DARKNESS), _traced(scene), rtol=1e-5)


def test_live_lights_are_added_and_baked_ones_left_to_the_field():
    live = stacked([Sheet(matte(0.6))], (replace(LAMP, mode="realtime"),))
    np.testing.assert_allclose(_under(live, DARKNESS), _traced(live), rtol=1e-4)
    assert _under(live, DARKNESS).max() > 0.1
    assert _under(stacked([Sheet(matte(0.6))], (LAMP,)), DARKNESS).max() == 0.0


def test_a_live_light_casts_shadows():
    roof = Sheet(BLACK, y=0.5, width=3.0, depth=3.0, up=False)
    shaded = stacked([Sheet(matte(0.6)), roof], (replace(LAMP, mode="mixed"),))
    assert _under(shaded, DARKNESS, height=0.4).max() == 0.0


def test_sky_and_shining_surfaces_light_nothing_by_themselves():
    """Their first bounce belongs to E."""
    panel = Sheet(replace(BLACK, emission=(5.0, 5.0, 5.0)), y=3.0, up=False)
    scene = stacked([Sheet(matte(0.6)), panel], environment=SKY)
    floor = _look(scene).other[EDGE_PX // 2, EDGE_PX // 2]
    np.testing.assert_array_equal(floor, 0.0)


def test_normals_are_turned_towards_the_eye_where_both_sides_are_seen():
    for double_sided, n_samples in ((True, 16 * EDGE_PX**2), (False, 0)):
        scene = stacked([Sheet(matte(0.5, double_sided=double_sided), width=9, depth=9)])
        seen = _look(scene, height=-2.0)
        assert len(seen.positions) == n_samples
        if n_samples:
            np.testing.assert_allclose(seen.normals, np.tile([0.0, -1.0, 0.0], (n_samples, 1)), atol=1e-6)
            np.testing.assert_allclose(seen.positions[:, 1], 0.0, atol=1e-6)


def test_light_behind_a_leaf_comes_through_it():
    leaf = matte(0.8, diffuse_transmission=0.25, diffuse_transmission_color=(0.4, 0.4, 0.4))
    seen = _look(stacked([Sheet(leaf, width=9, depth=9)]))

    def from_below(positions: np.ndarray, normals: np.ndarray) -> np.ndarray:
        return np.where(normals[:, 1:2] < 0.0, np.float32([np.pi] * 3), np.float32(0.0))

    np.testing.assert_allclose(seen.lit_by(from_below), 0.25 * 0.4, rtol=1e-4)
    np.testing.assert_allclose(seen.lit_by(_even(np.pi, np.pi, np.pi)), 0.25 * 0.4 + 0.75 * 0.8, rtol=1e-4)


def test_unlit_surfaces_ask_for_nothing():
    assert len(_look(stacked([Sheet(matte(0.5, unlit=True))])).positions) == 0


def test_the_picture_does_not_depend_on_its_bands(monkeypatch):
    from irradia.transport import gbuffer

    scene = stacked([Sheet(matte(0.5))], (replace(LAMP, mode="realtime"),), SKY)

    def light(positions: np.ndarray, normals: np.ndarray) -> np.ndarray:
        return positions**2

    whole = _under(scene, light)
    monkeypatch.setattr(gbuffer, "_SAMPLES_AT_ONCE", 5 * 16 * EDGE_PX)
    assert _under(scene, light).tobytes() == whole.tobytes()


def test_a_room_lit_by_its_own_irradiance_is_the_path_traced_room():
    """The whole of it, on cornell: E gathered at the very places that are seen."""
    from irradia.scene.merge import merge
    from irradia.transport.gbuffer import look
    from irradia.transport.point_light import gather_irradiance
    from irradia.transport.receivers import Receivers
    from irradia.transport.render import RenderOptions, render
    from irradia.transport.world import World

    scene = light_scene(load_scene("builtin:cornell"), LightOptions(default_light=False))
    world = World(scene, merge(scene))

    def gathered(positions: np.ndarray, normals: np.ndarray) -> np.ndarray:
        places = Receivers.in_space(positions + 1e-4 * normals, normals)
        return gather_irradiance(world, places, 0, 64, 1, None).values

    options = RenderOptions(32, 32, 4)
    (seen,) = look(scene, scene.cameras[0], options)
    reference = render(scene, scene.cameras[0], replace(options, spp=256, seed=7))
    np.testing.assert_allclose(seen.lit_by(gathered).mean((0, 1)), reference.mean((0, 1)), rtol=0.02)


def _pixels(scene, *, height: float = 2.0) -> np.ndarray:
    from irradia.transport.gbuffer import pixels_of_scene

    return pixels_of_scene(scene, _camera(height), _options())


def test_pixels_of_the_scene_are_those_whose_backdrop_is_hidden():
    sheet = stacked([Sheet(matte(0.5), width=0.5)], environment=environment_from_color((0.0, 0.0, 0.0)))
    before_white = replace(sheet, environment=environment_from_color((1.0, 1.0, 1.0)))
    hidden = _under(before_white, DARKNESS).mean(axis=2) < 0.5
    found = _pixels(sheet)
    assert 0.02 < found.mean() < 0.9
    assert (found != hidden).mean() < 0.03  # at the sheet's edge
    np.testing.assert_array_equal(found, _pixels(before_white))


def test_what_is_unlit_black_or_shines_is_scene_too():
    glowing, unlit = replace(BLACK, emission=(4.0, 2.0, 1.0)), replace(matte(0.5), unlit=True)
    expected = _pixels(stacked([Sheet(matte(0.5), width=0.5)]))
    for material in (glowing, unlit, BLACK):
        np.testing.assert_array_equal(_pixels(stacked([Sheet(material, width=0.5)])), expected)


def test_where_a_camera_sees_backdrop_alone_all_of_it_counts():
    assert _pixels(stacked([Sheet(matte(0.5))]), height=-2.0).all()
