"""Reads a file into a :class:`GltfDocument`: nothing is interpreted, everything is there."""

from __future__ import annotations

from pathlib import Path

from irradia.core.errors import InputError
from irradia.scene.gltf.container import parse_container
from irradia.scene.gltf.document import GltfDocument, Json
from irradia.scene.gltf.uris import resolve_uri
from irradia.scene.gltf.view import JsonView

MESHOPT_EXTENSIONS = ("EXT_meshopt_compression", "KHR_meshopt_compression")


def read_document(path: Path | str) -> GltfDocument:
    """Reads a .gltf or .glb with all buffers and images that it refers to.

    Raises:
        InputError: The file, or one that it refers to, is missing, cut short or no glTF 2.0.
    """
    path = Path(path)
    try:
        data = path.read_bytes()
    except OSError as error:
        raise InputError(f"can't read this scene: {error.strerror}", where=str(path)) from error
    json, binary = parse_container(data, path.name)
    return make_document(json, binary, base=path.parent, name=path.stem)


def make_document(
    json: Json, binary: bytes | None = None, *, base: Path | None = None, name: str = "scene"
) -> GltfDocument:
    """Resolves the buffers and images of parsed JSON.

    Args:
        json: The parsed document.
        binary: The .glb's binary chunk, which is buffer 0.
        base: Folder that relative URIs refer to.
        name: What the scene is called.
    """
    root = JsonView(json)
    _check_version(root, name)
    buffers = tuple(_read_buffer(view, binary, base) for view in root.items("buffers"))
    images = tuple(_read_image(root, view, buffers, base) for view in root.items("images"))
    return GltfDocument(json=json, buffers=buffers, images=images, base=base, name=name)


def _check_version(root: JsonView, name: str) -> None:
    asset = root.object("asset")
    version = asset.string("minVersion") or asset.string("version", "missing")
    if version != "2.0":
        raise InputError(
            f"expected glTF 2.0, found version '{version}'",
            where=f"{name}: /asset/version",
            fix="glTF 1.0 is upgraded by: npx gltf-pipeline -i old.gltf -o new.glb",
        )


def _read_buffer(view: JsonView, binary: bytes | None, base: Path | None) -> bytes:
    """A buffer's bytes; none for the placeholder that stands for meshopt's uncompressed data."""
    length = view.integer("byteLength", minimum=1)
    if view.has("uri"):
        data = resolve_uri(view.string("uri"), base, f"{view.pointer}/uri")
    elif view.pointer == "/buffers/0" and binary is not None:
        data = binary
    elif any(view.extension(name) is not None for name in MESHOPT_EXTENSIONS):
        return b""
    else:
        raise InputError(
            "this buffer has no uri, and there is no binary chunk to take it from", where=view.pointer
        )
    if len(data) < length:
        raise InputError(f"expected {length} bytes, found {len(data)}", where=view.pointer)
    return data if len(data) == length else data[:length]


def _read_image(root: JsonView, view: JsonView, buffers: tuple[bytes, ...], base: Path | None) -> bytes:
    if view.has("uri"):
        return resolve_uri(view.string("uri"), base, f"{view.pointer}/uri")
    buffer_view = root.element("bufferViews", view.integer("bufferView"))
    buffer = buffer_view.integer("buffer")
    if buffer >= len(buffers):
        raise InputError(
            f"expected an index below {len(buffers)}, found {buffer}", where=f"{buffer_view.pointer}/buffer"
        )
    start, length = buffer_view.integer("byteOffset", 0), buffer_view.integer("byteLength", minimum=1)
    if start + length > len(buffers[buffer]):
        raise InputError(
            f"bytes {start} to {start + length} lie outside the buffer of {len(buffers[buffer])} bytes",
            where=buffer_view.pointer,
        )
    return buffers[buffer][start : start + length]
