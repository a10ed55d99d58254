"""Materials and their extensions arrive in the baker's words."""

from __future__ import annotations

import io

import numpy as np
import pytest
from PIL import Image as PillowImage

from irradia.core.errors import InputError
from irradia.scene.gltf import document_to_scene
from irradia.scene.types import Material

TRIANGLE = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0]], np.float32)


def png(color=(255, 0, 0, 255), size=(2, 2)) -> bytes:
    stream = io.BytesIO()
    PillowImage.new("RGBA", size, color).save(stream, "PNG")
    return stream.getvalue()


def add_texture(gltf, data: bytes | None = None, **fields) -> int:
    image = gltf.add("images", {"bufferView": gltf.view(data or png()), "mimeType": "image/png"})
    return gltf.add("textures", {"source": image, **fields})


def scene_with(gltf, n_texcoords=2, **options):
    """A triangle that wears the document's first material."""
    attributes = {"POSITION": TRIANGLE}
    attributes |= {f"TEXCOORD_{i}": TRIANGLE[:, :2] + i for i in range(n_texcoords)}
    gltf.node(mesh=gltf.mesh(attributes, material=0))
    return document_to_scene(gltf.document(), **options)


def material(gltf, json, **options) -> Material:
    gltf.add("materials", json)
    scene = scene_with(gltf, **options)
    return scene.materials[scene.primitives[0].material]


def extended(name, **fields):
    return {"extensions": {name: fields}}


def test_primitive_without_a_material_gets_the_default(gltf):
    gltf.add("materials", {"name": "unused"})
    gltf.triangle()
    scene = document_to_scene(gltf.document())
    assert scene.materials[0].name == "unused"
    assert scene.materials[scene.primitives[0].material] == Material()


def test_metallic_roughness_factors(gltf):
    pbr = {"baseColorFactor": [0.1, 0.2, 0.3, 0.4], "metallicFactor": 0.5, "roughnessFactor": 0.6}
    found = material(gltf, {"name": "m", "pbrMetallicRoughness": pbr, "doubleSided": True})
    assert (found.name, found.base_color, found.metallic, found.roughness) == (
        "m",
        (0.1, 0.2, 0.3, 0.4),
        0.5,
        0.6,
    )
    assert found.double_sided


def test_factors_slightly_out_of_range_are_clamped(gltf):
    pbr = {"baseColorFactor": [1.001, -0.1, 0.3, 1], "metallicFactor": 1.0001}
    found = material(gltf, {"pbrMetallicRoughness": pbr})
    assert found.base_color == (1.0, 0.0, 0.3, 1.0)
    assert found.metallic == 1.0


@pytest.mark.parametrize("mode", ["OPAQUE", "MASK", "BLEND"])
def test_alpha_modes(gltf, mode):
    found = material(gltf, {"alphaMode": mode, "alphaCutoff": 0.3})
    assert (found.alpha_mode, found.alpha_cutoff) == (mode.lower(), 0.3)


def test_emissive_strength_multiplies_the_factor(gltf):
    json = {"emissiveFactor": [1, 0.5, 0]} | extended("KHR_materials_emissive_strength", emissiveStrength=8)
    assert material(gltf, json).emission == (8, 4, 0)


def test_unlit_material_shows_its_base_colour_and_emits_nothing(gltf):
    found = material(gltf, {"emissiveFactor": [1, 1, 1]} | extended("KHR_materials_unlit"))
    assert found.unlit
    assert found.emission == (0, 0, 0)


def test_transmission_specular_and_ior_factors(gltf):
    extensions = {
        "KHR_materials_transmission": {"transmissionFactor": 0.7},
        "KHR_materials_diffuse_transmission": {
            "diffuseTransmissionFactor": 0.2,
            "diffuseTransmissionColorFactor": [0.1, 0.2, 0.3],
        },
        "KHR_materials_specular": {"specularFactor": 0.4, "specularColorFactor": [2, 1, 0]},
        "KHR_materials_ior": {"ior": 1.3},
    }
    found = material(gltf, {"extensions": extensions})
    assert (found.transmission, found.diffuse_transmission, found.specular, found.ior) == (0.7, 0.2, 0.4, 1.3)
    assert found.diffuse_transmission_color == (0.1, 0.2, 0.3)
    assert found.specular_color == (2, 1, 0)


def test_ior_of_zero_reflects_at_all_angles(gltf):
    ior = material(gltf, extended("KHR_materials_ior", ior=0)).ior
    assert ((ior - 1) / (ior + 1)) ** 2 == pytest.approx(1, abs=1e-3)


TEXTURES = {
    "base_color_texture": lambda info: {"pbrMetallicRoughness": {"baseColorTexture": info}},
    "metallic_roughness_texture": lambda info: {"pbrMetallicRoughness": {"metallicRoughnessTexture": info}},
    "emission_texture": lambda info: {"emissiveTexture": info},
    "normal_texture": lambda info: {"normalTexture": info},
    "specular_texture": lambda info: extended("KHR_materials_specular", specularTexture=info),
    "specular_color_texture": lambda info: extended("KHR_materials_specular", specularColorTexture=info),
    "transmission_texture": lambda info: extended("KHR_materials_transmission", transmissionTexture=info),
    "diffuse_transmission_texture": lambda info: extended(
        "KHR_materials_diffuse_transmission", diffuseTransmissionTexture=info
    ),
    "diffuse_transmission_color_texture": lambda info: extended(
        "KHR_materials_diffuse_transmission", diffuseTransmissionColorTexture=info
    ),
}


