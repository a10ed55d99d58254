"""glTF JSON of the engine-neutral material: the inverse of what the importer does."""

from __future__ import annotations

from typing import Any

from irradia.scene.gltf.document import Json
from irradia.scene.types import Material, TextureRef


def material_json(material: Material) -> Json:
    """The glTF material; defaults are left out. Texture index = image index.

    Only what the built-in scenes use: base colour, metallic-roughness, normal map, emission, alpha
    modes, KHR_materials_specular, _transmission, _diffuse_transmission and _emissive_strength.
    """
    written: Json = {"name": material.name, "pbrMetallicRoughness": _metallic_roughness(material)}
    if material.normal_texture is not None:
        written["normalTexture"] = {**_texture(material.normal_texture), "scale": material.normal_scale}
    if material.alpha_mode != "opaque":
        written["alphaMode"] = material.alpha_mode.upper()
    if material.alpha_mode == "mask":
        written["alphaCutoff"] = material.alpha_cutoff
    if material.double_sided:
        written["doubleSided"] = True
    strength = max(1.0, *material.emission)
    if any(material.emission):
        written["emissiveFactor"] = [round(c / strength, 9) for c in material.emission]
    extensions = _extensions(material, strength)
    if extensions:
        written["extensions"] = extensions
    return written


def _metallic_roughness(material: Material) -> Json:
    written: Json = {
        "baseColorFactor": list(material.base_color),
        "metallicFactor": material.metallic,
        "roughnessFactor": material.roughness,
    }
    if material.base_color_texture is not None:
        written["baseColorTexture"] = _texture(material.base_color_texture)
    if material.metallic_roughness_texture is not None:
        written["metallicRoughnessTexture"] = _texture(material.metallic_roughness_texture)
    return written


def _extensions(material: Material, emissive_strength: float) -> dict[str, Any]:
    written: dict[str, Any] = {}
    if material.specular != 1.0:
        written["KHR_materials_specular"] = {"specularFactor": material.specular}
    if material.transmission:
        written["KHR_materials_transmission"] = {"transmissionFactor": material.transmission}
    if material.diffuse_transmission:
        written["KHR_materials_diffuse_transmission"] = {
            "diffuseTransmissionFactor": material.diffuse_transmission,
            "diffuseTransmissionColorFactor": list(material.diffuse_transmission_color),
        }
    if emissive_strength > 1.0:
        written["KHR_materials_emissive_strength"] = {"emissiveStrength": emissive_strength}
    return written


def _texture(reference: TextureRef) -> Json:
    written: Json = {"index": reference.image}
    if reference.texcoord:
        written["texCoord"] = reference.texcoord
    return written
