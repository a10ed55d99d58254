"""PNG: written here, so that the same pixels are the same bytes; read with Pillow.

This work is based on: PNG Specification (third edition), W3C, 2025, sections 9 (filters) and 12.7
(the smallest sum of absolute differences chooses a row's filter).
"""

from __future__ import annotations

import struct
import zlib
from collections.abc import Mapping
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from irradia.core.colour import linear_from_srgb
from irradia.core.errors import InputError
from irradia.core.files import write_atomic
from irradia.formats.bands import map_bands
from irradia.formats.limits import check_image_size

U8 = NDArray[np.uint8]
_SIGNATURE = b"\x89PNG\r\n\x1a\n"
_ZLIB_LEVEL = 4  # 6 takes 3.6 times as long for 4 % less
_BAND_BYTES = 1 << 21
_ZLIB_HEADER, _ADLER_BASE = b"\x78\x5e", 65521
_RAW_DEFLATE = -15  # window bits; negative ones ask zlib for no header and no checksum
_COLOUR_TYPE = {1: 0, 2: 4, 3: 2, 4: 6}  # channels → grey, grey + alpha, RGB, RGBA


def write_png(path: Path | str, pixels: NDArray, text: Mapping[str, str] | None = None) -> None:
    """Writes :func:`encode_png`'s bytes."""
    data = encode_png(pixels, text)
    with write_atomic(path) as stream:
        stream.write(data)


def encode_png(pixels: NDArray, text: Mapping[str, str] | None = None) -> bytes:
    """A PNG of (H, W) or (H, W, 1 … 4) uint8 or uint16 pixels, as they are: nothing is sRGB-coded here.

    ``text`` maps Latin-1 keywords of up to 79 characters to any text, one iTXt chunk each.
    """
    planes = pixels if pixels.ndim == 3 else pixels[..., None]
    height, width, n_channels = planes.shape
    depth = planes.dtype.itemsize * 8
    if planes.dtype not in (np.uint8, np.uint16) or n_channels not in _COLOUR_TYPE:
        raise InputError(f"expected 1 to 4 channels of uint8 or uint16, found {planes.shape} {planes.dtype}")
    check_image_size(width, height, "PNG")
    head = struct.pack(">IIBBBBB", width, height, depth, _COLOUR_TYPE[n_channels], 0, 0, 0)
    rows = np.ascontiguousarray(planes, planes.dtype.newbyteorder(">")).view(np.uint8).reshape(height, -1)
    body = _compress(rows, n_channels * depth // 8)
    notes = b"".join(_chunk(b"iTXt", _international_text(*item)) for item in sorted((text or {}).items()))
    return _SIGNATURE + _chunk(b"IHDR", head) + notes + _chunk(b"IDAT", body) + _chunk(b"IEND", b"")


def read_png_linear(path: Path | str) -> NDArray[np.float32]:
    """Reads an sRGB-coded PNG (or JPEG) as (H, W, 3) linear values in [0, 1]; alpha is dropped.

    Grey keeps 16 bits; Pillow gives 16-bit colour as its high 8 bits.

    Raises:
        InputError: No such file, no image, cut short, or absurdly large.
    """
    from PIL import Image

    try:
        with Image.open(path) as image:
            check_image_size(*image.size, str(path))
            wide = image.mode.startswith("I")
            coded = np.asarray(image if wide else image.convert("RGB"), np.float32)
    except (OSError, ValueError, SyntaxError, Image.DecompressionBombError) as error:
        raise InputError(f"the image can't be read: {error}", where=str(path)) from error
    if wide:
        coded = np.repeat(coded[..., None], 3, axis=-1)
    return linear_from_srgb(coded / np.float32(65535.0 if wide else 255.0))


def _international_text(keyword: str, text: str) -> bytes:
    """Uncompressed, of no language."""
    return keyword.encode("latin-1") + bytes(5) + text.encode("utf-8")


def _chunk(kind: bytes, body: bytes) -> bytes:
    return struct.pack(">I", len(body)) + kind + body + struct.pack(">I", zlib.crc32(kind + body))


def _compress(rows: U8, pixel_bytes: int) -> bytes:
    """One zlib stream of filtered rows, bands side by side: filters take 20 bytes per byte on the way.

    Bands are deflated apart and end on a byte, so that they can be joined; that costs under 0.1 %.
    """

    def compress(band: slice) -> tuple[bytes, int, int]:
        above = rows[band.start - 1 : band.start] if band.start else np.zeros((1, rows.shape[1]), np.uint8)
        raw = _filtered(rows[band], above, pixel_bytes).tobytes()
        deflate = zlib.compressobj(_ZLIB_LEVEL, zlib.DEFLATED, _RAW_DEFLATE)
        flush = zlib.Z_FINISH if band.stop == len(rows) else zlib.Z_SYNC_FLUSH
        return deflate.compress(raw) + deflate.flush(flush), zlib.adler32(raw), len(raw)

    bands = map_bands(compress, len(rows), max(_BAND_BYTES // rows.shape[1], 1))
    checksum = 1
    for _, adler, n_bytes in bands:
        checksum = _joined_adler(checksum, adler, n_bytes)
    return b"".join((_ZLIB_HEADER, *(data for data, _, _ in bands), struct.pack(">I", checksum)))


def _joined_adler(first: int, second: int, second_bytes: int) -> int:
    """Adler-32 of two runs of bytes behind each other, from theirs (RFC 1950, section 8)."""
    low = (first & 0xFFFF) + (second & 0xFFFF) - 1
    high = (first >> 16) + (second >> 16) + second_bytes * ((first & 0xFFFF) - 1)
    return high % _ADLER_BASE << 16 | low % _ADLER_BASE


def _filtered(rows: U8, above: U8, pixel_bytes: int) -> U8:
    """(H, 1 + row bytes): each row filtered in the way that leaves the smallest differences."""
    best = np.zeros((len(rows), rows.shape[1] + 1), np.uint8)
    lowest = np.full(len(rows), np.iinfo(np.int64).max)
    for kind, prediction in enumerate(_predictions(rows, above, pixel_bytes)):
        residual = rows - prediction
        cost = np.abs(residual.view(np.int8).astype(np.int16)).sum(axis=1, dtype=np.int64)
        better = cost < lowest
        lowest = np.where(better, cost, lowest)
        best[better, 0] = kind
        best[better, 1:] = residual[better]
    return best


def _predictions(rows: U8, above: U8, pixel_bytes: int) -> tuple[U8, ...]:
    """What each of the five filters subtracts: nothing, left, up, their mean, Paeth's choice."""
    up = np.concatenate([above, rows[:-1]])
    left, corner = np.zeros_like(rows), np.zeros_like(rows)
    left[:, pixel_bytes:] = rows[:, :-pixel_bytes]
    corner[:, pixel_bytes:] = up[:, :-pixel_bytes]
    a, b, c = (plane.astype(np.int16) for plane in (left, up, corner))
    to_a, to_b, to_c = np.abs(b - c), np.abs(a - c), np.abs(a + b - 2 * c)
    paeth = np.where((to_a <= to_b) & (to_a <= to_c), left, np.where(to_b <= to_c, up, corner))
    return np.zeros_like(rows), left, up, ((a + b) // 2).astype(np.uint8), paeth
