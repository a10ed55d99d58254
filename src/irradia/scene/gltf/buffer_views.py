"""Bytes of buffer views, meshopt-compressed ones decoded."""

from __future__ import annotations

from irradia.core.errors import InputError
from irradia.scene.gltf.document import GltfDocument
from irradia.scene.gltf.read import MESHOPT_EXTENSIONS
from irradia.scene.gltf.view import JsonView


class BufferViews:
    """Reads the buffer views of one document; each is decoded once."""

    def __init__(self, document: GltfDocument) -> None:
        self._root = JsonView(document.json)
        self._buffers = document.buffers
        self._decoded: dict[int, memoryview] = {}

    def read(self, index: int) -> memoryview:
        """The uncompressed bytes of buffer view ``index``.

        Raises:
            InputError: It doesn't exist, reaches outside its buffer or is damaged.
        """
        if index not in self._decoded:
            self._decoded[index] = self._read(self._root.element("bufferViews", index))
        return self._decoded[index]

    def stride(self, index: int) -> int | None:
        """The byte stride that buffer view ``index`` states, or None."""
        view = self._root.element("bufferViews", index)
        return view.integer("byteStride", minimum=1) if view.has("byteStride") else None

    def _read(self, view: JsonView) -> memoryview:
        for name in MESHOPT_EXTENSIONS:
            extension = view.extension(name)
            if extension is not None:
                # Loaded here: Numba takes a second to import, and most files don't need it.
                from irradia.scene.gltf.meshopt import decode_buffer_view

                return memoryview(decode_buffer_view(extension, self._slice(extension)))
        return self._slice(view)

    def _slice(self, view: JsonView) -> memoryview:
        """The bytes that an object with buffer, byteOffset and byteLength refers to."""
        buffer_index = view.integer("buffer")
        if buffer_index >= len(self._buffers):
            raise InputError(
                f"expected an index below {len(self._buffers)}, found {buffer_index}",
                where=f"{view.pointer}/buffer",
            )
        buffer = self._buffers[buffer_index]
        start, length = view.integer("byteOffset", 0), view.integer("byteLength", minimum=1)
        if start + length > len(buffer):
            raise InputError(
                f"bytes {start} to {start + length} lie outside the buffer of {len(buffer)} bytes",
                where=view.pointer,
            )
        return memoryview(buffer)[start : start + length]
