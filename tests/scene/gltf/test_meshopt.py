"""Our meshopt decoder against the streams and outputs of its authors' own."""

from __future__ import annotations

import base64
import contextlib
import json
from pathlib import Path

import numpy as np
import pytest

from irradia.core.errors import InputError
from irradia.scene.gltf.meshopt import decode_buffer_view
from irradia.scene.gltf.view import JsonView

CASES = json.loads((Path(__file__).parent / "data" / "meshopt_streams.json").read_text())["cases"]
INTEGERS = {"NONE": "u1", "EXPONENTIAL": "u1", "OCTAHEDRAL": "i", "QUATERNION": "i", "COLOR": "u"}


def decode(case, encoded: bytes, **changes) -> bytes:
    return decode_buffer_view(JsonView({**case, **changes}, "/bufferViews/0"), memoryview(encoded))


@pytest.mark.parametrize("case", CASES, ids=lambda case: case["name"])
def test_streams_decode_to_the_references_bytes(case):
    kind = INTEGERS[case["filter"]]
    dtype = kind if kind == "u1" else f"<{kind}{case['byteStride'] // 4}"
    found = np.frombuffer(decode(case, base64.b64decode(case["encoded"])), dtype)
    expected = np.frombuffer(base64.b64decode(case["decoded"]), dtype)
    # The specification leaves filters one unit in the last place; all else is exact.
    tolerance = 0 if kind == "u1" else 1
    np.testing.assert_allclose(found.astype(int), expected.astype(int), rtol=0, atol=tolerance)


@pytest.mark.parametrize("mode", ["ATTRIBUTES", "TRIANGLES", "INDICES"])
def test_streams_cut_anywhere_are_input_errors(mode):
    case = next(c for c in CASES if c["mode"] == mode and c["count"] > 50)
    whole = base64.b64decode(case["encoded"])
    for length in range(0, len(whole), max(len(whole) // 40, 1)):
        with pytest.raises(InputError, match="/bufferViews/0"):
            decode(case, whole[:length])


@pytest.mark.parametrize("mode", ["ATTRIBUTES", "TRIANGLES", "INDICES"])
def test_streams_with_leftover_bytes_are_input_errors(mode):
    case = next(c for c in CASES if c["mode"] == mode and c["count"] > 50)
    with pytest.raises(InputError, match="damaged"):
        decode(case, base64.b64decode(case["encoded"]) + b"\x01" * 3)


def test_corrupted_streams_never_do_worse_than_an_input_error():
    random = np.random.default_rng(7)
    for case in CASES[::3]:
        stream = np.frombuffer(base64.b64decode(case["encoded"]), np.uint8).copy()
        for _ in range(20):
            damaged = stream.copy()
            damaged[random.integers(0, len(damaged), 3)] = random.integers(0, 256, 3)
            with np.errstate(all="ignore"), contextlib.suppress(InputError):
                assert len(decode(case, damaged.tobytes())) == case["count"] * case["byteStride"]


@pytest.mark.parametrize(
    "changes",
    [
        {"mode": "MESHLETS"},
        {"filter": "BLUR"},
        {"byteStride": 3},
        {"byteStride": 260},
        {"filter": "QUATERNION", "byteStride": 12},
        {"mode": "TRIANGLES", "byteStride": 2, "count": 4},
        {"mode": "INDICES", "byteStride": 8},
        {"mode": "INDICES", "byteStride": 4, "filter": "EXPONENTIAL"},
        {"count": 10**12},
        {"count": 0},
    ],
)
def test_contradictory_parameters_are_input_errors(changes):
    case = {"mode": "ATTRIBUTES", "byteStride": 12, "count": 3}
    with pytest.raises(InputError, match="/bufferViews/0"):
        decode(case, bytes([0xA0]) + bytes(64), **changes)


def test_explicit_triangle_of_new_vertices_starts_the_numbering_again():
    """Streams that were joined do so; the encoder behind the other cases never does."""
    codes, extra, table = bytes([0xF0, 0xFE]), bytes([0x00]), bytes(16)
    stream = bytes([0xE1]) + codes + extra + table
    decoded = decode({"mode": "TRIANGLES", "byteStride": 2, "count": 6}, stream)
    assert np.frombuffer(decoded, "<u2").tolist() == [0, 1, 2, 0, 1, 2]
