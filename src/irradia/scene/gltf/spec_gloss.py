"""KHR_materials_pbrSpecularGlossiness in the words of metallic-roughness.

The diffuse colour becomes the base colour of a dielectric; the specular colour its F0, by way of
KHR_materials_specular over an index of refraction that reflects all. Both models weigh the diffuse
part with 1 − max(F), so diffuse transport loses nothing.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from irradia.scene.gltf.textures import Textures
from irradia.scene.gltf.view import JsonView
from irradia.scene.types import Image, TextureRef


def read_spec_gloss(view: JsonView, textures: Textures, full_fresnel_ior: float) -> dict[str, Any]:
    """The extension's values as fields of :class:`irradia.scene.types.Material`.

    Args:
        view: The extension's object.
        textures: Takes the derived roughness image, too.
        full_fresnel_ior: Index of refraction whose F0 is 1.
    """
    glossiness = view.fraction("glossinessFactor", 1.0)
    specular_glossiness = textures.read(view, "specularGlossinessTexture")
    return {
        "base_color": view.fractions("diffuseFactor", (1.0, 1.0, 1.0, 1.0)),
        "base_color_texture": textures.read(view, "diffuseTexture"),
        "metallic": 0.0,
        "roughness": 1.0 if specular_glossiness else 1.0 - glossiness,
        "metallic_roughness_texture": specular_glossiness
        and _roughness_texture(specular_glossiness, glossiness, textures),
        "ior": full_fresnel_ior,
        "specular_color": view.fractions("specularFactor", (1.0, 1.0, 1.0)),
        "specular_color_texture": specular_glossiness,
    }


def _roughness_texture(source: TextureRef, glossiness: float, textures: Textures) -> TextureRef:
    """Roughness in G, as metallic-roughness has it, from glossiness in A."""
    image = textures.images[source.image]
    roughness = 255.0 - glossiness * image.pixels[..., 3].astype(np.float32)
    pixels = np.zeros_like(image.pixels)
    pixels[..., 1] = np.rint(roughness)
    pixels[..., 3] = 255
    return replace(source, image=textures.add(Image(f"{image.name} (roughness)", pixels)))
