"""A neural field inside IRRADIA_lighting: the very file that it also is on disk, in a buffer view."""

from __future__ import annotations

import copy
from pathlib import Path

from irradia.core.errors import InputError
from irradia.core.files import write_atomic
from irradia.export.container import glb_container
from irradia.export.lighting_extension import NAME, VERSION
from irradia.export.slots import Slots
from irradia.field.native_fields import StoredField, decode_field
from irradia.formats.field_safetensors import ZSTD_MAGIC
from irradia.scene.gltf import GltfDocument, read_document
from irradia.scene.gltf.accessors import Accessors
from irradia.scene.gltf.document import Json
from irradia.scene.gltf.view import JsonView

PLAIN, PACKED = "application/vnd.safetensors", "application/zstd"
MAX_BYTES = 1 << 30


def add_field(json: Json, slots: Slots, data: bytes) -> None:
    """Adds a field to the document's root, in place of one that is there.

    Args:
        json: The document being written.
        slots: Where the bytes go.
        data: A ``.safetensors`` or ``.safetensors.zst`` of ours.

    Raises:
        InputError: They are no field.
    """
    stored = decode_field(data).field
    entry: Json = {
        "mimeType": PACKED if data.startswith(ZSTD_MAGIC) else PLAIN,
        "bufferView": -1,
        "mode": stored.spec.mode,
        "light": stored.frame.quantity,
        "min": stored.frame.aabb[0].tolist(),
        "max": stored.frame.aabb[1].tolist(),
    }
    slots.add_blob(data, lambda view: entry.update(bufferView=view))
    root = json.setdefault("extensions", {}).setdefault(NAME, {"version": VERSION})
    root["field"] = entry


def baked_field_bytes(document: GltfDocument) -> bytes | None:
    """The file of a baked document's field as it lies there, or None where it has none.

    Raises:
        InputError: The document is damaged.
    """
    entry = _entry(document)
    if entry is None:
        return None
    data = Accessors(document).read_view(entry.integer("bufferView"))
    if len(data) > MAX_BYTES:
        raise InputError(f"expected at most {MAX_BYTES} bytes, found {len(data)}", where=entry.pointer)
    return bytes(data)


def read_baked_field(document: GltfDocument) -> StoredField | None:
    """The field of a baked document, or None where it has none.

    Raises:
        InputError: It is damaged, or isn't what the document says.
    """
    entry, data = _entry(document), baked_field_bytes(document)
    if entry is None or data is None:
        return None
    mime_type = entry.choice("mimeType", (PLAIN, PACKED))
    stored = decode_field(data, entry.pointer)
    is_packed = data[:4] == ZSTD_MAGIC
    low, high = stored.field.frame.aabb.tolist()
    says = (
        mime_type == PACKED,
        entry.string("mode", ""),
        entry.string("light", ""),
        list(entry.numbers("min", (0.0,) * 3)),
        list(entry.numbers("max", (0.0,) * 3)),
    )
    holds = (is_packed, stored.field.spec.mode, stored.field.frame.quantity, low, high)
    if says != holds:
        raise InputError("what it says of its field isn't what the field's file says", where=entry.pointer)
    return stored


def _entry(document: GltfDocument) -> JsonView | None:
    """What a document says of its field."""
    extension = JsonView(document.json).extension(NAME)
    return extension.object("field") if extension is not None and extension.has("field") else None


def read_baked_document(source: Path | str) -> GltfDocument:
    """A .glb that `irradia bake` wrote.

    Raises:
        InputError: It can't be read, or isn't baked.
    """
    document = read_document(Path(source))
    if JsonView(document.json).extension(NAME) is None:
        raise InputError(
            f"expected a baked scene ({NAME})", where=str(source), fix="Make one with `irradia bake`."
        )
    return document


def put_field(source: Path | str, data: bytes, target: Path | str | None = None) -> int:
    """Writes a baked .glb again with a field in it; everything else keeps its meaning and its index.

    Args:
        source: A .glb that `irradia bake` wrote.
        data: The field's file.
        target: Where to; None replaces the source.

    Returns:
        Bytes written.

    Raises:
        InputError: The source isn't baked, or the data no field.
    """
    document = read_baked_document(source)
    json = copy.deepcopy(document.json)
    slots = Slots(json, Accessors(document))
    add_field(json, slots, data)
    written = glb_container(json, slots.finish())
    with write_atomic(target or source) as stream:
        stream.write(written)
    return len(written)
