"""Materials from beside the file."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from PIL import Image as PillowImage

from irradia.core.errors import InputError
from irradia.scene.material_override import ChannelOverride, MaterialOverride, override_materials
from irradia.scene.material_override_file import read_material_overrides
from irradia.scene.types import Image, Scene, TextureRef


@pytest.fixture
def scene(named_scene) -> Scene:
    """Materials "paint", with a 2 × 2 image of alpha 128, and "glow", with none."""
    return named_scene([("a", "a")])


@pytest.fixture
def picture(tmp_path: Path) -> Path:
    """A 4 × 1 image, opaque, its red running 0, 85, 170, 255."""
    pixels = np.zeros((1, 4, 3), np.uint8)
    pixels[0, :, 0] = (0, 85, 170, 255)
    PillowImage.fromarray(pixels).save(tmp_path / "picture.png")
    return tmp_path / "picture.png"


def changed(scene: Scene, *arguments: str) -> Scene:
    return override_materials(scene, read_material_overrides(arguments))


def test_albedo_is_all_that_a_surface_then_reflects(scene):
    paint = changed(scene, "paint:albedo=0.2,0.3,0.4").materials[0]
    assert paint.base_color == (0.2, 0.3, 0.4, 1.0)
    assert (paint.metallic, paint.specular, paint.base_color_texture) == (0.0, 0.0, None)


def test_image_is_read_where_the_one_before_was(scene, picture):
    paint = changed(scene, f"paint:albedo={picture}")
    texture = paint.materials[0].base_color_texture
    assert texture == TextureRef(1)
    assert paint.images[1].pixels[0, :, 0].tolist() == [0, 85, 170, 255]
    assert paint.materials[0].base_color[:3] == (1.0, 1.0, 1.0)


def test_emission_leaves_the_rest_as_it_was(scene):
    before = scene.materials[1]
    glow = changed(scene, "glow:emission=7").materials[1]
    assert glow.emission == (7.0, 7.0, 7.0)
    assert (glow.base_color, glow.metallic, glow.alpha_mode) == (before.base_color, before.metallic, "opaque")


def test_opacity_factor_takes_the_place_of_the_images_alpha(scene):
    after = changed(scene, "paint:opacity=0.25")
    paint = after.materials[0]
    assert (paint.base_color[3], paint.alpha_mode) == (0.25, "blend")
    assert paint.base_color_texture is not None
    pixels = after.images[paint.base_color_texture.image].pixels
    assert (pixels[..., 3] == 255).all()
    assert (pixels[..., :3] == (200, 100, 50)).all()


def test_opacity_image_is_joined_to_the_colour_at_the_larger_size(scene, picture):
    after = changed(scene, f"paint:opacity={picture}")
    texture = after.materials[0].base_color_texture
    assert texture is not None
    pixels = after.images[texture.image].pixels
    assert pixels.shape == (2, 4, 4)
    assert pixels[0, :, 3].tolist() == [0, 85, 170, 255]
    assert (pixels[..., :3] == (200, 100, 50)).all()


def test_alpha_of_an_opacity_image_counts_before_its_red(scene):
    pixels = np.full((1, 1, 4), (255, 255, 255, 40), np.uint8)
    override = MaterialOverride("glow", {"opacity": ChannelOverride(image=Image("cut", pixels))}, "mask", 0.3)
    after = override_materials(scene, [override])
    glow = after.materials[1]
    assert (glow.alpha_mode, glow.alpha_cutoff) == ("mask", 0.3)
    assert glow.base_color_texture is not None
    assert after.images[glow.base_color_texture.image].pixels.tolist() == [[[255, 255, 255, 40]]]


def test_file_says_all_channels_at_once(scene, picture, tmp_path):
    wishes = {
        "p*": {"albedo": [0.1, 0.2, 0.3], "alphaMode": "mask", "alphaCutoff": 0.2},
        "glow": {"emission": {"image": picture.name, "factor": 40, "wrap": "clamp"}},
    }
    (tmp_path / "overrides.json").write_text(json.dumps(wishes))
    after = changed(scene, str(tmp_path / "overrides.json"))
    assert after.materials[0].base_color == (0.1, 0.2, 0.3, 1.0)
    assert (after.materials[0].alpha_mode, after.materials[0].alpha_cutoff) == ("mask", 0.2)
    assert after.materials[1].emission == (40.0, 40.0, 40.0)
    assert after.materials[1].emission_texture == TextureRef(1, wrap_s="clamp", wrap_t="clamp")


def test_scene_itself_stays_as_it_was(scene):
    changed(scene, "paint:albedo=0.5")
    assert scene.materials[0].metallic == 1.0
    assert len(scene.images) == 1


@pytest.mark.parametrize(
    ("argument", "message"),
    [
        ("Paint:albedo=0.5", r"(?s)no material is called 'Paint'.*'paint'"),
        ("paint:albdeo=0.5", r"(?s)found 'albdeo'.*'albedo'"),
        ("paint=0.5", "NAME:CHANNEL=VALUE"),
        ("paint:albedo=0.5,0.5", "one number or three"),
        ("paint:albedo=-1", "each at least 0"),
        ("paint:albedo=nowhere.png", "can't read the image nowhere.png"),
        ("nowhere.json", "can't read this file"),
    ],
)
def test_wrong_arguments_are_input_errors(scene, argument, message):
    with pytest.raises(InputError, match=message):
        changed(scene, argument)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("{", "expected JSON"),
        ('{"paint": {"albeddo": 1}}', r"(?s)overrides.json/paint/albeddo: .*'albedo'"),
        ('{"paint": {"albedo": {"factr": 1}}}', r"(?s)paint/albedo/factr: .*'factor'"),
        ('{"paint": {"albedo": true}}', "expected an image or numbers"),
        ('{"paint": {"alphaMode": "MASK"}}', "expected one of opaque, mask, blend"),
        ('{"paint": {"emission": {"texcoord": 2}}}', "expected an index below 2"),
    ],
)
def test_wrong_files_are_input_errors_that_say_where(scene, tmp_path, text, message):
    (tmp_path / "overrides.json").write_text(text)
    with pytest.raises(InputError, match=message):
        changed(scene, str(tmp_path / "overrides.json"))


def test_image_needs_the_texture_coordinates_that_it_is_read_with(scene):
    override = MaterialOverride("paint", {"emission": ChannelOverride(image=scene.images[0], texcoord=1)})
    with pytest.raises(InputError, match="a has no TEXCOORD_1"):
        override_materials(scene, [override])
