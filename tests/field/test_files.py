"""Fields as safetensors: golden bytes, the same values back, damage refused."""

from __future__ import annotations

import hashlib
import json
import struct
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import zstandard

from irradia.core.errors import InputError
from irradia.field.encoding import Encoding
from irradia.field.encodings import Composite, Identity, OneBlob
from irradia.field.files import load_field, read_field, save_field
from irradia.field.native_fields import decode_field, encode_field
from irradia.field.quantised import QuantisedField, quantise
from irradia.field.registry import ENCODINGS
from irradia.field.tensors import encoding_tensors, from_tensors, to_tensors

from .stored_fields import GRID, PLANES, assert_same, light, made, places

ABOUT = (
    '{"frame": {"aabb": [[-1.0, 0.0, 0.5], [1.0, 2.0, 4.5]], "quantity": "indirect", "scale": 4.0}, '
    '"provenance": {"seed": 7CHECKSUM}, "quantised": {}, '
    '"spec": {"activation": "relu", "direction": null, "head": "linear", "mode": "sh1", '
    '"n_hidden_layers": 1, "position": {"type": "identity"}, "width": 1}, "version": 1}'
)
SMALLEST = made(Identity(), "sh1", 4.0, width=1, layers=1)


def golden(checksum: bool = True) -> bytes:
    """By hand: names in order, halves one after another, the header padded to eight bytes."""
    at, entries, body = 0, {"__metadata__": {}}, b""
    for name, shape in (
        ("mlp.0.bias", [1]),
        ("mlp.0.weight", [1, 3]),
        ("mlp.1.bias", [12]),
        ("mlp.1.weight", [12, 1]),
    ):
        values = SMALLEST.parameters[name].reshape(-1)
        body += struct.pack(f"<{len(values)}e", *values)
        entries[name] = {"dtype": "F16", "shape": shape, "data_offsets": [at, len(body)]}
        at = len(body)
    noted = f', "tensors_sha256": "{hashlib.sha256(body).hexdigest()}"' if checksum else ""
    entries["__metadata__"] = {"irradia.field": ABOUT.replace("CHECKSUM", noted)}
    text = json.dumps(entries, separators=(",", ":")).encode()
    text = text.ljust(-(-len(text) // 8) * 8)
    return struct.pack("<Q", len(text)) + text + body


def test_bytes_are_golden() -> None:
    assert encode_field(SMALLEST, {"seed": 7}) == golden()


@pytest.mark.parametrize("encoding", [ENCODINGS[name]() for name in ENCODINGS if name != "hash"] + [GRID])
@pytest.mark.parametrize("mode", ["irradiance", "sh1", "sh2"])
def test_every_encoding_comes_back(encoding: Encoding, mode: str) -> None:
    field = made(encoding, mode, 0.25)
    found = decode_field(encode_field(field, {"seed": 7}))
    assert_same(found.field, field)
    assert found.provenance == {"seed": 7}
    assert found.precision == "fp16"
    assert not found.tensors


def test_parts_of_a_composite_have_tensors_of_their_own() -> None:
    field = made(Composite((GRID, OneBlob(4), PLANES)))
    names = to_tensors(field.spec, field.parameters)
    assert {"position.0.level.0", "position.0.level.2", "position.2.planes", "mlp.0.weight"} <= names.keys()
    assert_same(decode_field(encode_field(field)).field, field)


def test_full_precision_keeps_every_bit() -> None:
    field = made(GRID)
    field = replace(field, parameters={name: v * np.float32(1 / 3) for name, v in field.parameters.items()})
    found = decode_field(encode_field(field, precision="fp32"))
    assert_same(found.field, field)
    assert found.precision == "fp32"


def test_more_than_a_half_holds_is_refused_with_its_name() -> None:
    field = made()
    field.parameters["mlp.1.bias"][2] = 70000.0
    with pytest.raises(InputError, match=r"mlp\.1\.bias"):
        encode_field(field)


@pytest.mark.parametrize("name", ["a.safetensors", "a.safetensors.zst", "A.SAFETENSORS", "a.bin"])
def test_name_chooses_the_format(tmp_path: Path, name: str) -> None:
    field = made(replace(GRID, full_levels=True))
    n_bytes = save_field(tmp_path / name, field)
    found = read_field(tmp_path / name)
    assert found.n_bytes == n_bytes == (tmp_path / name).stat().st_size
    np.testing.assert_array_equal(light(load_field(tmp_path / name)), light(field))
    starts = {"a.safetensors.zst": b"\x28\xb5\x2f\xfd", "a.bin": struct.pack("<II", 0, 3)}
    assert (tmp_path / name).read_bytes().startswith(starts.get(name, b""))


@pytest.mark.parametrize("name", ["field.pt", "field", "field.zst"])
def test_other_names_are_refused(tmp_path: Path, name: str) -> None:
    with pytest.raises(InputError, match="ends in"):
        save_field(tmp_path / name, made())
    (tmp_path / name).touch()
    with pytest.raises(InputError, match="ends in"):
        load_field(tmp_path / name)


def test_missing_file_is_an_input_error(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="can't be read"):
        load_field(tmp_path / "none.safetensors")


def test_packed_file_is_smaller_and_the_same(tmp_path: Path) -> None:
    field = made(PLANES)
    plain = encode_field(field)
    packed = encode_field(field, compress=True)
    assert len(packed) < len(plain)
    assert zstandard.ZstdDecompressor().decompress(packed) == plain
    assert encode_field(field, compress=True) == packed


@pytest.mark.parametrize("bits", [4, 8])
@pytest.mark.parametrize("encoding", [GRID, PLANES])
def test_codes_come_back(encoding: Encoding, bits: int) -> None:
    field = made(encoding)
    tensors = to_tensors(field.spec, field.parameters)
    codes = {name: quantise(tensors[name], bits, 10) for name in encoding_tensors(field.spec)}  # type: ignore[arg-type]
    values = tensors | {name: tensor.values() for name, tensor in codes.items()}
    coded = QuantisedField(replace(field, parameters=from_tensors(field.spec, values)), codes)
    found = decode_field(encode_field(coded))
    assert_same(found.field, coded.field)
    assert found.tensors.keys() == codes.keys()
    for name, tensor in codes.items():
        np.testing.assert_array_equal(found.tensors[name].codes, tensor.codes)
        np.testing.assert_array_equal(found.tensors[name].scales, tensor.scales)
        assert (found.tensors[name].bits, found.tensors[name].block) == (bits, 10)
    assert encode_field(QuantisedField(found.field, found.tensors)) == encode_field(coded)


CODED = made(GRID)


def coded_file() -> tuple[dict, dict[str, np.ndarray]]:
    """Metadata and tensors of a valid file with codes, without its checksum, to be damaged."""
    from safetensors.numpy import load

    tensors = to_tensors(CODED.spec, CODED.parameters)
    codes = {"position.level.1": quantise(tensors["position.level.1"], 4, 10)}
    values = tensors | {name: tensor.values() for name, tensor in codes.items()}
    field = replace(CODED, parameters=from_tensors(CODED.spec, values))
    data = encode_field(QuantisedField(field, codes))
    n_bytes = struct.unpack_from("<Q", data)[0]
    about = json.loads(json.loads(data[8 : 8 + n_bytes])["__metadata__"]["irradia.field"])
    del about["provenance"]["tensors_sha256"]
    return about, {name: values.copy() for name, values in load(data).items()}


def put(holder: dict, path: str, value: object) -> None:
    *folders, last = path.split("/")
    for key in folders:
        holder = holder[int(key) if isinstance(holder, list) else key]
    holder[int(last) if isinstance(holder, list) else last] = value


@pytest.mark.parametrize(
    ("path", "value", "complaint"),
    [
        ("version", 2, "version 1, found 2"),
        ("lamp", 1, "unknown key 'lamp'"),
        ("spec", None, "object as 'spec'"),
        ("spec/widht", 8, "width"),
        ("spec/width", 9, "mlp.0"),
        ("spec/width", 1 << 40, "hidden"),
        ("spec/width", 8.5, "spec"),
        ("spec/width", "8", "spec"),
        ("spec/mode", "lamp", "mode"),
        ("spec/activation", "lamp", "activation"),
        ("spec/head", "lamp", "head"),
        ("spec/position", "hash", "position"),
        ("spec/position/type", "lamp", "lamp"),
        ("spec/position/n_levels", 33, "levels"),
        ("spec/position/n_levels", 2, "unknown tensor"),
        ("spec/position/n_levels", 4, "missing"),
        ("spec/position/n_levels", 3.0, "position"),
        ("spec/position/log2_table_size", 28, "codes|position.level"),
        ("frame/aabb", [[0, 0, 0]], "AABB"),
        ("frame/aabb", [[0, 0, 0], [1, -1, 1]], "AABB"),
        ("frame/aabb", [[0, 0, 0], [1, "x", 1]], "numbers"),
        ("frame/aabb/1/2", 1e300, "AABB"),
        ("frame/scale", 3.0, "power of two"),
        ("frame/scale", 0.0, "power of two"),
        ("frame/scale", None, "numbers"),
        ("frame/quantity", "some", "full or indirect"),
        ("frame/extra", 1, "aabb, scale and quantity"),
        ("quantised", [], "object as 'quantised'"),
        ("quantised/position.level.9", {"bits": 4, "block": 8}, "no such tensor"),
        ("quantised/position.level.1/bits", 5, "4 or 8 bits"),
        ("quantised/position.level.1/bits", 8, "codes"),
        ("quantised/position.level.1/block", 0, "blocks of at least 1"),
        ("quantised/position.level.1/block", 1e30, "blocks of at least 1"),
        ("quantised/position.level.1/block", 1 << 32, "scales"),
        ("quantised/position.level.1", 4, "4 or 8 bits"),
        ("provenance", 4, "object as 'provenance'"),
    ],
)
def test_absurd_metadata_is_refused(path: str, value: object, complaint: str) -> None:
    from safetensors.numpy import save

    about, tensors = coded_file()
    put(about, path, value)
    with pytest.raises(InputError, match=complaint) as caught:
        decode_field(save(tensors, {"irradia.field": json.dumps(about)}), "room.safetensors")
    assert str(caught.value.where).startswith("room.safetensors")


@pytest.mark.parametrize(
    ("name", "values", "complaint"),
    [
        ("mlp.0.bias", np.zeros(9, np.float16), "mlp.0.bias of shape"),
        ("mlp.0.bias", np.zeros(8, np.int8), "halves or floats"),
        ("mlp.0.bias", np.zeros(8, np.int64), "I64"),
        ("mlp.0.bias", np.full(8, np.nan, np.float16), "infinite or none"),
        ("mlp.0.bias", np.full(8, np.inf, np.float32), "infinite or none"),
        ("mlp.0.bias", None, "'mlp.0.bias' is missing"),
        ("position.level.1.codes", None, "codes' is missing"),
        ("position.level.1.codes", np.zeros(3, np.uint8), "expected codes"),
        ("position.level.1.scales", np.zeros(3, np.float16), "half scales"),
        ("position.level.1.scales", np.full(26, np.nan, np.float16), "infinite or none"),
        ("lamp", np.zeros(1, np.float16), "unknown tensor 'lamp'"),
        ("position.level.1", np.zeros((128, 2), np.float16), "unknown tensor"),
    ],
)
def test_wrong_tensors_are_refused(name: str, values: np.ndarray | None, complaint: str) -> None:
    from safetensors.numpy import save

    about, tensors = coded_file()
    if values is None:
        del tensors[name]
    else:
        tensors[name] = values
    with pytest.raises(InputError, match=complaint) as caught:
        decode_field(save(tensors, {"irradia.field": json.dumps(about)}), "room.safetensors")
    assert str(caught.value.where).startswith("room.safetensors")


def header(text: bytes) -> bytes:
    return struct.pack("<Q", len(text)) + text


DAMAGED = [
    (b"", "0 bytes"),
    (b"\0" * 7, "7 bytes"),
    (b"a field of light, as text", "no header"),
    (struct.pack("<Q", 1 << 63) + b"{}", "no header"),
    (header(b"[]"), "no object"),
    (header(b"{" * 5000), "damaged"),
    (header(b"[" * 50000), "damaged"),
    (header(b"\xff\xfe"), "damaged"),
    (header(b"{}"), "without 'irradia.field'"),
    (header(b'{"__metadata__":{"irradia.field":"{"}}'), "damaged"),
    (header(b'{"__metadata__":{"irradia.field":4}}'), "damaged"),
    (header(b'{"__metadata__":{"irradia.field":"[1]"}}'), "no object"),
    (golden()[:-1], "damaged"),
    (golden() + b"\0", "damaged"),
    (golden().replace(b'[0,2]', b'[0,4]'), "damaged"),
    (golden().replace(b'"F16"', b'"F32"', 1), "damaged"),
    (zstandard.compress(golden())[:-4], "unpacked"),
    (zstandard.compress(golden()) + b"\0\0", "unpacked"),
    (b"\x28\xb5\x2f\xfd", "unpacked"),
    (b"\x28\xb5\x2f\xfd\xe0" + struct.pack("<Q", 1 << 60) + b"\1\0\0", "at most"),
    (zstandard.ZstdCompressor(write_content_size=False).compress(golden()), "at most"),
    (zstandard.compress(b""), "0 bytes"),
]  # fmt: skip


@pytest.mark.parametrize(("data", "complaint"), DAMAGED)
def test_damage_is_refused_with_file_and_reason(tmp_path: Path, data: bytes, complaint: str) -> None:
    path = tmp_path / "room.safetensors"
    path.write_bytes(data)
    with pytest.raises(InputError, match=complaint) as caught:
        load_field(path)
    assert caught.value.where == str(path)


def test_a_flipped_bit_of_any_weight_is_damage() -> None:
    data = golden()
    (n_bytes,) = struct.unpack_from("<Q", data)
    for at in range(8 + n_bytes, len(data)):
        damaged = bytearray(data)
        damaged[at] ^= 0x01
        with pytest.raises(InputError, match="weights are damaged"):
            decode_field(bytes(damaged))


def test_a_file_of_before_checksums_is_read_and_gets_one_when_saved_again() -> None:
    stored = decode_field(golden(checksum=False))
    assert stored.provenance == {"seed": 7}
    assert encode_field(stored.field, stored.provenance) == golden()


def test_any_flipped_byte_is_an_input_error_or_another_field() -> None:
    data = golden(checksum=False)
    for at in range(len(data)):
        for flip in (0x01, 0x80, 0xFF):
            damaged = bytearray(data)
            damaged[at] ^= flip
            try:
                found = decode_field(bytes(damaged)).field
            except InputError:
                continue
            assert np.isfinite(found.irradiance(*places())).all() or at > len(data) - 56


def test_field_stays_what_it_was_when_saved_again(tmp_path: Path) -> None:
    path = tmp_path / "room.safetensors"
    save_field(path, made(PLANES), {"seed": 7})
    stored = read_field(path)
    save_field(tmp_path / "again.safetensors", stored.field, stored.provenance)
    assert (tmp_path / "again.safetensors").read_bytes() == path.read_bytes()
