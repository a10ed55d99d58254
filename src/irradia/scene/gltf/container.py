"""The two containers of glTF 2.0: .gltf, which is JSON, and .glb, which is chunks."""

from __future__ import annotations

import json
import struct
from typing import Any

from irradia.core.errors import InputError
from irradia.scene.gltf.document import Json

_GLB_MAGIC = b"glTF"
_CHUNK_JSON = 0x4E4F534A
_CHUNK_BIN = 0x004E4942
_EXPORT_AGAIN = "The file is incomplete or damaged: copy, download or export it again."


def parse_container(data: bytes, name: str) -> tuple[Json, bytes | None]:
    """Splits a file into its JSON and the .glb's binary chunk (None where there is none).

    Args:
        data: The whole file.
        name: File name for errors.

    Raises:
        InputError: It is neither glTF 2.0 container, or is cut short.
    """
    if data[:4] == _GLB_MAGIC:
        return _parse_glb(data, name)
    if data.lstrip(b"\xef\xbb\xbf \t\r\n")[:1] != b"{":
        raise InputError(
            f"expected a .glb (magic 'glTF') or a .gltf (JSON), found bytes {data[:4]!r}",
            where=name,
            fix="Irradia reads glTF 2.0; convert other formats with a modelling tool such as Blender.",
        )
    return _parse_json(data, name), None


def _parse_glb(data: bytes, name: str) -> tuple[Json, bytes | None]:
    if len(data) < 12:
        raise InputError(
            f"expected a 12-byte .glb header, found {len(data)} bytes", where=name, fix=_EXPORT_AGAIN
        )
    version, length = struct.unpack_from("<II", data, 4)
    if version != 2:
        raise InputError(f"expected .glb version 2, found {version}", where=name)
    if length > len(data):
        raise InputError(
            f"truncated .glb: its header says {length} bytes, the file has {len(data)}",
            where=name,
            fix=_EXPORT_AGAIN,
        )
    chunks = _glb_chunks(data[:length], name)
    if not chunks or chunks[0][0] != _CHUNK_JSON:
        raise InputError("expected the JSON chunk first", where=name, fix=_EXPORT_AGAIN)
    binary = chunks[1][1] if len(chunks) > 1 and chunks[1][0] == _CHUNK_BIN else None
    return _parse_json(chunks[0][1], name), binary


def _glb_chunks(data: bytes, name: str) -> list[tuple[int, bytes]]:
    """Type and payload of each chunk; up to 3 bytes after the last are taken as padding."""
    chunks, offset = [], 12
    while offset + 8 <= len(data):
        size, kind = struct.unpack_from("<II", data, offset)
        if size > len(data) - offset - 8:
            raise InputError(
                f"truncated .glb: the chunk at byte {offset} says {size} bytes, "
                f"{len(data) - offset - 8} are left",
                where=name,
                fix=_EXPORT_AGAIN,
            )
        chunks.append((kind, data[offset + 8 : offset + 8 + size]))
        offset += 8 + size
    return chunks


def _parse_json(data: bytes, name: str) -> Json:
    try:
        parsed = json.loads(data.decode("utf-8-sig"), parse_constant=_refuse_constant)
    except (ValueError, RecursionError) as error:
        raise InputError(f"its JSON can't be parsed: {error}", where=name, fix=_EXPORT_AGAIN) from error
    if not isinstance(parsed, dict):
        raise InputError("expected a JSON object at the top", where=name)
    return parsed


def _refuse_constant(constant: str) -> Any:
    raise ValueError(f"{constant} is no JSON number")
