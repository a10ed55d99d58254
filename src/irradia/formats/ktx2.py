"""KTX 2.0 textures for HDR light: RGBA16F or RGB9E5, array layers for pages, zstd inside.

This work is based on: KTX File Format Specification 2.0 (Khronos, 2020; header and level index in
section 3, zstd in 3.11) and Khronos Data Format Specification 1.3 (2019; section 5, and for RGB9E5
the shared-exponent example). ``bytesPlane0`` keeps the inflated texel size, as later revisions ask.
One mip level: lightmap charts would bleed into each other in smaller ones.
"""

from __future__ import annotations

import struct
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from irradia.core.errors import InputError
from irradia.formats.dfd import data_format_descriptor
from irradia.formats.limits import check_image_size
from irradia.formats.rgb9e5 import pack_rgb9e5, unpack_rgb9e5

Encoding = Literal["half", "rgb9e5"]
VK_FORMAT: dict[Encoding, int] = {"half": 97, "rgb9e5": 123}
TEXEL_BYTES: dict[Encoding, int] = {"half": 8, "rgb9e5": 4}
HALF_MAX = 65504.0
MAX_LAYERS = 2048

_ENCODING_OF: dict[int, Encoding] = {code: name for name, code in VK_FORMAT.items()}
_IDENTIFIER = b"\xabKTX 20\xbb\r\n\x1a\n"
_HEADER = struct.Struct("<9I4I2Q")  # fields, then offset and length of the DFD, key/values, globals
_LEVEL = struct.Struct("<3Q")
_SCHEME_NONE, _SCHEME_ZSTD = 0, 2
_ZSTD_LEVEL = 9  # 15 takes 4 times as long for 1 % less
_BAND_TEXELS = 1 << 19
_REPAIR = "The texture is incomplete or damaged: export it again."


@dataclass(frozen=True)
class Ktx2Texture:
    """One mip level of a 2D texture or array.

    Attributes:
        pages: (P, H, W, 3) float32 linear, origin top left.
        encoding: How a texel is stored.
        metadata: Key to text.
    """

    pages: NDArray[np.float32]
    encoding: Encoding
    metadata: Mapping[str, str] = field(default_factory=dict)


def encode_ktx2(
    pages: NDArray, encoding: Encoding = "rgb9e5", metadata: Mapping[str, str] | None = None
) -> bytes:
    """Encodes (P, H, W, 3) linear values ≥ 0; several pages become array layers.

    Values over the encoding's largest (65504 or 65408) are clamped to it. Alpha of half texels is 1.
    """
    import zstandard

    n_pages, height, width = pages.shape[:3]
    raw = _texels(pages, encoding).tobytes()
    packed = zstandard.ZstdCompressor(level=_ZSTD_LEVEL).compress(raw)
    descriptor = data_format_descriptor(encoding)
    pairs = _key_values({"KTXorientation": "rd", "KTXwriter": "irradia", **(metadata or {})})
    descriptor_at = len(_IDENTIFIER) + _HEADER.size + _LEVEL.size
    pairs_at = descriptor_at + len(descriptor)
    level_at = pairs_at + len(pairs)
    layers = n_pages if n_pages > 1 else 0
    type_bytes = 2 if encoding == "half" else 4
    header = _HEADER.pack(
        *(VK_FORMAT[encoding], type_bytes, width, height, 0, layers, 1, 1, _SCHEME_ZSTD),
        *(descriptor_at, len(descriptor), pairs_at, len(pairs), 0, 0),
    )
    return _IDENTIFIER + header + _LEVEL.pack(level_at, len(packed), len(raw)) + descriptor + pairs + packed


