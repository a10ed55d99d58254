"""Profiles of EXT_lights_ies: an IES file in a buffer view, a data URI or a file beside the glTF."""

from __future__ import annotations

from irradia.core.errors import InputError
from irradia.formats.ies import decode_ies
from irradia.scene.gltf.buffer_views import BufferViews
from irradia.scene.gltf.document import GltfDocument
from irradia.scene.gltf.notes import ImportNotes
from irradia.scene.gltf.uris import resolve_uri
from irradia.scene.gltf.view import JsonView
from irradia.scene.light_profile import profile_from_ies
from irradia.scene.types import IesProfile

_EXTENSION = "EXT_lights_ies"


class IesProfiles:
    """The profiles of one document; each is decoded once, when a node first asks for it."""

    def __init__(self, document: GltfDocument, notes: ImportNotes) -> None:
        self._document = document
        self._root = JsonView(document.json)
        self._views = BufferViews(document)
        self._notes = notes
        self._decoded: dict[int, IesProfile] = {}

    def read(self, reference: JsonView) -> tuple[IesProfile, JsonView]:
        """The profile that a node's extension refers to, and where it is defined.

        Raises:
            InputError: There is no such profile, or its file can't be read or is malformed.
        """
        extension = self._root.extension(_EXTENSION) or JsonView({}, f"/extensions/{_EXTENSION}")
        index = reference.integer("light")
        count = extension.length("lights")
        if index >= count:
            raise InputError(
                f"expected an index below {count}, found {index}", where=f"{reference.pointer}/light"
            )
        view = extension.element("lights", index)
        if index not in self._decoded:
            self._decoded[index] = self._decode(view, index)
        return self._decoded[index], view

    def _decode(self, view: JsonView, index: int) -> IesProfile:
        table = decode_ies(self._data(view), view.pointer)
        for note in table.notes:
            self._notes.add(f"{view.pointer}: {note}")
        return profile_from_ies(table, view.string("name") or f"profile {index}")

    def _data(self, view: JsonView) -> bytes:
        if view.has("uri"):
            return resolve_uri(view.string("uri"), self._document.base, f"{view.pointer}/uri")
        if view.has("bufferView"):
            return bytes(self._views.read(view.integer("bufferView")))
        raise InputError("expected a uri or a bufferView", where=view.pointer)
