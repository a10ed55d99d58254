"""Small glTF documents, built in memory."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from irradia.scene.gltf import GltfDocument, make_document

_COMPONENT_TYPES = {"i1": 5120, "u1": 5121, "i2": 5122, "u2": 5123, "u4": 5125, "f4": 5126}
_TYPES = {1: "SCALAR", 2: "VEC2", 3: "VEC3", 4: "VEC4", 16: "MAT4"}

TRIANGLE = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0]], np.float32)


class GltfMaker:
    """Builds a document piece by piece; every method returns the index of what it added."""

    def __init__(self) -> None:
        self.json: dict[str, Any] = {"asset": {"version": "2.0"}}
        self.binary = bytearray()

    def add(self, kind: str, value: dict[str, Any]) -> int:
        self.json.setdefault(kind, []).append(value)
        return len(self.json[kind]) - 1

    def view(self, data: bytes, **fields: Any) -> int:
        self.binary.extend(b"\0" * (-len(self.binary) % 4))
        offset = len(self.binary)
        self.binary.extend(data)
        return self.add("bufferViews", {"buffer": 0, "byteOffset": offset, "byteLength": len(data), **fields})

    def accessor(self, values: Any, dtype: str = "f4", **fields: Any) -> int:
        array = np.asarray(values, np.dtype(dtype).newbyteorder("<"))
        rows = array.reshape(len(array), -1)
        return self.add(
            "accessors",
            {
                "bufferView": self.view(rows.tobytes()),
                "componentType": _COMPONENT_TYPES[dtype],
                "count": len(rows),
                "type": _TYPES[rows.shape[1]],
                **fields,
            },
        )

    def primitive(self, attributes: dict[str, Any], indices: Any = None, **fields: Any) -> dict[str, Any]:
        """A primitive from arrays; attributes that are integers are taken for accessors."""
        by_name = {k: v if isinstance(v, int) else self.accessor(v) for k, v in attributes.items()}
        if indices is not None:
            fields["indices"] = self.accessor(indices, "u2")
        return {"attributes": by_name, **fields}

    def mesh(self, attributes: dict[str, Any] | None = None, indices: Any = None, **fields: Any) -> int:
        primitive = self.primitive(attributes or {"POSITION": TRIANGLE}, indices, **fields)
        return self.add("meshes", {"primitives": [primitive]})

    def node(self, **fields: Any) -> int:
        return self.add("nodes", fields)

    def triangle(self, **node_fields: Any) -> int:
        """A node that shows one triangle."""
        return self.node(mesh=self.mesh(), **node_fields)

    def use(self, *extensions: str, required: bool = False) -> None:
        for name in extensions:
            self.add("extensionsUsed", name)  # pyright: ignore[reportArgumentType]
            if required:
                self.add("extensionsRequired", name)  # pyright: ignore[reportArgumentType]

    def document(self) -> GltfDocument:
        if self.binary:
            self.json["buffers"] = [{"byteLength": len(self.binary)}]
        return make_document(self.json, bytes(self.binary) or None, name="made")


@pytest.fixture
def gltf() -> GltfMaker:
    return GltfMaker()
