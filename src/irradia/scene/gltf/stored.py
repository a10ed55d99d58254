"""A primitive's data as the file holds it, Draco decoded: what the import and the exporters share."""

from __future__ import annotations

from dataclasses import dataclass

from irradia.core.errors import InputError
from irradia.scene.gltf.accessors import Accessors, Stored
from irradia.scene.gltf.draco import decode_draco
from irradia.scene.gltf.view import JsonView
from irradia.scene.types import U32

TRIANGLES = 4


@dataclass(frozen=True)
class StoredPrimitive:
    """Attributes, indices and morph targets, nothing converted.

    Attributes:
        attributes: By name (``POSITION``, ``TEXCOORD_0`` …); all have ``n_vertices`` rows.
        targets: The same for each morph target.
        indices: As stored, or None where vertices follow one another.
        mode: glTF's topology: 4 triangles, 5 strip, 6 fan.
    """

    attributes: dict[str, Stored]
    targets: tuple[dict[str, Stored], ...]
    indices: U32 | None
    mode: int
    pointer: str

    @property
    def n_vertices(self) -> int:
        """Vertices before any split."""
        return len(self.attributes["POSITION"])


def read_stored_primitive(accessors: Accessors, view: JsonView) -> StoredPrimitive:
    """Reads the primitive at ``view``.

    Raises:
        InputError: It has no POSITION, or its attributes differ in length.
    """
    draco = view.extension("KHR_draco_mesh_compression")
    attributes = {name: accessors.read(_index(v)) for name, v in view.object("attributes").entries()}
    indices = accessors.read(view.integer("indices")).indices() if view.has("indices") else None
    mode = view.integer("mode", TRIANGLES)
    if draco is not None:
        decoded, indices = decode_draco(draco, accessors, attributes)
        attributes |= decoded
        mode = TRIANGLES
    if "POSITION" not in attributes:
        raise InputError("this primitive has no POSITION", where=f"{view.pointer}/attributes")
    targets = tuple(
        {name: accessors.read(_index(v)) for name, v in target.entries()} for target in view.items("targets")
    )
    n_vertices = len(attributes["POSITION"])
    for data in (attributes, *targets):
        _check_lengths(data, n_vertices)
    return StoredPrimitive(attributes, targets, indices, mode, view.pointer)


def _check_lengths(data: dict[str, Stored], n_vertices: int) -> None:
    for name, stored in data.items():
        if len(stored) != n_vertices:
            raise InputError(
                f"expected {n_vertices} elements for {name} as for POSITION, found {len(stored)}",
                where=stored.pointer,
            )


def _index(view: JsonView) -> int:
    value = view.value
    if isinstance(value, bool) or not isinstance(value, int) or value < 0:
        raise InputError(f"expected the index of an accessor, found {value!r}", where=view.pointer)
    return value
