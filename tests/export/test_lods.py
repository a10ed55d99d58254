"""Levels of detail are written back, each with its own part of the lightmap."""

from __future__ import annotations

import numpy as np
import pytest

from irradia.export.read_baked import read_baked
from irradia.scene.gltf import GltfDocument, document_to_scene

NAME = "IRRADIA_lighting"


@pytest.fixture
def levels(gallery: GltfDocument) -> GltfDocument:
    """Node 5 with two lower levels, 10 and 11, that the scene doesn't list; 10 shares the mesh of 5."""
    nodes = gallery.json["nodes"]
    nodes[5]["extensions"] = {"MSFT_lod": {"ids": [10, 11]}}
    nodes[5]["extras"] = {"MSFT_screencoverage": [0.5, 0.2, 0.1]}
    nodes.append({"mesh": 3, "name": "d, coarser", "translation": [20, 0, 0], "scale": [1, 1, 2]})
    nodes.append({"mesh": 0, "name": "d, coarsest", "translation": [20, 0, 0]})
    gallery.json["extensionsUsed"].append("MSFT_lod")
    return gallery


@pytest.mark.parametrize("compatible", [False, True])
def test_levels_keep_their_nodes_and_each_reads_the_lightmap(levels, bake, compatible):
    baked = bake(levels, compatible=compatible)
    nodes = baked.json["nodes"]
    assert nodes[5]["extensions"]["MSFT_lod"] == {"ids": [10, 11]}
    assert nodes[5]["extras"] == {"MSFT_screencoverage": [0.5, 0.2, 0.1]}
    assert "MSFT_lod" in baked.json["extensionsUsed"]
    for index, instance in enumerate(baked.scene.instances):
        if instance.lod_group is not None:
            entry = nodes[instance.node_index]["extensions"][NAME]["primitives"][0]
            assert entry["page"] == baked.layout.page[index]
    assert sum(i.lod_group is not None for i in baked.scene.instances) == 3


@pytest.mark.parametrize("compatible", [False, True])
def test_baked_levels_are_read_back_as_such(levels, bake, compatible):
    baked = bake(levels, compatible=compatible)
    again = read_baked(str(baked.path))
    found = {i.name: (i.lod_group, i.lod_level) for i in again.scene.instances if i.lod_group is not None}
    assert found == {"d": (0, 0), "d, coarser": (0, 1), "d, coarsest": (0, 2)}
    for name in found:
        assert _page_uv(again.scene, again.layout, name) == pytest.approx(
            _page_uv(baked.scene, baked.layout, name), abs=1e-6
        )


def _page_uv(scene, layout, name: str) -> np.ndarray:
    """Mean place on the page of an object's corners."""
    index = next(i for i, instance in enumerate(scene.instances) if instance.name == name)
    unwrap = layout.unwraps[scene.instances[index].primitive]
    corners = unwrap.uv[unwrap.indices.ravel()] * layout.scale[index] + layout.offset[index]
    return corners.mean(axis=0)


def test_lower_levels_of_a_material_stay_and_read_the_lightmap_too(gallery: GltfDocument, bake):
    materials = gallery.json["materials"]
    materials.append({"name": "plainer"})
    materials[0]["extensions"] = {"MSFT_lod": {"ids": [len(materials) - 1]}}
    baked = bake(gallery)
    assert document_to_scene(baked.document).materials
    lit = [
        m for m in baked.json["materials"] if m.get("name") == "plain" and "MOZ_lightmap" in m["extensions"]
    ]
    assert lit
    for material in lit:
        lower = baked.json["materials"][material["extensions"]["MSFT_lod"]["ids"][0]]
        assert lower["name"] == "plainer"
        assert lower["extensions"]["MOZ_lightmap"] == material["extensions"]["MOZ_lightmap"]
