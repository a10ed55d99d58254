"""What stands before the rows of a ``.samples`` file; :mod:`irradia.formats.samples` shows the bytes."""

from __future__ import annotations

import json
import struct
from dataclasses import asdict
from typing import IO

from irradia.core.errors import InputError
from irradia.formats.sample_rows import SampleInfo

VERSION = 1
MAGIC = b"\x93SAMPLES"
BLOCK_BYTES = 4096
MAX_INFO_BYTES = 1 << 24
GROWING = (1 << 64) - 1
COUNT_AT = 16  # offset of the number of rows

_HEADER = struct.Struct("<8sIIQII")
HEADER_BYTES = _HEADER.size


def encode_header(info: SampleInfo, n_rows: int) -> bytes:
    """Everything before the rows."""
    text = json.dumps(asdict(info), sort_keys=True, allow_nan=False).encode()
    offset = -(-(_HEADER.size + len(text)) // BLOCK_BYTES) * BLOCK_BYTES
    start = _HEADER.pack(MAGIC, VERSION, info.n_columns, n_rows, offset, len(text))
    return (start + text).ljust(offset, b"\0")


def read_header(start: bytes, stream: IO[bytes], where: str) -> tuple[SampleInfo, int, int]:
    """Info, number of rows (``GROWING`` while there may come more), and where rows begin.

    Args:
        start: The file's first ``HEADER_BYTES``, or all there is.
        stream: Behind them.
        where: The file, for errors.

    Raises:
        InputError: It is no such file, or damaged.
    """
    if len(start) < _HEADER.size or not start.startswith(MAGIC):
        raise InputError(
            f"expected a dataset, found {_looks_like(start)}",
            where=where,
            fix="Make one with `irradia sample`, or give a .bin of positions and light.",
        )
    _, version, n_columns, n_rows, offset, n_text = _HEADER.unpack(start)
    if version != VERSION:
        raise InputError(f"expected version {VERSION}, found {version}", where=where)
    text = stream.read(min(n_text, MAX_INFO_BYTES))
    header_fits = offset % BLOCK_BYTES == 0 and _HEADER.size + n_text <= offset
    if not header_fits or len(text) != n_text or n_text > MAX_INFO_BYTES:
        raise InputError(f"its header is damaged: {n_text} bytes of JSON before {offset}", where=where)
    info = _info(text, where)
    if n_columns != info.n_columns:
        raise InputError(f"expected {info.n_columns} columns, found {n_columns}", where=where)
    return info, n_rows, offset


def _looks_like(start: bytes) -> str:
    if not start:
        return "an empty file"
    printable = sum(32 <= byte < 127 or byte in b"\t\r\n" for byte in start)
    return "text" if printable == len(start) else f"bytes that begin {start[:8].hex(' ')}"


def _info(text: bytes, where: str) -> SampleInfo:
    try:
        values = json.loads(text)
        low, high = values.pop("aabb")
        return SampleInfo(aabb=(tuple(low), tuple(high)), **values)
    except (ValueError, TypeError, KeyError, AttributeError, OverflowError, RecursionError) as error:
        raise InputError(f"its header is damaged: {error}", where=where) from error
    except InputError as error:
        raise InputError(error.message, where=where) from error
