"""glTF primitives written again with the lightmap's uv: vertices split, everything on them carried along."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from irradia.export.slots import Slots
from irradia.scene.gltf.accessors import Accessors, Stored
from irradia.scene.gltf.document import GltfDocument, Json
from irradia.scene.gltf.stored import StoredPrimitive, read_stored_primitive
from irradia.scene.gltf.topology import unroll_triangles
from irradia.scene.gltf.view import JsonView
from irradia.scene.layout import Unwrap
from irradia.scene.types import F32, U32, Primitive

MOZ_LIGHTMAP = "MOZ_lightmap"
DRACO = "KHR_draco_mesh_compression"
_DTYPES = {5120: np.int8, 5121: np.uint8, 5122: np.int16, 5123: np.uint16, 5125: np.uint32, 5126: np.float32}


class PrimitiveWriter:
    """Writes primitives; splits of one unwrap are written once, whatever the number of lightmap uv sets."""

    def __init__(self, document: GltfDocument, accessors: Accessors, slots: Slots) -> None:
        self._root = JsonView(document.json)
        self._source_accessors: list[Json] = document.json.get("accessors", [])
        self._accessors = accessors
        self._slots = slots
        self._stored: dict[tuple[int, int], StoredPrimitive] = {}
        self._split: dict[int, Json] = {}

    def unpacked(self, mesh: int, primitive: int) -> Json:
        """A Draco primitive as plain accessors, vertices as they are."""
        stored = self._read(mesh, primitive)
        source = np.arange(stored.n_vertices, dtype=np.uint32)
        return self._write(mesh, primitive, source, unroll_triangles(stored))

    def lit(
        self, primitive: Primitive, scene_index: int, unwrap: Unwrap, uv: F32 | None, texcoord: int
    ) -> Json:
        """A primitive with page or rectangle uv as TEXCOORD_``texcoord``.

        Args:
            primitive: Of the scene.
            scene_index: Its index there; calls with the same one share all other accessors.
            unwrap: Its splits.
            uv: (V', 2) to write; the unwrap's own if None.
            texcoord: The set to write, replacing one that the file has; sets missing below it
                repeat the new one, because glTF wants them without gaps.
        """
        mesh, index = primitive.mesh_index, primitive.primitive_index
        if scene_index not in self._split:
            source = primitive.vertex_source[unwrap.vertex_source]
            rewound = _is_rewound(primitive, self._read(mesh, index))
            triangles = unwrap.indices[:, ::-1] if rewound else unwrap.indices
            self._split[scene_index] = self._write(mesh, index, source, triangles, leave_out=texcoord)
        written = self._split[scene_index]
        accessor = self._slots.add_attribute(np.asarray(unwrap.uv if uv is None else uv, np.float32), "VEC2")
        attributes = written["attributes"] | {f"TEXCOORD_{texcoord}": accessor}
        for lower in range(texcoord):
            attributes.setdefault(f"TEXCOORD_{lower}", accessor)
        return written | {"attributes": attributes}

    def _read(self, mesh: int, primitive: int) -> StoredPrimitive:
        if (mesh, primitive) not in self._stored:
            view = self._root.items("meshes")[mesh].items("primitives")[primitive]
            self._stored[mesh, primitive] = read_stored_primitive(self._accessors, view)
        return self._stored[mesh, primitive]

    def _write(
        self, mesh: int, primitive: int, source: U32, triangles: U32, leave_out: int | None = None
    ) -> Json:
        """The primitive's JSON with vertices ``source`` of the stored ones and new triangles."""
        stored = self._read(mesh, primitive)
        original = self._root.value["meshes"][mesh]["primitives"][primitive]
        written = {k: v for k, v in original.items() if k not in ("attributes", "targets", "mode")}
        written |= _without_draco(original)
        written["attributes"] = {
            name: self._attribute(values, original["attributes"][name], source, name == "POSITION")
            for name, values in stored.attributes.items()
            if name != f"TEXCOORD_{leave_out}"
        }
        written["indices"] = self._slots.add_indices(triangles, len(source))
        if stored.targets:
            written["targets"] = [
                {
                    name: self._attribute(values, target[name], source, name == "POSITION")
                    for name, values in data.items()
                }
                for target, data in zip(original["targets"], stored.targets, strict=True)
            ]
        return written

    def _attribute(self, stored: Stored, accessor_index: int, source: U32, bounds: bool) -> int:
        like = self._source_accessors[accessor_index]
        values = stored.values[source].astype(_DTYPES[like["componentType"]], copy=False)
        return self._slots.add_attribute(values, like["type"], bounds=bounds or "min" in like, like=like)


def accessors_of(primitive: Json) -> Iterator[int]:
    """Indices of all accessors that a primitive refers to."""
    yield from primitive.get("attributes", {}).values()
    if "indices" in primitive:
        yield primitive["indices"]
    for target in primitive.get("targets", []):
        yield from target.values()


def lightmap_texcoord(materials: list[Json]) -> int:
    """1, or the next set that no texture of these materials reads; loaders expect 1."""
    used = set().union(*(set(_texcoords(material)) for material in materials)) if materials else set()
    return next(index for index in range(1, len(used) + 2) if index not in used)


def _texcoords(value: Any) -> Iterator[int]:
    """Sets that texture references below ``value`` read; KHR_texture_transform may choose another."""
    # Lists can't hold texture references in any material extension there is.
    if isinstance(value, dict):
        if "index" in value:
            transform = value.get("extensions", {}).get("KHR_texture_transform", {})
            yield transform.get("texCoord", value.get("texCoord", 0))
        for key, child in value.items():
            if key != MOZ_LIGHTMAP:  # an earlier bake's, which goes
                yield from _texcoords(child)


def _without_draco(primitive: Json) -> Json:
    kept = {k: v for k, v in primitive.get("extensions", {}).items() if k != DRACO}
    return {"extensions": kept} if kept or "extensions" in primitive else {}


def _is_rewound(primitive: Primitive, stored: StoredPrimitive) -> bool:
    """Whether the import turned triangles round, as it does where a skin's joints mirror."""
    if not len(primitive.indices):
        return False
    first: NDArray = primitive.vertex_source[primitive.indices[0]]
    triangles = unroll_triangles(stored)
    return not (triangles == first).all(axis=1).any()