@pytest.mark.parametrize("field", TEXTURES)
def test_every_texture_reaches_its_field(gltf, field):
    add_texture(gltf)
    found = material(gltf, TEXTURES[field]({"index": 0, "texCoord": 1}))
    refs = {name for name in TEXTURES if getattr(found, name) is not None}
    assert refs == {field}
    assert getattr(found, field).texcoord == 1


def test_sampler_modes(gltf):
    gltf.add("samplers", {"wrapS": 33071, "wrapT": 33648, "magFilter": 9728})
    add_texture(gltf, sampler=0)
    ref = material(gltf, TEXTURES["emission_texture"]({"index": 0})).emission_texture
    assert ref is not None
    assert (ref.wrap_s, ref.wrap_t, ref.nearest) == ("clamp", "mirror", True)


def test_texture_without_a_sampler_repeats_and_filters(gltf):
    add_texture(gltf)
    ref = material(gltf, TEXTURES["emission_texture"]({"index": 0})).emission_texture
    assert ref is not None
    assert (ref.wrap_s, ref.wrap_t, ref.nearest) == ("repeat", "repeat", False)


def test_texture_transform_picks_the_lower_left_quadrant(gltf):
    """The extension's own example: that quadrant, turned."""
    add_texture(gltf)
    transform = {"offset": [0, 1], "rotation": np.pi / 2, "scale": [0.5, 0.5], "texCoord": 1}
    info = {"index": 0, **extended("KHR_texture_transform", **transform)}
    ref = material(gltf, TEXTURES["base_color_texture"](info)).base_color_texture
    assert ref is not None
    assert ref.texcoord == 1
    corners = np.array([[0, 0, 1], [1, 0, 1], [0, 1, 1], [1, 1, 1]]) @ np.array(ref.uv_from_texcoord).T
    np.testing.assert_allclose(corners, [[0, 1], [0, 0.5], [0.5, 1], [0.5, 0.5]], atol=1e-9)


def test_images_are_decoded_once_and_only_where_used(gltf):
    shared = add_texture(gltf, png((10, 20, 30, 40)))
    add_texture(gltf, b"not an image, but nobody looks")
    json = {"emissiveTexture": {"index": shared}, "normalTexture": {"index": shared}}
    gltf.add("materials", json)
    scene = scene_with(gltf)
    assert len(scene.images) == 1
    np.testing.assert_array_equal(scene.images[0].pixels, np.full((2, 2, 4), (10, 20, 30, 40)))


# ---- Specular-glossiness ---------------------------------------------------------------------

SPEC_GLOSS = "KHR_materials_pbrSpecularGlossiness"


def test_specular_glossiness_keeps_diffuse_and_specular_reflectance(gltf):
    json = extended(
        SPEC_GLOSS, diffuseFactor=[0.1, 0.2, 0.3, 0.9], specularFactor=[0.4, 0.5, 0.6], glossinessFactor=0.75
    )
    found = material(gltf, json | {"pbrMetallicRoughness": {"baseColorFactor": [1, 1, 1, 1]}})
    f0 = ((found.ior - 1) / (found.ior + 1)) ** 2 * np.array(found.specular_color)
    assert found.base_color == (0.1, 0.2, 0.3, 0.9)
    assert (found.metallic, found.roughness) == (0.0, 0.25)
    np.testing.assert_allclose(f0, [0.4, 0.5, 0.6], rtol=1e-3)


def test_diffuse_reflectance_above_one_is_clamped(gltf):
    found = material(gltf, extended(SPEC_GLOSS, diffuseFactor=[1.5, 0.2, 0.3, 1]))
    assert found.base_color == (1.0, 0.2, 0.3, 1.0)


def test_glossiness_in_alpha_becomes_roughness_in_green(gltf):
    add_texture(gltf, png((10, 20, 30, 200)))
    gltf.add("materials", extended(SPEC_GLOSS, specularGlossinessTexture={"index": 0}, glossinessFactor=0.5))
    scene = scene_with(gltf)
    found = scene.materials[0]
    assert found.metallic_roughness_texture is not None
    assert found.specular_color_texture is not None
    assert scene.images[found.specular_color_texture.image].pixels[0, 0].tolist() == [10, 20, 30, 200]
    assert scene.images[found.metallic_roughness_texture.image].pixels[0, 0, 1] == 255 - 100
    assert found.roughness == 1.0


# ---- Texcoord sets ---------------------------------------------------------------------------


def two_textures(gltf, base_set, emission_set):
    add_texture(gltf)
    return TEXTURES["base_color_texture"]({"index": 0, "texCoord": base_set}) | TEXTURES["emission_texture"](
        {"index": 0, "texCoord": emission_set}
    )


