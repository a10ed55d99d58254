"""Fields as safetensors: named tensors, and one JSON object that says what they are.

The container is that of Hugging Face's safetensors: a length, a JSON header, the tensors' bytes. Its
metadata has the single key ``irradia.field``, whose value is a JSON object with at least ``version``;
docs/field-files.md gives the rest. With a single key and JSON in sorted order, the same field has the same
bytes.

The object's ``provenance`` notes the SHA-256 of the bytes behind the header, so that a flipped bit is damage
and no other light. Files without it, of earlier versions, are believed.

A file may be packed by zstd as a whole (``.safetensors.zst``): readers tell by its first bytes.
"""

from __future__ import annotations

import hashlib
import json
import struct
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from irradia.core.errors import InputError

VERSION = 1
KEY = "irradia.field"
CHECKSUM = "tensors_sha256"
ZSTD_MAGIC = b"\x28\xb5\x2f\xfd"
ZSTD_LEVEL = 15  # 19 gains another 0.2 % and takes twelve times as long: half a minute for 24 MB
MAX_BYTES = 1 << 32  # unpacked: more is damage, or an attack

_TYPES = {"F16": "<f2", "F32": "<f4", "I8": "i1", "U8": "u1"}


@dataclass(frozen=True)
class FieldTensors:
    """What such a file holds.

    Attributes:
        about: The JSON object, without its version.
        tensors: float16, float32, int8 or uint8 by name.
    """

    about: Mapping[str, Any]
    tensors: Mapping[str, NDArray[Any]]


def encode_tensors(content: FieldTensors, *, compress: bool = False) -> bytes:
    """The bytes of a file.

    Args:
        content: What it shall hold.
        compress: Packs all of it with zstd.
    """
    from safetensors.numpy import save

    tensors = {name: np.ascontiguousarray(values) for name, values in content.tensors.items()}
    origin = {**content.about.get("provenance", {}), CHECKSUM: _checksum(save(tensors))}
    about = {"version": VERSION, **content.about, "provenance": origin}
    text = json.dumps(about, sort_keys=True, allow_nan=False)
    data = save(tensors, metadata={KEY: text})
    return _compress(data) if compress else data


def decode_tensors(data: bytes, where: str = "field") -> FieldTensors:
    """Reads a file, packed or not; numbers are checked to be finite.

    Raises:
        InputError: It is cut short, damaged, of another version, or no field of ours.
    """
    from safetensors import SafetensorError, deserialize

    if data.startswith(ZSTD_MAGIC):
        data = _decompress(data, where)
    about = _about(data, where)
    try:
        stored = deserialize(data)
    except SafetensorError as error:
        raise InputError(f"it is damaged: {error}", where=where, fix="Export or train it again.") from error
    noted = _take_checksum(about)
    if noted is not None and noted != _checksum(data):
        raise InputError(
            "its weights are damaged: they aren't those whose checksum it notes",
            where=where,
            fix="Copy, export or train it again.",
        )
    return FieldTensors(about, {name: _tensor(name, entry, where) for name, entry in stored})


def _checksum(data: bytes) -> str:
    """SHA-256 of the bytes behind the container's header."""
    (n_bytes,) = struct.unpack_from("<Q", data)
    return hashlib.sha256(memoryview(data)[8 + n_bytes :]).hexdigest()


def _take_checksum(about: Mapping[str, Any]) -> Any:
    """What the provenance notes, which is the file's own business: it goes no further."""
    origin = about.get("provenance")
    return origin.pop(CHECKSUM, None) if isinstance(origin, dict) else None


def _about(data: bytes, where: str) -> Mapping[str, Any]:
    """The JSON object of the metadata."""
    metadata = _header(data, where).get("__metadata__")
    if not isinstance(metadata, dict) or KEY not in metadata:
        raise InputError(
            f"expected a field, found safetensors without {KEY!r}",
            where=where,
            fix="Give a file that `irradia train` wrote.",
        )
    about = _json_object(metadata[KEY], f"the metadata {KEY!r}", where)
    version = about.pop("version", None)
    if version != VERSION:
        raise InputError(f"expected a field of version {VERSION}, found {version!r}", where=where)
    return about


def _header(data: bytes, where: str) -> dict[str, Any]:
    """The container's own JSON."""
    if len(data) < 8:
        raise InputError(f"expected a field, found a file of {len(data)} bytes", where=where)
    (n_bytes,) = struct.unpack_from("<Q", data)
    if n_bytes > len(data) - 8:
        raise InputError(
            f"expected a field as safetensors, found no header: it would have {n_bytes} bytes of {len(data)}",
            where=where,
            fix="Give a file that `irradia train` wrote; it may have been cut short.",
        )
    return _json_object(data[8 : 8 + n_bytes], "its header", where)


def _json_object(text: str | bytes, what: str, where: str) -> dict[str, Any]:
    try:
        found = json.loads(text)
    except (ValueError, TypeError, RecursionError) as error:
        raise InputError(f"{what} is damaged: {error}", where=where) from error
    if not isinstance(found, dict):
        raise InputError(f"{what} is damaged: it is no object", where=where)
    return found


def _tensor(name: str, entry: Mapping[str, Any], where: str) -> NDArray[Any]:
    if entry["dtype"] not in _TYPES:
        known = ", ".join(_TYPES)
        raise InputError(f"expected {name!r} to be of {known}, found {entry['dtype']}", where=where)
    values = np.frombuffer(entry["data"], _TYPES[entry["dtype"]]).reshape(entry["shape"])
    if values.dtype.kind == "f" and not np.isfinite(values).all():
        raise InputError(f"some numbers of {name!r} are infinite or none", where=where)
    return values


def _compress(data: bytes) -> bytes:
    import zstandard

    return zstandard.ZstdCompressor(level=ZSTD_LEVEL, write_content_size=True).compress(data)


def _decompress(data: bytes, where: str) -> bytes:
    """Unpacks what says how long it is, and no more than that."""
    import zstandard

    try:
        n_bytes = zstandard.frame_content_size(data)
        if not 0 <= n_bytes <= MAX_BYTES:
            raise InputError(f"expected at most {MAX_BYTES} bytes unpacked, found {n_bytes}", where=where)
        unpacked = zstandard.ZstdDecompressor().decompress(data, allow_extra_data=False)
    except zstandard.ZstdError as error:
        raise InputError(f"it can't be unpacked: {error}", where=where) from error
    return unpacked
