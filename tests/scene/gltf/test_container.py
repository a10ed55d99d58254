"""Files that are cut short, mislabelled or incomplete say so, and where."""

from __future__ import annotations

import base64
import json
import struct

import pytest

from irradia.core.errors import InputError
from irradia.scene.gltf import document_to_scene, read_document

POSITIONS = struct.pack("<9f", 0, 0, 0, 1, 0, 0, 0, 1, 0)


def triangle_json(**buffer: object) -> dict:
    return {
        "asset": {"version": "2.0"},
        "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"}],
        "bufferViews": [{"buffer": 0, "byteLength": 36}],
        "buffers": [{"byteLength": 36, **buffer}],
    }


def glb_bytes(document: dict, binary: bytes = POSITIONS) -> bytes:
    text = json.dumps(document).encode()
    text += b" " * (-len(text) % 4)
    chunks = struct.pack("<I4s", len(text), b"JSON") + text
    chunks += struct.pack("<I4s", len(binary), b"BIN\0") + binary
    return b"glTF" + struct.pack("<II", 2, 12 + len(chunks)) + chunks


def write_gltf(folder, document: dict):
    path = folder / "scene.gltf"
    path.write_text(json.dumps(document))
    return path


def test_glb_holds_its_own_buffer(tmp_path):
    (tmp_path / "scene.glb").write_bytes(glb_bytes(triangle_json()))
    document = read_document(tmp_path / "scene.glb")
    assert document.buffers == (POSITIONS,)
    assert document.name == "scene"
    assert document_to_scene(document).n_triangles == 1


def test_gltf_reads_buffers_beside_it_with_escaped_names(tmp_path):
    (tmp_path / "my data.bin").write_bytes(POSITIONS)
    document = read_document(write_gltf(tmp_path, triangle_json(uri="my%20data.bin")))
    assert document.buffers == (POSITIONS,)


def test_gltf_reads_buffers_in_data_uris(tmp_path):
    uri = "data:application/octet-stream;base64," + base64.b64encode(POSITIONS).decode()
    assert read_document(write_gltf(tmp_path, triangle_json(uri=uri))).buffers == (POSITIONS,)


def test_byte_order_mark_before_json_is_ignored(tmp_path):
    (tmp_path / "b.bin").write_bytes(POSITIONS)
    path = write_gltf(tmp_path, triangle_json(uri="b.bin"))
    path.write_bytes(b"\xef\xbb\xbf" + path.read_bytes())
    assert read_document(path).buffers == (POSITIONS,)


def test_missing_scene_file_is_an_input_error(tmp_path):
    with pytest.raises(InputError, match=r"nowhere\.glb"):
        read_document(tmp_path / "nowhere.glb")


@pytest.mark.parametrize("magic", [b"gltf", b"PK\x03\x04", b"", b"\0\0\0\0"])
def test_wrong_magic_is_named(tmp_path, magic):
    (tmp_path / "x.glb").write_bytes(magic + glb_bytes(triangle_json())[4:] if magic else b"")
    with pytest.raises(InputError, match=r"expected a \.glb"):
        read_document(tmp_path / "x.glb")


def test_glb_cut_anywhere_is_an_input_error(tmp_path):
    whole = glb_bytes(triangle_json())
    path = tmp_path / "x.glb"
    for length in range(4, len(whole), 7):
        path.write_bytes(whole[:length])
        with pytest.raises(InputError, match=r"truncated|header"):
            read_document(path)


def test_glb_whose_chunk_is_longer_than_the_file_is_truncated(tmp_path):
    data = bytearray(glb_bytes(triangle_json()))
    struct.pack_into("<I", data, 12, 0xFFFFFFF0)
    (tmp_path / "x.glb").write_bytes(data)
    with pytest.raises(InputError, match="chunk at byte 12 says 4294967280"):
        read_document(tmp_path / "x.glb")


def test_glb_version_1_is_refused(tmp_path):
    data = bytearray(glb_bytes(triangle_json()))
    struct.pack_into("<I", data, 4, 1)
    (tmp_path / "x.glb").write_bytes(data)
    with pytest.raises(InputError, match="version 2, found 1"):
        read_document(tmp_path / "x.glb")


