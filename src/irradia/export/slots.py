"""Accessors and buffer views of a document that is written again, without renumbering anything.

glTF refers to everything by index, extensions that we don't know and JSON pointers
(KHR_animation_pointer) included. So what stays keeps its index; what is new takes the places of what
went, then follows at the end.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from hashlib import sha256
from typing import Any

import numpy as np
from numpy.typing import NDArray

from irradia.core.errors import InputError
from irradia.scene.gltf.accessors import Accessors
from irradia.scene.gltf.document import Json

ARRAY_BUFFER, ELEMENT_ARRAY_BUFFER = 34962, 34963
_COMPONENT_TYPES = {"i1": 5120, "u1": 5121, "i2": 5122, "u2": 5123, "u4": 5125, "f4": 5126}
_COMPONENTS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT2": 4, "MAT3": 9, "MAT4": 16}
_FLOAT = 5126
_UNSETTLED = -1  # stands for a buffer view until finish
_GLB_LIMIT_BYTES = (1 << 32) - 1

PoolKey = tuple[int, int]  # stride in bytes (0: none is stated), target (0: none)


class Slots:
    """Allocates accessors and buffer views in ``json``, which it changes.

    Args:
        json: A deep copy of a document's JSON.
        source: Reads the document.
        free_accessors: Accessors that nothing will refer to any more.
    """

    def __init__(self, json: Json, source: Accessors, free_accessors: Iterable[int] = ()) -> None:
        self._json = json
        self._source = source
        self._accessors: list[Json] = json.setdefault("accessors", [])
        self._views: list[Json] = json.setdefault("bufferViews", [])
        self._view_users_before = set(referenced_views(json))
        self._free_accessors = sorted(free_accessors, reverse=True)
        self._pools: dict[PoolKey, bytearray] = {}
        self._pooled: list[tuple[Json, PoolKey]] = []
        self._written: dict[tuple[PoolKey, str, bytes], int] = {}
        self._blobs: list[tuple[Callable[[int], None], bytes]] = []
        self._leave_shared_views()

    def add_attribute(
        self, values: NDArray, kind: str, *, bounds: bool = False, like: Json | None = None
    ) -> int:
        """Adds vertex data.

        Args:
            values: (count, components) in the component type to store.
            kind: ``VEC3`` and so on.
            bounds: Whether to state min and max.
            like: An accessor whose name, extras and normalisation are taken over.
        """
        if values.shape[1] != _COMPONENTS[kind] or (kind.startswith("MAT") and values.itemsize < 4):
            raise InputError(f"vertex data of type {kind} and {values.dtype} can't be written")
        accessor = {k: like[k] for k in ("name", "extras", "normalized") if k in like} if like else {}
        accessor |= _accessor(values, kind)
        if bounds:
            accessor["min"], accessor["max"] = values.min(axis=0).tolist(), values.max(axis=0).tolist()
        return self._add(accessor, (_padded(values), ARRAY_BUFFER), _rows(values))

    def add_indices(self, indices: NDArray[np.uint32], n_vertices: int) -> int:
        """Adds triangle corners, 16 bits each where they fit (65535 restarts a primitive)."""
        narrow = indices.astype(np.uint16 if n_vertices <= 0xFFFF else np.uint32).reshape(-1, 1)
        return self._add(_accessor(narrow, "SCALAR"), (0, ELEMENT_ARRAY_BUFFER), narrow.tobytes())

    def add_table(self, values: NDArray, kind: str) -> int:
        """Adds data that is neither vertices nor indices: (count, components)."""
        return self._add(_accessor(values, kind), (0, 0), np.ascontiguousarray(values).tobytes())

    def add_blob(self, data: bytes, assign: Callable[[int], None]) -> None:
        """Adds a buffer view of ``data``; ``assign`` gets its index when all are known."""
        self._blobs.append((assign, data))

    def finish(self) -> bytes:
        """Settles all buffer views and returns the one binary chunk."""
        self._settle_free_accessors()
        gone = self._view_users_before - set(referenced_views(self._json))
        kept = [index for index in range(len(self._views)) if index not in gone]
        binary = bytearray()
        for index in kept:
            self._views[index] = _place(binary, self._source.read_view(index), self._views[index])
        free = sorted(gone, reverse=True)
        pool_index = {}
        for key, data in self._pools.items():
            stride, target = key
            view: Json = {"byteStride": stride} if stride else {}
            view |= {"target": target} if target else {}
            pool_index[key] = _fill(self._views, free, _place(binary, data, view))
        for accessor, key in self._pooled:
            accessor["bufferView"] = pool_index[key]
        for assign, data in self._blobs:
            assign(_fill(self._views, free, _place(binary, data, {})))
        for index in free:
            self._views[index] = {"buffer": 0, "byteOffset": 0, "byteLength": min(4, len(binary))}
        return self._close(binary)

    def _close(self, binary: bytearray) -> bytes:
        if len(binary) > _GLB_LIMIT_BYTES:
            raise InputError(f"a .glb holds at most 4 GiB, this scene takes {len(binary)} bytes")
        for key in ("accessors", "bufferViews"):
            if not self._json[key]:
                del self._json[key]
        self._json.pop("buffers", None)
        if binary:
            self._json["buffers"] = [{"byteLength": len(binary)}]
        return bytes(binary)

    def _leave_shared_views(self) -> None:
        """Copies accessors out of the views that they share with freed ones, so that those can go."""
        free = set(self._free_accessors)
        emptied = {self._accessors[index].get("bufferView", _UNSETTLED) for index in free} - {_UNSETTLED}
        for index, accessor in enumerate(self._accessors):
            view: int = accessor.get("bufferView", _UNSETTLED)
            narrow_matrix = accessor["type"].startswith("MAT") and accessor["componentType"] != _FLOAT
            if index in free or view not in emptied or "sparse" in accessor or narrow_matrix:
                continue
            values = self._source.read(index).values
            key = (self._views[view].get("byteStride", 0), self._views[view].get("target", 0))
            if key[1] == ARRAY_BUFFER or key[0]:
                key = (_padded(values), ARRAY_BUFFER)
            self._pool(accessor, key, _rows(values) if key[0] else np.ascontiguousarray(values).tobytes())

    def _add(self, accessor: Json, key: PoolKey, data: bytes) -> int:
        """Index of an accessor; equal ones are written once, as copies of a mesh often hold them."""
        content = (key, repr(accessor), sha256(data).digest())
        if content not in self._written:
            self._pool(accessor, key, data)
            self._written[content] = _fill(self._accessors, self._free_accessors, accessor)
        return self._written[content]

    def _pool(self, accessor: Json, key: PoolKey, data: bytes) -> None:
        pool = self._pools.setdefault(key, bytearray())
        pool.extend(bytes(-len(pool) % 4))
        accessor["byteOffset"] = len(pool)
        pool.extend(data)
        accessor["bufferView"] = _UNSETTLED
        self._pooled.append((accessor, key))

    def _settle_free_accessors(self) -> None:
        """Drops what is left over at the end; elsewhere an accessor without data keeps the place."""
        for index in self._free_accessors:
            if index == len(self._accessors) - 1:
                self._accessors.pop()
            else:
                self._accessors[index] = {"componentType": 5121, "count": 1, "type": "SCALAR"}


def referenced_views(value: Any) -> Iterator[int]:
    """Every index under a key ``bufferView``, wherever it stands."""
    if isinstance(value, dict):
        if isinstance(value.get("bufferView"), int):
            yield value["bufferView"]
        for child in value.values():
            yield from referenced_views(child)
    elif isinstance(value, list):
        for child in value:
            yield from referenced_views(child)


def _accessor(values: NDArray, kind: str) -> Json:
    return {
        "bufferView": _UNSETTLED,
        "componentType": _COMPONENT_TYPES[values.dtype.str[1:]],
        "count": len(values),
        "type": kind,
    }


def _padded(values: NDArray) -> int:
    """Bytes of a vertex: elements start on 4-byte boundaries."""
    return -(-values.shape[1] * values.itemsize // 4) * 4


def _rows(values: NDArray) -> bytes:
    """Vertex data, each element padded."""
    rows = np.zeros((len(values), _padded(values)), np.uint8)
    packed = np.ascontiguousarray(values).view(np.uint8).reshape(len(values), -1)
    rows[:, : packed.shape[1]] = packed
    return rows.tobytes()


def _fill(table: list[Json], free: list[int], entry: Json) -> int:
    """Puts an entry into the first free place, or at the end."""
    if free:
        index = free.pop()
        table[index] = entry
        return index
    table.append(entry)
    return len(table) - 1


def _place(binary: bytearray, data: bytes | bytearray | memoryview, view: Json) -> Json:
    """Appends data and returns ``view`` pointing at it, compression removed."""
    binary.extend(bytes(-len(binary) % 4))
    placed = {k: v for k, v in view.items() if k != "extensions"}
    kept = {k: v for k, v in view.get("extensions", {}).items() if not k.endswith("_meshopt_compression")}
    placed |= {"extensions": kept} if kept else {}
    placed |= {"buffer": 0, "byteOffset": len(binary), "byteLength": len(data)}
    binary.extend(data)
    return placed
