"""Every layout that an accessor may have gives the numbers that it stands for."""

from __future__ import annotations

import numpy as np
import pytest

from irradia.core.errors import InputError
from irradia.scene.gltf.accessors import Accessors


def floats(gltf, index, components):
    return Accessors(gltf.document()).read(index).floats(components)


@pytest.mark.parametrize(
    ("dtype", "stored", "expected"),
    [
        ("i1", [-128, -127, 0, 127], [-1, -1, 0, 1]),
        ("u1", [0, 51, 255, 255], [0, 0.2, 1, 1]),
        ("i2", [-32768, -32767, 0, 32767], [-1, -1, 0, 1]),
        ("u2", [0, 13107, 65535, 65535], [0, 0.2, 1, 1]),
    ],
)
def test_normalised_integers_span_the_unit_range(gltf, dtype, stored, expected):
    index = gltf.accessor([stored], dtype, normalized=True)
    np.testing.assert_allclose(floats(gltf, index, 4)[0], expected, atol=1e-7)


@pytest.mark.parametrize("dtype", ["i1", "u1", "i2", "u2", "u4", "f4"])
def test_plain_components_keep_their_values(gltf, dtype):
    index = gltf.accessor([[1, 2], [3, 100]], dtype)
    np.testing.assert_array_equal(floats(gltf, index, 2), [[1, 2], [3, 100]])


def test_interleaved_attributes_are_told_apart(gltf):
    rows = np.arange(15, dtype="<f4").reshape(3, 5)
    view = gltf.view(rows.tobytes(), byteStride=20)
    shared = {"bufferView": view, "componentType": 5126, "count": 3}
    first = gltf.add("accessors", {**shared, "type": "VEC3"})
    second = gltf.add("accessors", {**shared, "type": "VEC2", "byteOffset": 12})
    np.testing.assert_array_equal(floats(gltf, first, 3), rows[:, :3])
    np.testing.assert_array_equal(floats(gltf, second, 2), rows[:, 3:])


def test_matrix_columns_of_bytes_are_padded_to_four(gltf):
    data = bytes([1, 2, 99, 99, 3, 4, 99, 99])
    index = gltf.add(
        "accessors", {"bufferView": gltf.view(data), "componentType": 5121, "count": 1, "type": "MAT2"}
    )
    np.testing.assert_array_equal(floats(gltf, index, 4), [[1, 2, 3, 4]])


def sparse(gltf, count, where, what, index_dtype="u2"):
    index_type = {"u1": 5121, "u2": 5123, "u4": 5125, "i2": 5122}[index_dtype]
    return {
        "count": count,
        "indices": {
            "bufferView": gltf.view(np.asarray(where, index_dtype).tobytes()),
            "componentType": index_type,
        },
        "values": {"bufferView": gltf.view(np.asarray(what, "<f4").tobytes())},
    }


@pytest.mark.parametrize("index_dtype", ["u1", "u2", "u4"])
def test_sparse_values_replace_some_elements(gltf, index_dtype):
    index = gltf.accessor(np.zeros((4, 2)))
    gltf.json["accessors"][index]["sparse"] = sparse(gltf, 2, [1, 3], [[5, 6], [7, 8]], index_dtype)
    np.testing.assert_array_equal(floats(gltf, index, 2), [[0, 0], [5, 6], [0, 0], [7, 8]])


def test_sparse_without_a_buffer_view_starts_from_zeros(gltf):
    accessor = {"componentType": 5126, "count": 3, "type": "SCALAR", "sparse": sparse(gltf, 1, [2], [9])}
    assert floats(gltf, gltf.add("accessors", accessor), 1).ravel().tolist() == [0, 0, 9]


def test_sparse_does_not_write_into_the_document(gltf):
    index = gltf.accessor(np.zeros((4, 2)))
    gltf.json["accessors"][index]["sparse"] = sparse(gltf, 1, [1], [[5, 6]])
    document = gltf.document()
    before = document.buffers[0]
    Accessors(document).read(index)
    assert document.buffers[0] == before


def test_sparse_index_beyond_the_end_is_an_input_error(gltf):
    index = gltf.accessor(np.zeros((4, 2)))
    gltf.json["accessors"][index]["sparse"] = sparse(gltf, 1, [4], [[5, 6]])
    with pytest.raises(InputError, match=r"/accessors/0/sparse/indices: expected unsigned indices below 4"):
        floats(gltf, index, 2)


def test_accessor_that_ends_past_its_view_is_an_input_error(gltf):
    index = gltf.accessor(np.zeros((4, 2)))
    gltf.json["accessors"][index]["count"] = 5
    with pytest.raises(InputError, match=r"/accessors/0: its 5 elements end at byte 40"):
        floats(gltf, index, 2)


def test_view_that_ends_past_its_buffer_is_an_input_error(gltf):
    index = gltf.accessor(np.zeros((4, 2)))
    gltf.json["bufferViews"][0]["byteLength"] = 36
    with pytest.raises(InputError, match=r"/bufferViews/0: bytes 0 to 36 lie outside"):
        floats(gltf, index, 2)


def test_absurd_count_without_data_is_refused_before_it_is_allocated(gltf):
    index = gltf.add("accessors", {"componentType": 5126, "count": 10**15, "type": "VEC3"})
    with pytest.raises(InputError, match=r"/accessors/0/count"):
        floats(gltf, index, 3)


@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf])
def test_values_that_are_not_finite_name_the_accessor(gltf, value):
    gltf.accessor(np.zeros((1, 3)))
    index = gltf.accessor([[0, 0, 0], [0, value, 0]])
    with pytest.raises(InputError, match=r"/accessors/1: element 1 is not finite"):
        floats(gltf, index, 3)


@pytest.mark.parametrize(
    ("key", "value"),
    [
        ("componentType", 5124),
        ("componentType", "float"),
        ("type", "VEC5"),
        ("count", 0),
        ("count", -1),
        ("count", 1.5),
        ("byteOffset", -4),
        ("bufferView", 7),
        ("normalized", "yes"),
    ],
)
def test_malformed_accessors_name_the_key(gltf, key, value):
    index = gltf.accessor(np.zeros((4, 2)))
    gltf.json["accessors"][index][key] = value
    with pytest.raises(InputError, match=f"/accessors/0/{key}"):
        floats(gltf, index, 2)


def test_wrong_number_of_components_is_an_input_error(gltf):
    index = gltf.accessor(np.zeros((4, 2)))
    with pytest.raises(InputError, match=r"/accessors/0: expected 3 components, found 2"):
        floats(gltf, index, 3)


def test_missing_accessor_is_an_input_error(gltf):
    gltf.accessor(np.zeros((1, 3)))
    with pytest.raises(InputError, match=r"/accessors: expected an index below 1, found 3"):
        floats(gltf, 3, 3)