def test_gltf_1_names_the_tool_that_upgrades_it(tmp_path):
    document = triangle_json() | {"asset": {"version": "1.0"}}
    with pytest.raises(InputError, match=r"/asset/version.*\n.*gltf-pipeline"):
        read_document(write_gltf(tmp_path, document))


@pytest.mark.parametrize(
    "text",
    ["{", '{"asset": {"version": "2.0"}, "extras": NaN}', "{" * 10**5, '{"asset": 3}', '{"a": "\ud800"}'],
)
def test_malformed_json_is_an_input_error(tmp_path, text):
    path = tmp_path / "x.gltf"
    path.write_bytes(text.encode("utf-8", "surrogatepass"))
    with pytest.raises(InputError):
        read_document(path)


def test_missing_buffer_file_is_named_with_its_pointer(tmp_path):
    with pytest.raises(InputError, match=r"/buffers/0/uri.*lost\.bin"):
        read_document(write_gltf(tmp_path, triangle_json(uri="lost.bin")))


def test_missing_image_file_is_named_with_its_pointer(tmp_path):
    (tmp_path / "b.bin").write_bytes(POSITIONS)
    document = triangle_json(uri="b.bin") | {"images": [{"uri": "lost.png"}]}
    with pytest.raises(InputError, match=r"/images/0/uri.*lost\.png"):
        read_document(write_gltf(tmp_path, document))


def test_short_buffer_is_an_input_error(tmp_path):
    (tmp_path / "b.bin").write_bytes(POSITIONS[:20])
    with pytest.raises(InputError, match=r"/buffers/0: expected 36 bytes, found 20"):
        read_document(write_gltf(tmp_path, triangle_json(uri="b.bin")))


def test_buffer_without_uri_or_chunk_is_an_input_error(tmp_path):
    with pytest.raises(InputError, match=r"/buffers/0: this buffer has no uri"):
        read_document(write_gltf(tmp_path, triangle_json()))


@pytest.mark.parametrize(
    "uri", ["http://example.com/b.bin", "file:///etc/hosts", "/etc/hosts", "C:\\b.bin", "//host/b.bin"]
)
def test_remote_and_absolute_uris_are_refused(tmp_path, uri):
    with pytest.raises(InputError, match=r"/buffers/0/uri: expected a data URI or a relative path"):
        read_document(write_gltf(tmp_path, triangle_json(uri=uri)))


@pytest.mark.parametrize(
    ("uri", "message"),
    [
        ("data:,", "expected 36 bytes, found 0"),
        ("data:;base64,QUJD", "expected 36 bytes, found 3"),
        ("data:;base64,@@@@", "not base64"),
        ("data:;base64", "no comma"),
    ],
)
def test_damaged_data_uris_are_input_errors(tmp_path, uri, message):
    with pytest.raises(InputError, match=f"/buffers/0.*{message}"):
        read_document(write_gltf(tmp_path, triangle_json(uri=uri)))


def test_image_in_a_buffer_view_is_kept_encoded(tmp_path):
    document = triangle_json()
    document["bufferViews"].append({"buffer": 0, "byteOffset": 4, "byteLength": 8})
    document["images"] = [{"bufferView": 1, "mimeType": "image/png"}]
    (tmp_path / "x.glb").write_bytes(glb_bytes(document))
    assert read_document(tmp_path / "x.glb").images == (POSITIONS[4:12],)


def test_image_outside_its_buffer_is_an_input_error(tmp_path):
    document = triangle_json()
    document["bufferViews"].append({"buffer": 0, "byteOffset": 30, "byteLength": 8})
    document["images"] = [{"bufferView": 1, "mimeType": "image/png"}]
    (tmp_path / "x.glb").write_bytes(glb_bytes(document))
    with pytest.raises(InputError, match=r"/bufferViews/1: bytes 30 to 38"):
        read_document(tmp_path / "x.glb")
