"""All images of a scene in one buffer, looked up by number inside a kernel.

An image is stored as packed RGBA8. A texture's settings are rows of two small tables, so a kernel
that meets a thousand materials still has no branch per material. A table with mip levels stores each
image's behind it; rays do without, since their noise is larger than a texel's.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from irradia.core.colour import linear_from_srgb, srgb_from_linear
from irradia.scene.types import U8, Image, TextureRef
from irradia.transport.backend import dr, mi

_WRAP = {"repeat": 0, "clamp": 1, "mirror": 2}
NO_TEXTURE = 0  # slot 0 is a white pixel, so that "factor × texture" needs no case
MAX_LEVELS = 16


@dataclass
class Footprint:
    """How much of each texture coordinate set one lookup stands for: areas in uv units."""

    uv0: mi.Float
    uv1: mi.Float


class TextureTable:
    """Collects texture slots while a scene is built, then samples them.

    Call :meth:`add` for every reference, then :meth:`freeze` once, then :meth:`sample`.

    Args:
        images: The scene's.
        mip_levels: Whether lookups may be filtered over a footprint; takes a third more memory.
    """

    def __init__(self, images: tuple[Image, ...], *, mip_levels: bool = False) -> None:
        self._images = images
        self._mip_levels = mip_levels
        self._level_rows: list[list[int]] = [[0] * MAX_LEVELS]
        self._image_rows: dict[tuple[int, bool], tuple[int, int, int, list[int]]] = {}
        self._blocks: list[NDArray[np.uint32]] = [np.array([0xFFFFFFFF], np.uint32)]
        self._n_texels = 1
        self._slots: dict[TextureRef | None, int] = {None: NO_TEXTURE}
        self._int_rows: list[list[int]] = [[0, 1, 1, 0]]
        self._float_rows: list[list[float]] = [[1, 0, 0, 0, 0, 1, 0, 0]]

    def add(self, texture: TextureRef | None, *, srgb: bool = False) -> int:
        """The slot of a texture; the same reference has one slot.

        Args:
            texture: None has the white one.
            srgb: Whether its RGB is a colour, which is averaged as light.
        """
        if texture not in self._slots and texture is not None:
            first, height, width, levels = self._store(texture.image, srgb)
            flags = (
                _WRAP[texture.wrap_s]
                | _WRAP[texture.wrap_t] << 2
                | (texture.texcoord & 1) << 4
                | int(texture.nearest) << 5
            )
            self._slots[texture] = len(self._int_rows)
            self._int_rows.append([first, width, height, flags])
            self._level_rows.append(levels + levels[-1:] * (MAX_LEVELS - len(levels)))
            self._float_rows.append([*texture.uv_from_texcoord[0], *texture.uv_from_texcoord[1], 0, 0])
        return self._slots[texture]

    def _store(self, image_index: int, srgb: bool) -> tuple[int, int, int, list[int]]:
        """First texel, height and width of an image, and the first texel of each of its levels."""
        key = (image_index, srgb and self._mip_levels)
        if key not in self._image_rows:
            pixels = self._images[image_index].pixels
            height, width = pixels.shape[:2]
            firsts = []
            for level in mip_chain(pixels, srgb=srgb) if self._mip_levels else [pixels]:
                firsts.append(self._n_texels)
                self._blocks.append(np.ascontiguousarray(level).view("<u4").reshape(-1))
                self._n_texels += level.shape[0] * level.shape[1]
            self._image_rows[key] = (firsts[0], height, width, firsts)
        return self._image_rows[key]

    def freeze(self) -> None:
        """Uploads the tables."""
        self.texels = mi.UInt32(np.concatenate(self._blocks))
        self.ints = mi.UInt32(np.array(self._int_rows, np.uint32).ravel())
        self.floats = mi.Float(np.array(self._float_rows, np.float32).ravel())
        self.levels = mi.UInt32(np.array(self._level_rows, np.uint32).ravel())
        self.linear = mi.Float(linear_from_srgb(np.arange(256, dtype=np.float32) / 255.0).astype(np.float32))
        self._blocks.clear()

    def sample(
        self,
        slot: mi.UInt32,
        uv0: mi.Point2f,
        uv1: mi.Point2f,
        *,
        srgb: bool,
        active: mi.Bool,
        footprint: Footprint | None = None,
    ) -> Rgba:
        """Bilinear lookup; filtering is done in linear space.

        Args:
            slot: From :meth:`add`.
            uv0: First texture coordinate set at the hit.
            uv1: Second set.
            srgb: Whether RGB is sRGB-coded (alpha never is).
            active: Lanes that need a value; the others read nothing.
            footprint: What the lookup stands for, in a table with mip levels: it is made in the level
                whose texels are as large.
        """
        row = dr.gather(mi.Vector4u, self.ints, slot, active)
        first, width, height, flags = row.x, row.y, row.z, row.w
        m0 = dr.gather(mi.Vector4f, self.floats, 2 * slot, active)
        m1 = dr.gather(mi.Vector4f, self.floats, 2 * slot + 1, active)
        second = (flags & 16) != 0
        uv = dr.select(second, uv1, uv0)
        if footprint is not None:
            area = dr.select(second, footprint.uv1, footprint.uv0) * dr.abs(m0.x * m1.x - m0.y * m0.w)
            level = _level(area, width, height)
            first = dr.gather(mi.UInt32, self.levels, slot * MAX_LEVELS + level, active)
            width, height = dr.maximum(width >> level, 1), dr.maximum(height >> level, 1)
        x = (m0.x * uv.x + m0.y * uv.y + m0.z) * mi.Float(width)
        y = (m0.w * uv.x + m1.x * uv.y + m1.y) * mi.Float(height)

        nearest = (flags & 32) != 0
        x = dr.select(nearest, dr.floor(x), x - 0.5)
        y = dr.select(nearest, dr.floor(y), y - 0.5)
        x0, y0 = dr.floor(x), dr.floor(y)
        fx, fy = x - x0, y - y0
        column = [_wrap(x0 + i, mi.Float(width), flags & 3) for i in (0.0, 1.0)]
        line = [_wrap(y0 + i, mi.Float(height), (flags >> 2) & 3) for i in (0.0, 1.0)]

        total = Rgba(mi.Color3f(0.0), mi.Float(0.0))
        for j, wy in ((0, 1.0 - fy), (1, fy)):
            for i, wx in ((0, 1.0 - fx), (1, fx)):
                index = first + line[j] * width + column[i]
                texel = dr.gather(mi.UInt32, self.texels, index, active)
                total = total.plus(self._decode(texel, srgb, active), wx * wy)
        return total

    def _decode(self, texel: mi.UInt32, srgb: bool, active: mi.Bool) -> Rgba:
        channels = [texel & 255, (texel >> 8) & 255, (texel >> 16) & 255]
        if srgb:
            rgb = mi.Color3f(*[dr.gather(mi.Float, self.linear, c, active) for c in channels])
        else:
            rgb = mi.Color3f(*[mi.Float(c) for c in channels]) * (1.0 / 255.0)
        return Rgba(rgb, mi.Float(texel >> 24) * (1.0 / 255.0))


@dataclass
class Rgba:
    """Linear colour and alpha."""

    rgb: mi.Color3f
    alpha: mi.Float

    def plus(self, other: Rgba, weight: mi.Float) -> Rgba:
        """Adds ``other · weight``."""
        return Rgba(self.rgb + other.rgb * weight, self.alpha + other.alpha * weight)


def _wrap(index: mi.Float, size: mi.Float, mode: mi.UInt32) -> mi.UInt32:
    """Brings a whole texel number into [0, size) by repeating, clamping or mirroring.

    In floats, which are exact here: integer division is slow, and traps on masked lanes.
    """
    size = dr.maximum(size, 1.0)
    repeated = index - size * dr.floor(index / size)
    period = index - 2.0 * size * dr.floor(index / (2.0 * size))
    mirrored = dr.minimum(period, 2.0 * size - 1.0 - period)
    clamped = dr.clip(index, 0.0, size - 1.0)
    chosen = dr.select(mode == 0, repeated, dr.select(mode == 1, clamped, mirrored))
    return mi.UInt32(dr.clip(chosen, 0.0, size - 1.0))


def _level(uv_area: mi.Float, width: mi.UInt32, height: mi.UInt32) -> mi.UInt32:
    """The mip level whose texels are nearest in size to a stretch of uv."""
    texels = uv_area * mi.Float(width) * mi.Float(height)
    nearest = dr.floor(0.5 * dr.log2(dr.maximum(texels, 1.0)) + 0.5)
    smallest = dr.floor(dr.log2(mi.Float(dr.maximum(width, height)) + 0.5))
    return mi.UInt32(dr.minimum(dr.minimum(nearest, smallest), MAX_LEVELS - 1))


def mip_chain(pixels: U8, *, srgb: bool) -> list[U8]:
    """An image and its halvings down to one pixel; an odd last row or column counts as often as others.

    Args:
        pixels: (H, W, 4) as stored.
        srgb: Whether RGB is sRGB-coded; light is averaged, not its code.
    """
    chain = [pixels]
    values = pixels.astype(np.float32) / np.float32(255.0)
    if srgb:
        values[..., :3] = linear_from_srgb(values[..., :3])
    while max(values.shape[:2]) > 1 and len(chain) < MAX_LEVELS:
        values = _halved(_halved(values, 0), 1)
        coded = (
            np.concatenate([srgb_from_linear(values[..., :3]), values[..., 3:]], axis=-1) if srgb else values
        )
        chain.append(np.rint(coded * 255.0).astype(np.uint8))
    return chain


def _halved(values: NDArray[np.float32], axis: int) -> NDArray[np.float32]:
    """Means along an axis of n pixels over n // 2 equal stretches."""
    size = values.shape[axis]
    if size == 1:
        return values
    values = np.moveaxis(values, axis, 0)
    if size % 2 == 0:
        result = 0.5 * (values[0::2] + values[1::2])
    else:  # each new pixel covers two whole ones and parts of their neighbours
        half = size // 2
        left = np.arange(half, dtype=np.float32)[:, None, None]
        weights = ((half - left) / size, np.float32(half / size), (left + 1) / size)
        result = sum(w * values[k : k + 2 * half - 1 : 2] for k, w in enumerate(weights))
    return np.moveaxis(np.asarray(result, np.float32), 0, axis)
