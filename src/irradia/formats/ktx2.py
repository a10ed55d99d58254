"""KTX 2.0 textures for HDR light: RGBA16F, RGB9E5 or BC6H, array layers for pages, zstd inside.

This work is based on: KTX File Format Specification 2.0 (Khronos, 2020; header and level index in
section 3, zstd in 3.11) and Khronos Data Format Specification 1.3 (2019; section 5, and for RGB9E5
the shared-exponent example). ``bytesPlane0`` keeps the inflated texel size, as later revisions ask.
One mip level unless more are asked for: lightmap charts bleed into each other in smaller ones.
"""

from __future__ import annotations

import os
import struct
from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from irradia.core.errors import InputError
from irradia.formats.dfd import data_format_descriptor
from irradia.formats.ktx2_texels import (
    TYPE_BYTES,
    VK_FORMAT,
    Encoding,
    decode_level,
    encode_level,
    half_size,
    level_bytes,
)
from irradia.formats.limits import check_image_size

MAX_LAYERS = 2048

_ENCODING_OF: dict[int, Encoding] = {code: name for name, code in VK_FORMAT.items()}
_IDENTIFIER = b"\xabKTX 20\xbb\r\n\x1a\n"
_HEADER = struct.Struct("<9I4I2Q")  # fields, then offset and length of the DFD, key/values, globals
_LEVEL = struct.Struct("<3Q")  # offset, length, inflated length
_SCHEME_NONE, _SCHEME_ZSTD = 0, 2
_ALIGNMENT = 16  # a multiple of every texel block's size and of 4
_ZSTD_LEVEL = 5  # 9 takes twice as long for 0.5 % (RGB9E5) to 2.4 % (half) less
_PIECE_BYTES = 1 << 22
_REPAIR = "The texture is incomplete or damaged: export it again."


@dataclass(frozen=True)
class Ktx2Texture:
    """A 2D texture or array.

    Attributes:
        pages: (P, H, W, 3) float32 linear, origin top left.
        encoding: How a texel is stored.
        metadata: Key to text.
        smaller: Further mip levels, each as ``pages``.
    """

    pages: NDArray[np.float32]
    encoding: Encoding
    metadata: Mapping[str, str] = field(default_factory=dict)
    smaller: tuple[NDArray[np.float32], ...] = ()


@dataclass(frozen=True)
class _Shape:
    encoding: Encoding
    n_pages: int
    height: int
    width: int
    n_levels: int
    scheme: int

    def size_of(self, level: int) -> tuple[int, int, int]:
        """Pages, height and width."""
        return self.n_pages, max(self.height >> level, 1), max(self.width >> level, 1)


def encode_ktx2(
    pages: NDArray,
    encoding: Encoding = "rgb9e5",
    metadata: Mapping[str, str] | None = None,
    *,
    coverage: NDArray | None = None,
    n_levels: int = 1,
    supercompress: bool = True,
) -> bytes:
    """Encodes (P, H, W, 3) linear values ≥ 0; several pages become array layers.

    Values over the encoding's largest (65504 or 65408) are clamped to it. Alpha of half texels is 1.

    Args:
        pages: The values. For ``bc6h`` the brightest should be near 1.
        encoding: Of a texel.
        metadata: Keys and text beside KTXorientation and KTXwriter.
        coverage: (P, H, W), by how much texels count in smaller levels, and errors in ``bc6h``.
        n_levels: Mip levels; more than the size has are not made.
        supercompress: Whether levels are packed with zstd.
    """
    n_pages, height, width = pages.shape[:3]
    scheme = _SCHEME_ZSTD if supercompress else _SCHEME_NONE
    levels = max(min(n_levels, max(height, width).bit_length()), 1)
    shape = _Shape(encoding, n_pages, height, width, levels, scheme)
    packed, sizes = _packed_levels(pages, shape, coverage)
    descriptor = data_format_descriptor(encoding)
    pairs = _key_values({"KTXorientation": "rd", "KTXwriter": "irradia", **(metadata or {})})
    descriptor_at = len(_IDENTIFIER) + _HEADER.size + levels * _LEVEL.size
    pairs_at = descriptor_at + len(descriptor)
    layers = n_pages if n_pages > 1 else 0
    header = _HEADER.pack(
        *(VK_FORMAT[encoding], TYPE_BYTES[encoding], width, height, 0, layers, 1, levels, scheme),
        *(descriptor_at, len(descriptor), pairs_at, len(pairs), 0, 0),
    )
    index, body = _level_index(packed, sizes, pairs_at + len(pairs), 1 if supercompress else _ALIGNMENT)
    return b"".join((_IDENTIFIER, header, index, descriptor, pairs, *body))