def decode_ktx2(data: bytes, where: str = "KTX2 texture") -> Ktx2Texture:
    """Decodes what :func:`encode_ktx2` writes, supercompressed or not.

    Raises:
        InputError: Not KTX2, another format or shape than ours, cut short, or absurdly large.
    """
    if len(data) < len(_IDENTIFIER) + _HEADER.size + _LEVEL.size or not data.startswith(_IDENTIFIER):
        raise InputError(f"expected a KTX 2.0 texture, found {data[:12]!r}", where=where, fix=_REPAIR)
    fields = _HEADER.unpack_from(data, len(_IDENTIFIER))
    vk_format, _, width, height, depth, layers, faces, levels, scheme = fields[:9]
    encoding = _ENCODING_OF.get(vk_format)
    if encoding is None or depth != 0 or faces != 1 or levels != 1 or layers > MAX_LAYERS:
        raise InputError(
            f"expected a one-level 2D texture or array of format 97 or 123, found format {vk_format}, "
            f"depth {depth}, {layers} layers, {faces} faces, {levels} levels",
            where=where,
        )
    n_pages = max(layers, 1)
    check_image_size(width, height, where, n_pages)
    raw = _level_bytes(data, scheme, n_pages * height * width * TEXEL_BYTES[encoding], where)
    pages = _linear(np.frombuffer(raw, np.uint8), encoding).reshape(n_pages, height, width, 3)
    return Ktx2Texture(pages, encoding, _parse_key_values(data, fields[11], fields[12], where))


def _texels(pages: NDArray, encoding: Encoding) -> NDArray:
    """Texels as stored, made a band of rows at a time: RGB9E5 takes 100 bytes a texel on the way."""
    n_pages, height, width = pages.shape[:3]
    texels = np.empty((n_pages * height, width), "<u4" if encoding == "rgb9e5" else ("<f2", (4,)))
    rows = pages.reshape(n_pages * height, width, 3)
    band = max(_BAND_TEXELS // width, 1)
    for start in range(0, len(rows), band):
        part = rows[start : start + band]
        if encoding == "rgb9e5":
            texels[start : start + band] = pack_rgb9e5(part)
        else:
            texels[start : start + band, :, :3] = np.clip(part, 0.0, HALF_MAX)
            texels[start : start + band, :, 3] = 1.0
    return texels


def _linear(raw: NDArray[np.uint8], encoding: Encoding) -> NDArray[np.float32]:
    if encoding == "rgb9e5":
        return unpack_rgb9e5(raw.view("<u4"))
    return raw.view("<f2").reshape(-1, 4)[:, :3].astype(np.float32)


def _level_bytes(data: bytes, scheme: int, expected: int, where: str) -> bytes:
    """The inflated texels. Nothing larger than the header promises is ever allocated."""
    import zstandard

    at, length, inflated = _LEVEL.unpack_from(data, len(_IDENTIFIER) + _HEADER.size)
    packed = data[at : at + length]
    if len(packed) != length or inflated != expected:
        raise InputError(
            f"expected {expected} bytes of texels, found {inflated} stored in {len(packed)} of {length}",
            where=where,
            fix=_REPAIR,
        )
    if scheme == _SCHEME_NONE:
        raw = packed
    elif scheme == _SCHEME_ZSTD:
        try:
            reader = zstandard.ZstdDecompressor().stream_reader(packed)
            raw = reader.read(expected) + reader.read(1)
        except zstandard.ZstdError as error:
            raise InputError(f"its zstd data is damaged: {error}", where=where, fix=_REPAIR) from error
    else:
        raise InputError(f"expected supercompression 0 or 2 (zstd), found {scheme}", where=where)
    if len(raw) != expected:
        raise InputError(f"expected {expected} bytes of texels, found {len(raw)}", where=where, fix=_REPAIR)
    return raw


def _key_values(pairs: Mapping[str, str]) -> bytes:
    """Sorted by key, each padded to 4 bytes, text ended by NUL."""
    out = bytearray()
    for key in sorted(pairs):
        entry = key.encode() + b"\0" + pairs[key].encode() + b"\0"
        out += struct.pack("<I", len(entry)) + entry + bytes(-len(entry) % 4)
    return bytes(out)


def _parse_key_values(data: bytes, at: int, length: int, where: str) -> dict[str, str]:
    end = at + length
    if end > len(data):
        raise InputError("its key/value data is cut short", where=where, fix=_REPAIR)
    pairs = {}
    while at + 4 <= end:
        size = int.from_bytes(data[at : at + 4], "little")
        key, separator, value = data[at + 4 : at + 4 + size].partition(b"\0")
        if not separator or at + 4 + size > end:
            raise InputError("its key/value data is damaged", where=where, fix=_REPAIR)
        pairs[key.decode("utf-8", "replace")] = value.rstrip(b"\0").decode("utf-8", "replace")
        at += 4 + size + (-size % 4)
    return pairs
