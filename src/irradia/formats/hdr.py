"""Radiance .hdr pictures: RGBE, flat or run-length encoded in the old or the new way.

Ward, "Real Pixels", Graphics Gems II, 1991, and the file format notes of Radiance. A mantissa m with
exponent e stands for m · 2^(e−136), as stb_image and OpenImageIO read it. three.js divides by 255 where
that divides by 256, and so shows pictures 0.4 % brighter; Radiance's own tools add half a step to m, which
brightens black channels.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from irradia.core.errors import InputError
from irradia.core.files import write_atomic
from irradia.formats import hdr_runs
from irradia.formats.bands import map_bands
from irradia.formats.limits import check_image_size

U8 = NDArray[np.uint8]
_MAGIC = (b"#?RADIANCE", b"#?RGBE")
_SIZE = re.compile(rb"([+-])([XY]) (\d{1,9}) ([+-])([XY]) (\d{1,9})$")
_BAND_ROWS = 64
_REPAIR = "The file is incomplete or damaged: copy or download it again."


@dataclass(frozen=True)
class _Header:
    """Size and orientation as scanlines come, where pixels start, and the recorded exposure."""

    n_scanlines: int
    scanline_px: int
    columns_first: bool
    flip_scanlines: bool
    flip_pixels: bool
    pixels_at: int
    exposure: float
    variables: Mapping[str, str]


@dataclass(frozen=True)
class HdrImage:
    """A picture with what its header says.

    Attributes:
        rgb: (H, W, 3) float32, row 0 at the top, recorded exposures divided out.
        metadata: The header's ``NAME=value`` lines, the last of each name.
    """

    rgb: NDArray[np.float32]
    metadata: Mapping[str, str] = field(default_factory=dict)


def read_hdr(path: Path | str) -> NDArray[np.float32]:
    """Reads a picture as (H, W, 3) float32, row 0 at the top, recorded exposures divided out.

    Raises:
        InputError: No such file, no Radiance RGBE picture, cut short, or absurdly large.
    """
    return read_hdr_image(path).rgb


def read_hdr_image(path: Path | str) -> HdrImage:
    """As :func:`read_hdr`, with the header's variables."""
    file = Path(path)
    try:
        data = file.read_bytes()
    except OSError as error:
        raise InputError(f"can't read this picture: {error.strerror}", where=str(file)) from error
    return decode_hdr_image(data, str(file))


def decode_hdr(data: bytes, where: str = "picture") -> NDArray[np.float32]:
    """Decodes a whole file; see :func:`read_hdr`."""
    return decode_hdr_image(data, where).rgb


def decode_hdr_image(data: bytes, where: str = "picture") -> HdrImage:
    """Decodes a whole file; see :func:`read_hdr_image`."""
    header = _parse_header(data, where)
    try:
        rgbe = _decode_scanlines(data, header)
    except (IndexError, ValueError) as error:
        raise InputError(f"its pixels can't be decoded: {error}", where=where, fix=_REPAIR) from error
    rgb = linear_from_rgbe(rgbe) / np.float32(header.exposure)
    rgb = rgb[:: -1 if header.flip_scanlines else 1, :: -1 if header.flip_pixels else 1]
    upright = np.ascontiguousarray(rgb.swapaxes(0, 1) if header.columns_first else rgb)
    return HdrImage(upright, header.variables)


def write_hdr(path: Path | str, rgb: NDArray, metadata: Mapping[str, str] | None = None) -> None:
    """Writes (H, W, 3) linear values as RGBE, rounded to nearest; negative ones and NaN become 0.

    Run-length encoded the new way where the width allows it, else flat. Flat pixels of ours can't be
    taken for runs: those start with mantissas under 128 in the three first bytes, and the largest
    mantissa of a pixel is at least 128.

    Args:
        path: The file.
        rgb: The pixels, row 0 at the top.
        metadata: Further ``NAME=value`` lines of the header.
    """
    height, width = rgb.shape[:2]
    lines = "".join(f"{name}={value}\n" for name, value in sorted((metadata or {}).items()))
    head = f"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n{lines}\n-Y {height} +X {width}\n"

    def encode(band: slice) -> bytes:
        rgbe = rgbe_from_linear(rgb[band])
        return hdr_runs.encode_scanlines(rgbe) if width in hdr_runs.WIDTHS else rgbe.tobytes()

    with write_atomic(path) as stream:
        stream.write(head.encode("ascii"))
        stream.writelines(map_bands(encode, height, _BAND_ROWS))


def linear_from_rgbe(rgbe: U8) -> NDArray[np.float32]:
    """(…, 4) shared-exponent bytes to (…, 3) linear values."""
    scale = np.ldexp(np.float32(1.0), rgbe[..., 3:].astype(np.int32) - 136)
    return np.where(rgbe[..., 3:] == 0, np.float32(0.0), rgbe[..., :3].astype(np.float32) * scale)


def rgbe_from_linear(rgb: NDArray) -> U8:
    """(…, 3) linear values to (…, 4) bytes; what is too small becomes 0, too large the largest."""
    values = np.clip(np.nan_to_num(np.asarray(rgb, np.float64)), 0.0, 255.0 * 2.0**119)
    largest = values.max(axis=-1)
    exponent = np.frexp(largest)[1]
    # Rounding may carry the largest mantissa to 256: it then belongs to the next exponent.
    exponent += np.round(np.ldexp(largest, 8 - exponent)) >= 256
    mantissa = np.round(np.ldexp(values, 8 - exponent[..., None]))
    rgbe = np.concatenate([mantissa, exponent[..., None] + 128.0], axis=-1)
    rgbe[(exponent < -127) | (largest == 0.0)] = 0.0
    return rgbe.astype(np.uint8)


