"""Albedo, emission and opacity of named materials, for surfaces whose shader isn't glTF's.

An engine's own shader often reaches a file as a bare grey material; what it shows is then said beside
the file, see :mod:`irradia.scene.material_override_file`. The scene's document stays as it is: an
exported file keeps its own materials.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
from PIL import Image as PillowImage

from irradia.core.errors import InputError
from irradia.core.names import did_you_mean
from irradia.scene.selection import matching_names
from irradia.scene.types import U8, AlphaMode, Image, Material, Rgb, Scene, TextureRef, WrapMode

Channel = Literal["albedo", "emission", "opacity"]
CHANNELS: tuple[Channel, ...] = ("albedo", "emission", "opacity")


@dataclass(frozen=True)
class ChannelOverride:
    """What a channel becomes: factor × image.

    Attributes:
        factor: Linear; of opacity, the first number counts.
        image: sRGB-coded colour; for opacity its alpha, or its red where it is opaque all over. None
            is white.
        texcoord: The set that the image is read with; None takes that of the image that it replaces.
    """

    factor: Rgb = (1.0, 1.0, 1.0)
    image: Image | None = None
    texcoord: int | None = None
    wrap: WrapMode = "repeat"


@dataclass(frozen=True)
class MaterialOverride:
    """What is replaced in the materials of one name.

    Attributes:
        name: Of the materials; may hold ``*`` and ``?``.
        channels: Those that are missing stay as they are.
        alpha_mode: None keeps the material's; where opacity is replaced, an opaque one then blends.
        alpha_cutoff: None keeps the material's.
        where: What errors name.
    """

    name: str
    channels: Mapping[Channel, ChannelOverride]
    alpha_mode: AlphaMode | None = None
    alpha_cutoff: float | None = None
    where: str = "--material-override"


def override_materials(scene: Scene, overrides: Sequence[MaterialOverride]) -> Scene:
    """The scene with its materials changed, one override after the other.

    Albedo makes a surface purely diffuse: what the image shows is what it reflects. The alpha of an
    albedo image is its opacity, as in glTF, unless opacity is said too.

    Raises:
        InputError: No material has a name (the nearest is suggested), or a mesh lacks the texture
            coordinates that an image is read with.
    """
    materials, images = list(scene.materials), list(scene.images)
    names = {material.name for material in materials}
    for override in overrides:
        chosen = matching_names(override.name, names)
        if not chosen:
            raise InputError(
                f"no material is called {override.name!r}",
                where=override.where,
                fix=did_you_mean(override.name, names),
            )
        for index, material in enumerate(materials):
            if material.name in chosen:
                materials[index] = _overridden(material, override, images)
                _check_texcoords(scene, index, material, materials[index], override.where)
    return replace(scene, materials=tuple(materials), images=tuple(images))


def _overridden(material: Material, override: MaterialOverride, images: list[Image]) -> Material:
    """The material with its channels replaced; their images are appended."""
    albedo, emission, opacity = (override.channels.get(channel) for channel in CHANNELS)
    if albedo is not None:
        material = _with_albedo(material, albedo, images)
    if emission is not None:
        texture = _texture(emission, material.emission_texture, images)
        material = replace(material, emission=emission.factor, emission_texture=texture)
    if opacity is not None:
        material = _with_opacity(material, opacity, images)
    return replace(
        material,
        alpha_mode=override.alpha_mode or material.alpha_mode,
        alpha_cutoff=material.alpha_cutoff if override.alpha_cutoff is None else override.alpha_cutoff,
    )


def _with_albedo(material: Material, albedo: ChannelOverride, images: list[Image]) -> Material:
    return replace(
        material,
        base_color=(*albedo.factor, material.base_color[3]),
        base_color_texture=_texture(albedo, material.base_color_texture, images),
        metallic=0.0,
        metallic_roughness_texture=None,
        specular=0.0,
        specular_texture=None,
        specular_color_texture=None,
        unlit=False,
    )


def _with_opacity(material: Material, opacity: ChannelOverride, images: list[Image]) -> Material:
    """Base colour and opacity share an image: one is made of both, as large as the larger of them."""
    before = material.base_color_texture
    texture = before
    if before is not None or opacity.image is not None:
        colour = None if before is None else images[before.image].pixels
        coverage = None if opacity.image is None else _coverage(opacity.image.pixels)
        name = "opacity" if opacity.image is None else opacity.image.name
        merged = replace(opacity, image=Image(name, _merged(colour, coverage)))
        texture = _texture(merged, before, images)
        if before is not None and texture is not None:
            texture = replace(before, image=texture.image)
    return replace(
        material,
        base_color=(*material.base_color[:3], min(opacity.factor[0], 1.0)),
        base_color_texture=texture,
        alpha_mode="blend" if material.alpha_mode == "opaque" else material.alpha_mode,
    )


def _texture(override: ChannelOverride, before: TextureRef | None, images: list[Image]) -> TextureRef | None:
    """A reference to the override's image, read where the one before was unless it says otherwise."""
    if override.image is None:
        return None
    images.append(override.image)
    if before is not None and override.texcoord is None:
        return replace(before, image=len(images) - 1)
    wrap = override.wrap
    return TextureRef(len(images) - 1, texcoord=override.texcoord or 0, wrap_s=wrap, wrap_t=wrap)


def _coverage(pixels: U8) -> U8:
    """(H, W) opacity that an image holds: its alpha, or its red where alpha says nothing."""
    return pixels[..., 0] if (pixels[..., 3] == 255).all() else pixels[..., 3]


def _merged(colour: U8 | None, coverage: U8 | None) -> U8:
    """(H, W, 4) of a colour image's RGB and a coverage; None is white."""
    shapes = [array.shape[:2] for array in (colour, coverage) if array is not None]
    height, width = max(s[0] for s in shapes), max(s[1] for s in shapes)
    pixels = np.full((height, width, 4), 255, np.uint8)
    if colour is not None:
        pixels[..., :3] = _resized(colour[..., :3], width, height)
    if coverage is not None:
        pixels[..., 3] = _resized(coverage, width, height)
    return pixels


def _resized(pixels: U8, width: int, height: int) -> U8:
    if pixels.shape[:2] == (height, width):
        return pixels
    resized = PillowImage.fromarray(np.ascontiguousarray(pixels)).resize(
        (width, height), PillowImage.Resampling.BILINEAR
    )
    return np.asarray(resized)


def _check_texcoords(scene: Scene, index: int, before: Material, after: Material, where: str) -> None:
    """Every primitive with the material must have the sets that its new images read."""
    wanted = {
        ref.texcoord
        for ref in (after.base_color_texture, after.emission_texture)
        if ref is not None and ref not in (before.base_color_texture, before.emission_texture)
    }
    for primitive in scene.primitives:
        missing = sorted(t for t in wanted if t >= len(primitive.texcoords))
        if primitive.material == index and missing:
            raise InputError(
                f"{primitive.name or 'a mesh'} has no TEXCOORD_{missing[0]} to read the image of "
                f"{after.name!r} with",
                where=where,
                fix='Name another set as "texcoord", or give the mesh one.',
            )
