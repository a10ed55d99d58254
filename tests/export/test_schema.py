"""Khronos' validator accepts what we write, and our schemas accept our extension."""

from __future__ import annotations

import json
import struct
from pathlib import Path

import pytest

from irradia.scene.gltf import GltfDocument

NAME = "IRRADIA_lighting"


@pytest.fixture
def schemas(repo_root: Path) -> Path:
    return repo_root / "docs" / "IRRADIA_lighting" / "schema"


@pytest.mark.parametrize("compatible", [False, True])
def test_baked_file_is_valid(web_check, schemas: Path, gallery: GltfDocument, bake, compatible: bool) -> None:
    found = web_check("validate", bake(gallery, compatible=compatible).path, schemas)
    assert found == {"issues": [], "complaints": []}


@pytest.mark.parametrize(
    ("pointer", "value", "complaint"),
    [
        (("extensions", NAME, "version"), 2, "/version"),
        (("extensions", NAME, "lightmap", "quantity"), "irradiance", "/lightmap/quantity"),
        (("extensions", NAME, "lightmap", "scale"), 0, "/lightmap/scale"),
        (("nodes", 0, "extensions", NAME, "primitives", 0, "page"), -1, "/primitives/0/page"),
        (("nodes", 0, "extensions", NAME, "primitives", 0, "scale"), [1], "/primitives/0/scale"),
        (("nodes", 8, "extensions", NAME, "lamp"), 1, "additional properties"),
    ],
)
def test_schemas_refuse_what_they_should(
    web_check, schemas: Path, gallery: GltfDocument, bake, pointer, value, complaint: str
) -> None:
    path = bake(gallery).path
    data = path.read_bytes()
    end = 20 + struct.unpack_from("<I", data, 12)[0]
    document = json.loads(data[20:end])
    holder = document
    for key in pointer[:-1]:
        holder = holder[key]
    holder[pointer[-1]] = value
    text = json.dumps(document).encode()
    text += b" " * (-len(text) % 4)
    path.write_bytes(
        struct.pack("<4sIIII", b"glTF", 2, 20 + len(text) + len(data) - end, len(text), 0x4E4F534A)
    )
    with path.open("ab") as stream:
        stream.write(text + data[end:])
    complaints = web_check("validate", path, schemas)["complaints"]
    assert complaints
    assert any(complaint in text for text in complaints)
