"""Materials: metallic-roughness with the extensions that diffuse transport needs."""

from __future__ import annotations

from typing import Any, cast

from irradia.scene.gltf.spec_gloss import read_spec_gloss
from irradia.scene.gltf.textures import Textures
from irradia.scene.gltf.view import JsonView
from irradia.scene.types import AlphaMode, Material, Rgb

FULL_FRESNEL_IOR = 1e4
"""Stands for KHR_materials_ior's 0, reflection at all angles: F0 is 0.9996, and no formula divides by 0."""

_WHITE = (1.0, 1.0, 1.0)


def read_material(view: JsonView, textures: Textures) -> Material:
    """A material of the file; specular-glossiness, where given, is preferred over its fallback.

    Raises:
        InputError: A value has the wrong type, or a texture can't be read.
    """
    spec_gloss = view.extension("KHR_materials_pbrSpecularGlossiness")
    unlit = view.extension("KHR_materials_unlit") is not None
    fields = _surface(view, textures)
    if spec_gloss is not None:
        fields |= read_spec_gloss(spec_gloss, textures, FULL_FRESNEL_IOR)
    else:
        fields |= _metallic_roughness(view.object("pbrMetallicRoughness"), textures)
        fields |= _specular(view, textures)
    fields |= _transmission(view, textures)
    if not unlit:  # an unlit surface shows its base colour and nothing else
        fields |= _emission(view, textures)
    return Material(unlit=unlit, **fields)


def _surface(view: JsonView, textures: Textures) -> dict[str, Any]:
    modes = ("OPAQUE", "MASK", "BLEND")
    return {
        "name": view.string("name", view.pointer),
        "alpha_mode": cast(AlphaMode, view.choice("alphaMode", modes, "OPAQUE").lower()),
        "alpha_cutoff": view.number("alphaCutoff", 0.5),
        "double_sided": view.boolean("doubleSided", False),
        "normal_texture": textures.read(view, "normalTexture"),
        "normal_scale": view.object("normalTexture").number("scale", 1.0),
    }


def _metallic_roughness(view: JsonView, textures: Textures) -> dict[str, Any]:
    return {
        "base_color": view.fractions("baseColorFactor", (1.0, 1.0, 1.0, 1.0)),
        "base_color_texture": textures.read(view, "baseColorTexture"),
        "metallic": view.fraction("metallicFactor", 1.0),
        "roughness": view.fraction("roughnessFactor", 1.0),
        "metallic_roughness_texture": textures.read(view, "metallicRoughnessTexture"),
    }


def _emission(view: JsonView, textures: Textures) -> dict[str, Any]:
    strength_view = view.extension("KHR_materials_emissive_strength") or JsonView({})
    strength = strength_view.number("emissiveStrength", 1.0, minimum=0.0)
    factor = _rgb(view, "emissiveFactor", (0.0, 0.0, 0.0))
    return {
        "emission": tuple(strength * value for value in factor),
        "emission_texture": textures.read(view, "emissiveTexture"),
    }


def _specular(view: JsonView, textures: Textures) -> dict[str, Any]:
    ior_view = view.extension("KHR_materials_ior") or JsonView({})
    ior = ior_view.number("ior", 1.5, minimum=0.0)
    specular = view.extension("KHR_materials_specular") or JsonView({})
    return {
        "ior": ior if ior > 0 else FULL_FRESNEL_IOR,
        "specular": specular.fraction("specularFactor", 1.0),
        "specular_texture": textures.read(specular, "specularTexture"),
        "specular_color": _rgb(specular, "specularColorFactor", _WHITE),
        "specular_color_texture": textures.read(specular, "specularColorTexture"),
    }


def _transmission(view: JsonView, textures: Textures) -> dict[str, Any]:
    through = view.extension("KHR_materials_transmission") or JsonView({})
    diffuse = view.extension("KHR_materials_diffuse_transmission") or JsonView({})
    return {
        "transmission": through.fraction("transmissionFactor", 0.0),
        "transmission_texture": textures.read(through, "transmissionTexture"),
        "diffuse_transmission": diffuse.fraction("diffuseTransmissionFactor", 0.0),
        "diffuse_transmission_texture": textures.read(diffuse, "diffuseTransmissionTexture"),
        "diffuse_transmission_color": _rgb(diffuse, "diffuseTransmissionColorFactor", _WHITE),
        "diffuse_transmission_color_texture": textures.read(diffuse, "diffuseTransmissionColorTexture"),
    }


def _rgb(view: JsonView, key: str, default: Rgb) -> Rgb:
    red, green, blue = view.numbers(key, default)
    return (max(red, 0.0), max(green, 0.0), max(blue, 0.0))
