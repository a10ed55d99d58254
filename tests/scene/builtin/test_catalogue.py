"""Laws that every built-in scene obeys."""

from __future__ import annotations

import json

import numpy as np
import pytest

from irradia.core.errors import InputError
from irradia.scene.builtin import NAMES, build_document

MIB = 1 << 20


def test_unknown_name_is_an_input_error_that_suggests_the_nearest():
    with pytest.raises(InputError, match="builtin:cornell"):
        build_document("cornel")


@pytest.mark.parametrize("name", NAMES)
def test_two_builds_give_the_same_bytes(name, document):
    first, second = document(name), build_document(name)
    assert json.dumps(first.json) == json.dumps(second.json)
    assert first.buffers == second.buffers
    assert first.images == second.images


@pytest.mark.parametrize("name", NAMES)
def test_geometric_and_vertex_normals_agree(name, parts):
    for part in parts(name):
        a, b, c = (part.positions[part.indices[:, k]] for k in range(3))
        geometric = np.cross(b - a, c - a)
        area = np.linalg.norm(geometric, axis=1, keepdims=True) / 2
        assert area.min() > 1e-10, f"{part.node}: degenerate triangle"
        cosine = np.einsum("tc,tkc->tk", geometric / (2 * area), part.normals[part.indices])
        assert cosine.min() > 0.05, f"{part.node}/{part.material}: a vertex normal points backward"


@pytest.mark.parametrize("name", NAMES)
def test_attributes_are_finite_and_uv_stays_small(name, parts):
    for part in parts(name):
        assert np.isfinite(part.positions).all()
        assert np.abs(np.linalg.norm(part.normals, axis=1) - 1).max() < 1e-4
        assert part.uv.min() >= -1.0
        assert part.uv.max() <= 256.0
        assert part.indices.max() == len(part.positions) - 1


@pytest.mark.parametrize("name", NAMES)
def test_document_refers_only_to_what_it_has(name, document):
    entry = document(name).json
    assert len(entry["scenes"][0]["nodes"]) == len(set(entry["scenes"][0]["nodes"])) == len(entry["nodes"])
    assert len(entry["cameras"]) >= 1
    for view in entry["bufferViews"]:
        assert view["byteOffset"] % 4 == 0
        assert view["byteOffset"] + view["byteLength"] <= entry["buffers"][0]["byteLength"]
    assert entry["buffers"][0]["byteLength"] == len(document(name).buffers[0])
    assert len(entry.get("images", [])) == len(document(name).images)


@pytest.mark.parametrize("name", NAMES)
def test_light_from_outside_is_asked_for_in_the_documented_schema(name, document):
    settings = document(name).json["extras"]["irradia"]
    assert set(settings) in ({"sky"}, {"environmentColor"})
    if "sky" in settings:
        assert set(settings["sky"]) == {"sunElevationDeg", "sunAzimuthDeg", "turbidity", "sun"}


# A terrain of a million triangles is large on purpose.
@pytest.mark.parametrize("name", [name for name in NAMES if name != "terrain"])
def test_document_fits_beside_its_lightmap(name, document):
    assert len(document(name).buffers[0]) + len(json.dumps(document(name).json)) < 12 * MIB
