"""A field inside a baked .glb: the very file back, valid by schema; damage refused."""

from __future__ import annotations

import copy
import json
import struct
from pathlib import Path

import numpy as np
import pytest

from irradia.core.errors import InputError
from irradia.core.rng import Seed
from irradia.export.field_extension import add_field, put_field, read_baked_field
from irradia.export.probes_extension import add_probes, read_baked_probes
from irradia.export.slots import Slots
from irradia.field.encodings import Identity, TriPlane
from irradia.field.field import Field
from irradia.field.init import new_parameters
from irradia.field.native_fields import encode_field
from irradia.field.spec import FieldFrame, FieldSpec
from irradia.scene.gltf import GltfDocument, make_document, read_document
from irradia.scene.gltf.accessors import Accessors

from .probe_sets import made as made_probes

SPEC = FieldSpec(TriPlane(4, 2), Identity(), width=8, n_hidden_layers=1)
FRAME = FieldFrame(np.array([(-1, 0, 0.1), (1, 2.3, 4)], np.float32), 2.0, "indirect")
FIELD = Field(SPEC, FRAME, new_parameters(SPEC, Seed(3)), "numpy")
PLAIN, PACKED = encode_field(FIELD, {"seed": 3}), encode_field(FIELD, {"seed": 3}, compress=True)


def document_with(*fields: bytes) -> GltfDocument:
    empty = make_document({"asset": {"version": "2.0"}}, b"", name="empty")
    root = copy.deepcopy(empty.json)
    slots = Slots(root, Accessors(empty))
    add_probes(root, slots, made_probes())
    for data in fields:
        add_field(root, slots, data)
    return make_document(root, slots.finish(), name="with a field")


def entry_of(document: GltfDocument) -> dict:
    return document.json["extensions"]["IRRADIA_lighting"]["field"]


@pytest.mark.parametrize("data", [PLAIN, PACKED])
def test_field_comes_back_to_the_same_values(data: bytes) -> None:
    document = document_with(data)
    found = read_baked_field(document)
    assert found is not None
    assert (found.n_bytes, found.provenance) == (len(data), {"seed": 3})
    assert encode_field(found.field, found.provenance) == PLAIN
    stored = Accessors(document).read_view(entry_of(document)["bufferView"])
    assert bytes(stored) == data
    assert read_baked_probes(document) is not None


def test_document_without_a_field_has_none() -> None:
    assert read_baked_field(make_document({"asset": {"version": "2.0"}}, b"", name="bare")) is None
    assert read_baked_field(document_with()) is None


def test_what_is_no_field_is_not_added() -> None:
    with pytest.raises(InputError):
        document_with(b"text")


@pytest.mark.parametrize(
    ("key", "value"),
    [
        ("bufferView", 99),
        ("bufferView", -1),
        ("bufferView", 0),
        ("bufferView", None),
        ("mimeType", "application/zstd"),
        ("mimeType", "image/ktx2"),
        ("mode", "sh1"),
        ("mode", 3),
        ("light", "full"),
        ("min", [-1, 0, 0]),
        ("max", [1, 2]),
        ("max", [1, 2, "x"]),
    ],
)
def test_damage_is_refused_with_a_pointer(key: str, value: object) -> None:
    document = document_with(PLAIN)
    entry_of(document)[key] = value
    with pytest.raises(InputError) as caught:
        read_baked_field(document)
    assert str(caught.value.where).startswith("/")


def test_view_that_reaches_outside_its_buffer_is_refused() -> None:
    document = document_with(PLAIN)
    view = document.json["bufferViews"][entry_of(document)["bufferView"]]
    view["byteLength"] += 1 << 20
    with pytest.raises(InputError):
        read_baked_field(document)


def test_damaged_field_is_refused_at_its_place() -> None:
    document = document_with(PLAIN)
    view = document.json["bufferViews"][entry_of(document)["bufferView"]]
    view["byteLength"] -= 2
    with pytest.raises(InputError) as caught:
        read_baked_field(document)
    assert caught.value.where == "/extensions/IRRADIA_lighting/field"


def test_field_is_put_into_a_baked_scene_and_replaced_there(
    web_check, repo_root: Path, gallery: GltfDocument, bake
) -> None:
    path = bake(gallery).path
    schemas = repo_root / "docs" / "IRRADIA_lighting" / "schema"
    before = read_document(path)
    assert put_field(path, PACKED) == path.stat().st_size
    with_field = read_document(path)
    assert encode_field(read_baked_field(with_field).field, {"seed": 3}) == PLAIN  # type: ignore[union-attr]
    assert web_check("validate", path, schemas) == {"issues": [], "complaints": []}
    for key in ("meshes", "nodes", "materials", "accessors", "images"):
        assert with_field.json.get(key) == before.json.get(key)
    assert with_field.images == before.images
    sizes = {put_field(path, PLAIN) for _ in range(3)}
    assert len(sizes) == 1  # the former isn't kept beside it
    assert len(read_document(path).json["bufferViews"]) == len(with_field.json["bufferViews"])
    assert read_baked_field(read_document(path)).n_bytes == len(PLAIN)  # type: ignore[union-attr]


@pytest.mark.parametrize("change", [{"lamp": 1}, {"mode": "sh3"}, {"min": [0, 0]}, {"mimeType": "text"}])
def test_schema_refuses_what_it_should(
    web_check, repo_root: Path, gallery: GltfDocument, bake, change: dict
) -> None:
    path = bake(gallery).path
    put_field(path, PLAIN)
    data = path.read_bytes()
    end = 20 + struct.unpack_from("<I", data, 12)[0]
    root = json.loads(data[20:end])
    root["extensions"]["IRRADIA_lighting"]["field"] |= change
    text = json.dumps(root).encode()
    text += b" " * (-len(text) % 4)
    start = struct.pack("<4sIIII", b"glTF", 2, 20 + len(text) + len(data) - end, len(text), 0x4E4F534A)
    path.write_bytes(start + text + data[end:])
    assert web_check("validate", path, repo_root / "docs" / "IRRADIA_lighting" / "schema")["complaints"]


def test_only_baked_scenes_take_a_field(tmp_path: Path) -> None:
    path = tmp_path / "plain.gltf"
    path.write_text('{"asset": {"version": "2.0"}}', encoding="utf-8")
    with pytest.raises(InputError, match="baked scene"):
        put_field(path, PLAIN)