@pytest.mark.parametrize(
    ("base_set", "emission_set"), [(0, 1), (1, 0), (2, 0), (0, 3), (3, 2), (2, 2), (1, 3)]
)
def test_sets_in_use_come_first_and_textures_follow_them(gltf, base_set, emission_set):
    gltf.add("materials", two_textures(gltf, base_set, emission_set))
    scene = scene_with(gltf, n_texcoords=4)
    primitive = scene.primitives[0]
    found = scene.materials[primitive.material]
    for ref, wanted in ((found.base_color_texture, base_set), (found.emission_texture, emission_set)):
        assert ref is not None
        assert ref.texcoord < 2
        np.testing.assert_array_equal(primitive.texcoords[ref.texcoord], TRIANGLE[:, :2] + wanted)
    assert len(primitive.texcoords) == 4


def test_sets_in_front_stay_where_they_are(gltf):
    gltf.add("materials", two_textures(gltf, 1, 0))
    scene = scene_with(gltf, n_texcoords=2)
    assert len(scene.materials) == 1
    np.testing.assert_array_equal(scene.primitives[0].texcoords[1], TRIANGLE[:, :2] + 1)


def test_third_set_in_use_is_left_out_and_noted(gltf):
    json = two_textures(gltf, 0, 1) | {"normalTexture": {"index": 0, "texCoord": 2}}
    gltf.add("materials", {"name": "three", **json})
    scene = scene_with(gltf, n_texcoords=3)
    found = scene.materials[scene.primitives[0].material]
    assert found.normal_texture is None
    assert found.emission_texture is not None
    assert any("'three': its normal texture is left out" in note for note in scene.notes)


def test_texture_on_a_set_that_is_absent_is_left_out_and_noted(gltf):
    gltf.add("materials", two_textures(gltf, 0, 1))
    scene = scene_with(gltf, n_texcoords=1)
    found = scene.materials[scene.primitives[0].material]
    assert found.emission_texture is None
    assert found.base_color_texture is not None
    assert any("TEXCOORD_1 is absent" in note for note in scene.notes)


# ---- Variants --------------------------------------------------------------------------------


def with_variants(gltf):
    for name in ("own", "winter"):
        gltf.add("materials", {"name": name})
    gltf.json["extensions"] = {
        "KHR_materials_variants": {"variants": [{"name": "summer"}, {"name": "winter"}]}
    }
    mappings = [{"material": 1, "variants": [1]}]
    mesh = gltf.mesh(material=0, extensions={"KHR_materials_variants": {"mappings": mappings}})
    gltf.node(mesh=mesh)


@pytest.mark.parametrize(("variant", "expected"), [(None, "own"), ("summer", "own"), ("winter", "winter")])
def test_variant_chooses_the_material(gltf, variant, expected):
    with_variants(gltf)
    scene = document_to_scene(gltf.document(), variant=variant)
    assert scene.materials[scene.primitives[0].material].name == expected


def test_unknown_variant_lists_those_there_are(gltf):
    with_variants(gltf)
    with pytest.raises(InputError, match=r"no variant 'spring'\n.*'summer', 'winter'"):
        document_to_scene(gltf.document(), variant="spring")


# ---- Bad input -------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("json", "pointer"),
    [
        ({"alphaMode": "GLASS"}, "/materials/0/alphaMode"),
        (
            {"pbrMetallicRoughness": {"metallicFactor": "x"}},
            "/materials/0/pbrMetallicRoughness/metallicFactor",
        ),
        (
            {"pbrMetallicRoughness": {"baseColorFactor": [1, 1]}},
            "/materials/0/pbrMetallicRoughness/baseColorFactor",
        ),
        ({"emissiveFactor": [1, None, 1]}, "/materials/0/emissiveFactor/1"),
        ({"doubleSided": 1}, "/materials/0/doubleSided"),
        ({"emissiveTexture": {}}, "/materials/0/emissiveTexture"),
        ({"emissiveTexture": {"index": 4}}, "/textures"),
        ({"pbrMetallicRoughness": []}, "/materials/0/pbrMetallicRoughness"),
        ([], "/materials/0"),
    ],
)
def test_malformed_materials_name_the_key(gltf, json, pointer):
    with pytest.raises(InputError, match=pointer):
        material(gltf, json)


def test_material_that_does_not_exist_is_an_input_error(gltf):
    with pytest.raises(InputError, match=r"/meshes/0/primitives/0/material: expected an index below 0"):
        scene_with(gltf)


def test_texture_without_an_image_names_the_tool(gltf):
    gltf.add("textures", {})
    with pytest.raises(InputError, match=r"/textures/0: .*\n.*ktxdecompress"):
        material(gltf, TEXTURES["emission_texture"]({"index": 0}))


def test_unknown_wrap_mode_is_an_input_error(gltf):
    gltf.add("samplers", {"wrapS": 1})
    add_texture(gltf, sampler=0)
    with pytest.raises(InputError, match="/samplers/0/wrapS"):
        material(gltf, TEXTURES["emission_texture"]({"index": 0}))
