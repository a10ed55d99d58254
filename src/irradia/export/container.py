"""The .glb container: JSON and one binary chunk."""

from __future__ import annotations

import json as json_text
import struct

from irradia.scene.gltf.document import Json

_JSON_CHUNK, _BINARY_CHUNK = 0x4E4F534A, 0x004E4942


def glb_container(json: Json, binary: bytes) -> bytes:
    """A .glb's bytes, its chunks padded to 4 bytes."""
    text = json_text.dumps(json, ensure_ascii=False, allow_nan=False, separators=(",", ":")).encode()
    text += b" " * (-len(text) % 4)
    binary += bytes(-len(binary) % 4)
    chunks = struct.pack("<II", len(text), _JSON_CHUNK) + text
    if binary:
        chunks += struct.pack("<II", len(binary), _BINARY_CHUNK) + binary
    return struct.pack("<4sII", b"glTF", 2, 12 + len(chunks)) + chunks
