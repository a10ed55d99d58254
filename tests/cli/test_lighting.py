"""Which light a scene gets: options, else the file's wish, else a default sky."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from irradia.cli.lighting import DEFAULT_SKY_NOTE, LightOptions, has_light, light_scene
from irradia.core.errors import InputError
from irradia.formats.exr import write_exr_rgb
from irradia.scene.gltf.document import GltfDocument
from irradia.scene.load import load_scene
from irradia.scene.types import Light, Scene


@pytest.fixture(scope="module")
def dark() -> Scene:
    """A scene without any light or wish for it."""
    lit = load_scene("builtin:cornell")
    materials = tuple(dataclasses.replace(m, emission=(0.0, 0.0, 0.0)) for m in lit.materials)
    document = GltfDocument(json={"asset": {"version": "2.0"}}, buffers=())
    return dataclasses.replace(lit, materials=materials, document=document)


def _wishing(scene: Scene, wish: dict) -> Scene:
    json = {"asset": {"version": "2.0"}, "extras": {"irradia": wish}}
    return dataclasses.replace(scene, document=GltfDocument(json=json, buffers=()))


def test_a_dropped_file_without_light_gets_sun_and_sky_and_says_so(dark):
    lit = light_scene(dark, LightOptions())
    assert lit.environment is not None
    assert [light.kind for light in lit.lights] == ["directional"]
    assert lit.notes[-1] == DEFAULT_SKY_NOTE


def test_without_the_default_it_stays_black(dark):
    black = light_scene(dark, LightOptions(default_light=False))
    assert black.environment is None
    assert black.lights == ()
    assert black.notes == dark.notes


def test_a_lamp_or_a_glowing_surface_is_light_enough(dark):
    lamp = dataclasses.replace(dark, lights=(Light("point", (1.0, 1.0, 1.0)),))
    glowing = dataclasses.replace(
        dark, materials=tuple(dataclasses.replace(m, emission=(0.0, 0.1, 0.0)) for m in dark.materials)
    )
    for scene in (lamp, glowing):
        assert light_scene(scene, LightOptions()) == scene


def test_a_glowing_material_that_nothing_wears_is_no_light(dark):
    spare = dataclasses.replace(dark.materials[0], emission=(9.0, 9.0, 9.0))
    scene = dataclasses.replace(dark, materials=(*dark.materials, spare))
    assert not has_light(scene)


def test_a_colour_comes_from_everywhere(dark):
    lit = light_scene(dark, LightOptions(env_color=(0.1, 0.2, 0.4), env_strength=2.0))
    assert lit.environment is not None
    assert np.allclose(lit.environment.radiance, (0.2, 0.4, 0.8))
    assert lit.lights == ()


def test_an_image_is_turned_and_dimmed(dark, tmp_path):
    picture = np.random.default_rng(4).random((8, 16, 3), np.float32)
    write_exr_rgb(tmp_path / "env.exr", picture)
    lit = light_scene(dark, LightOptions(env=tmp_path / "env.exr", env_rotation_deg=180.0, env_strength=0.5))
    assert lit.environment is not None
    assert np.allclose(lit.environment.radiance, 0.5 * np.roll(picture, 8, axis=1), atol=1e-6)


def test_the_sky_dims_with_its_sun(dark):
    bright = light_scene(dark, LightOptions(sky=True))
    dim = light_scene(dark, LightOptions(sky=True, env_strength=0.25))
    assert np.allclose(dim.lights[0].intensity, 0.25 * np.array(bright.lights[0].intensity))
    assert bright.environment is not None
    assert dim.environment is not None
    assert np.allclose(dim.environment.radiance, 0.25 * bright.environment.radiance)


def test_the_files_wish_counts_when_no_option_is_given(dark):
    grey = _wishing(dark, {"environmentColor": [0.5, 0.5, 0.5]})
    lit = light_scene(grey, LightOptions())
    assert lit.environment is not None
    assert np.allclose(lit.environment.radiance, 0.5)
    overruled = light_scene(grey, LightOptions(env_color=(1.0, 0.0, 0.0)))
    assert overruled.environment is not None
    assert np.allclose(overruled.environment.radiance, (1.0, 0.0, 0.0))


def test_a_file_may_wish_for_black(dark):
    black = light_scene(_wishing(dark, {"environmentColor": [0, 0, 0]}), LightOptions())
    assert black.environment is not None
    assert not black.environment.radiance.any()
    assert black.lights == ()


def test_a_wished_sky_can_leave_its_sun_to_the_file(dark):
    lit = light_scene(_wishing(dark, {"sky": {"sunElevationDeg": 20, "sun": False}}), LightOptions())
    assert lit.lights == ()
    assert lit.environment is not None
    assert "20" in lit.environment.name


@pytest.mark.parametrize(
    ("wish", "where"),
    [
        ({"sky": {"turbidity": "hazy"}}, "/extras/irradia/sky/turbidity"),
        ({"environmentColor": [1, 2]}, "/extras/irradia/environmentColor"),
        ({"sky": 5}, "/extras/irradia/sky"),
    ],
)
def test_a_malformed_wish_is_bad_input_with_its_place(dark, wish, where):
    with pytest.raises(InputError) as caught:
        light_scene(_wishing(dark, wish), LightOptions())
    assert caught.value.where == where


def test_two_kinds_of_surroundings_are_one_too_many():
    with pytest.raises(InputError, match="only one"):
        LightOptions(sky=True, env_color=(1.0, 1.0, 1.0))