def decode_ktx2(data: bytes, where: str = "KTX2 texture") -> Ktx2Texture:
    """Decodes what :func:`encode_ktx2` writes.

    Raises:
        InputError: Not KTX2, another format or shape than ours, cut short, or absurdly large.
    """
    if len(data) < len(_IDENTIFIER) + _HEADER.size + _LEVEL.size or not data.startswith(_IDENTIFIER):
        raise InputError(f"expected a KTX 2.0 texture, found {data[:12]!r}", where=where, fix=_REPAIR)
    fields = _HEADER.unpack_from(data, len(_IDENTIFIER))
    shape = _shape(fields, where)
    metadata = _parse_key_values(data, fields[11], fields[12], where)
    levels = []
    for level in range(shape.n_levels):
        size = shape.size_of(level)
        raw = _inflated(data, shape.scheme, level, level_bytes(shape.encoding, *size), where)
        levels.append(decode_level(raw, shape.encoding, *size))
    return Ktx2Texture(levels[0], shape.encoding, metadata, tuple(levels[1:]))


def _shape(fields: tuple[int, ...], where: str) -> _Shape:
    """What the header says, checked before anything of that size is made."""
    vk_format, _, width, height, depth, layers, faces, levels, scheme = fields[:9]
    encoding = _ENCODING_OF.get(vk_format)
    most_levels = max(width, height).bit_length()
    if encoding is None or depth != 0 or faces != 1 or layers > MAX_LAYERS or not 1 <= levels <= most_levels:
        raise InputError(
            f"expected a 2D texture or array of format {', '.join(map(str, _ENCODING_OF))}, found format "
            f"{vk_format}, depth {depth}, {layers} layers, {faces} faces, {levels} levels",
            where=where,
        )
    check_image_size(width, height, where, max(layers, 1))
    if scheme not in (_SCHEME_NONE, _SCHEME_ZSTD):
        raise InputError(f"expected supercompression 0 or 2 (zstd), found {scheme}", where=where)
    return _Shape(encoding, max(layers, 1), height, width, levels, scheme)


def _packed_levels(pages: NDArray, shape: _Shape, coverage: NDArray | None) -> tuple[list[bytes], list[int]]:
    """Each level's bytes as the file holds them, the largest first, and their inflated sizes."""
    packed, sizes = [], []
    weights = coverage
    for level in range(shape.n_levels):
        if level > 0:
            pages, weights = half_size(pages, np.ones(pages.shape[:3]) if weights is None else weights)
        raw = encode_level(pages, shape.encoding, None if coverage is None else weights)
        sizes.append(len(raw))
        zstd = shape.scheme == _SCHEME_ZSTD
        packed.append(_zstd(raw) if zstd else raw)
    return packed, sizes


def _zstd(raw: bytes) -> bytes:
    """Packed on all cores; zstd cuts its jobs by size, so the bytes don't depend on their number."""
    import zstandard

    return zstandard.ZstdCompressor(level=_ZSTD_LEVEL, threads=os.cpu_count() or 1).compress(raw)


def _level_index(
    packed: list[bytes], sizes: list[int], start: int, alignment: int
) -> tuple[bytes, list[bytes]]:
    """The index, largest level first, and the data with its padding, smallest level first."""
    entries, body = [], []
    at = start
    for data, size in zip(reversed(packed), reversed(sizes), strict=True):
        padding = -at % alignment
        entries.append(_LEVEL.pack(at + padding, len(data), size))
        body += [bytes(padding), data]
        at += padding + len(data)
    return b"".join(reversed(entries)), body


def _inflated(data: bytes, scheme: int, level: int, expected: int, where: str) -> bytes:
    """A level's texels, inflated no further than the header promises."""
    entry_at = len(_IDENTIFIER) + _HEADER.size + level * _LEVEL.size
    at, length, inflated = _LEVEL.unpack_from(data.ljust(entry_at + _LEVEL.size, b"\0"), entry_at)
    raw = data[at : at + length]
    if len(raw) != length or inflated != expected:
        raise InputError(
            f"expected {expected} bytes of texels, found {inflated} stored in {len(raw)} of {length}",
            where=where,
            fix=_REPAIR,
        )
    if scheme == _SCHEME_ZSTD:
        raw = _unzstd(raw, expected, where)
    if len(raw) != expected:
        raise InputError(f"expected {expected} bytes of texels, found {len(raw)}", where=where, fix=_REPAIR)
    return raw


def _unzstd(packed: bytes, expected: int, where: str) -> bytes:
    """Up to one byte more than expected, a piece at a time: a header's promise alone takes no memory."""
    import zstandard

    pieces, n_bytes = [], 0
    try:
        reader = zstandard.ZstdDecompressor().stream_reader(packed)
        while piece := reader.read(min(_PIECE_BYTES, expected + 1 - n_bytes)):
            pieces.append(piece)
            n_bytes += len(piece)
    except zstandard.ZstdError as error:
        raise InputError(f"its zstd data is damaged: {error}", where=where, fix=_REPAIR) from error
    return b"".join(pieces)


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