def _parse_header(data: bytes, where: str) -> _Header:
    if not data.startswith(_MAGIC):
        raise InputError(f"expected a Radiance picture (#?RADIANCE), found {data[:10]!r}", where=where)
    head, blank, rest = data.partition(b"\n\n")
    size_line, newline, _ = rest[:64].partition(b"\n")
    size = _SIZE.match(size_line)
    if not blank or not newline or size is None or size[2] == size[5]:
        raise InputError("expected a size line such as '-Y 512 +X 1024'", where=where, fix=_REPAIR)
    n_scanlines, scanline_px = int(size[3]), int(size[6])
    lines = head.split(b"\n")[1:]
    check_image_size(scanline_px, n_scanlines, where)
    return _Header(
        n_scanlines=n_scanlines,
        scanline_px=scanline_px,
        columns_first=size[2] == b"X",
        flip_scanlines=size[1] == (b"+" if size[2] == b"Y" else b"-"),
        flip_pixels=size[4] == (b"+" if size[5] == b"Y" else b"-"),
        pixels_at=len(head) + 2 + len(size_line) + 1,
        exposure=_exposure(lines, where),
        variables=_variables(lines),
    )


def _variables(lines: list[bytes]) -> dict[str, str]:
    pairs = (line.decode("utf-8", "replace").partition("=") for line in lines if not line.startswith(b"#"))
    return {name.strip(): value.strip() for name, separator, value in pairs if separator}


def _exposure(lines: list[bytes], where: str) -> float:
    """The product of all EXPOSURE lines; also refuses XYZE pictures."""
    exposure = 1.0
    for key, _, value in (line.partition(b"=") for line in lines):
        if key.strip() == b"FORMAT" and value.strip() != b"32-bit_rle_rgbe":
            raise InputError(
                f"expected FORMAT=32-bit_rle_rgbe, found {value.strip()[:40].decode('ascii', 'replace')}",
                where=where,
                fix="Convert it to RGBE, for example with Radiance's ra_xyze -r.",
            )
        if key.strip() == b"EXPOSURE":
            try:
                exposure *= float(value)
            except ValueError as error:
                raise InputError(f"EXPOSURE is no number: {value[:40]!r}", where=where) from error
    if not np.isfinite(exposure) or exposure <= 0.0:
        raise InputError(f"expected a positive exposure, found {exposure}", where=where)
    return exposure


def _decode_scanlines(data: bytes, header: _Header) -> U8:
    """(n_scanlines, scanline_px, 4); raises IndexError or ValueError where data is bad."""
    width, at = header.scanline_px, header.pixels_at
    pixels = np.empty((header.n_scanlines, width, 4), np.uint8)
    flat = pixels.size
    for row in range(header.n_scanlines):
        if width in hdr_runs.WIDTHS and data[at] == 2 and data[at + 1] == 2 and data[at + 2] < 128:
            if data[at + 2] << 8 | data[at + 3] != width:
                raise ValueError(f"scanline {row} has another width")
            planes, at = _decode_new_scanline(data, at + 4, width)
            pixels[row] = np.frombuffer(planes, np.uint8).reshape(4, width).T
        elif row == 0 and len(data) - at == flat and not _has_old_runs(data, at):
            return np.frombuffer(data, np.uint8, flat, at).reshape(pixels.shape)
        else:
            line, at = _decode_old_scanline(data, at, width)
            pixels[row] = np.frombuffer(line, np.uint8).reshape(width, 4)
    return pixels


def _has_old_runs(data: bytes, at: int) -> bool:
    mantissas = np.frombuffer(data, np.uint8, offset=at).reshape(-1, 4)[:, :3]
    return bool(np.any(np.all(mantissas == 1, axis=1)))


def _decode_new_scanline(data: bytes, at: int, width: int) -> tuple[bytearray, int]:
    """Four planes of runs and literals, one after another."""
    out = bytearray()
    for end in (width, 2 * width, 3 * width, 4 * width):
        while len(out) < end:
            count = data[at]
            if count > 128:
                out += data[at + 1 : at + 2] * (count - 128)
                at += 2
            else:
                out += data[at + 1 : at + 1 + count]
                at += 1 + count
            if count == 0 or len(out) > end or at > len(data):
                raise ValueError("a run is empty, leaves its scanline, or is cut short")
    return out, at


def _decode_old_scanline(data: bytes, at: int, width: int) -> tuple[bytearray, int]:
    """Pixels in which (1, 1, 1, n) repeats the one before n times; in a row, n gains 8 bits each."""
    out = bytearray()
    shift = 0
    while len(out) < 4 * width:
        pixel = data[at : at + 4]
        at += 4
        if len(pixel) < 4:
            raise ValueError("scanlines are missing")
        if pixel[:3] != b"\x01\x01\x01":
            out += pixel
            shift = 0
            continue
        count = pixel[3] << shift
        if not out or len(out) + 4 * count > 4 * width:
            raise ValueError("a run has nothing to repeat, or leaves its scanline")
        out += out[-4:] * count
        shift += 8
    return out, at
