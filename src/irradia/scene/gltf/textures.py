"""Texture infos: which image, how it is sampled, and where it is read."""

from __future__ import annotations

import math

from irradia.core.errors import InputError
from irradia.scene.gltf.document import GltfDocument
from irradia.scene.gltf.images import decode_image
from irradia.scene.gltf.view import JsonView
from irradia.scene.types import Image, TextureRef, WrapMode

_WRAP_MODES: dict[int, WrapMode] = {10497: "repeat", 33071: "clamp", 33648: "mirror"}
_NEAREST = 9728


class Textures:
    """Turns texture infos into references, decoding each image when it is first used."""

    def __init__(self, document: GltfDocument) -> None:
        self._root = JsonView(document.json)
        self._encoded = document.images
        self._decoded: list[Image] = []
        self._position: dict[int, int] = {}

    @property
    def images(self) -> tuple[Image, ...]:
        """The images that references point into: those used, in the order of first use."""
        return tuple(self._decoded)

    def add(self, image: Image) -> int:
        """Adds an image that the file doesn't hold; returns its index."""
        self._decoded.append(image)
        return len(self._decoded) - 1

    def read(self, owner: JsonView, key: str) -> TextureRef | None:
        """The texture that ``owner`` has under ``key``, or None.

        Raises:
            InputError: The texture, its image or its sampler is missing or malformed.
        """
        if not owner.has(key):
            return None
        info = owner.object(key)
        texture = self._root.element("textures", info.integer("index"))
        wrap_s, wrap_t, nearest = self._sampler(texture)
        transform = info.extension("KHR_texture_transform")
        texcoord = info.integer("texCoord", 0)
        return TextureRef(
            image=self._image(texture),
            texcoord=texcoord if transform is None else transform.integer("texCoord", texcoord),
            uv_from_texcoord=_uv_transform(transform or JsonView({})),
            wrap_s=wrap_s,
            wrap_t=wrap_t,
            nearest=nearest,
        )

    def _image(self, texture: JsonView) -> int:
        """Index of the texture's decoded image; WebP is preferred where both are given."""
        webp = texture.extension("EXT_texture_webp")
        source = texture if webp is None or not webp.has("source") else webp
        index = source.index("source", len(self._encoded))
        if index is None:
            raise InputError(
                "this texture has no PNG, JPEG or WebP image",
                where=texture.pointer,
                fix="KTX2 textures are turned into PNG by: "
                "npx @gltf-transform/cli ktxdecompress in.glb out.glb",
            )
        if index not in self._position:
            view = self._root.element("images", index)
            image = decode_image(self._encoded[index], view.string("name", f"image {index}"), view.pointer)
            self._position[index] = self.add(image)
        return self._position[index]

    def _sampler(self, texture: JsonView) -> tuple[WrapMode, WrapMode, bool]:
        if not texture.has("sampler"):
            return "repeat", "repeat", False
        sampler = self._root.element("samplers", texture.integer("sampler"))
        nearest = sampler.integer("magFilter", 0) == _NEAREST
        return _wrap_mode(sampler, "wrapS"), _wrap_mode(sampler, "wrapT"), nearest


def _wrap_mode(sampler: JsonView, key: str) -> WrapMode:
    code = sampler.integer(key, 10497)
    if code not in _WRAP_MODES:
        raise InputError(
            f"expected one of {', '.join(map(str, _WRAP_MODES))}, found {code}",
            where=f"{sampler.pointer}/{key}",
        )
    return _WRAP_MODES[code]


def _uv_transform(
    transform: JsonView,
) -> tuple[tuple[float, float, float], tuple[float, float, float]]:
    """Offset · rotation · scale. v points down, so a counter-clockwise turn has −sin below.

    The matrix in early drafts of KHR_texture_transform turns the other way; the drafts' own example,
    the lower left quadrant, only comes out with this one.
    """
    offset_u, offset_v = transform.numbers("offset", (0.0, 0.0))
    scale_u, scale_v = transform.numbers("scale", (1.0, 1.0))
    angle = transform.number("rotation", 0.0)
    cos, sin = math.cos(angle), math.sin(angle)
    return (
        (cos * scale_u, sin * scale_v, offset_u),
        (-sin * scale_u, cos * scale_v, offset_v),
    )
