"""The baked .glb: what the bake touched is carried through, everything else is as it was."""

from __future__ import annotations

import base64
import json
import struct
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from irradia.core.errors import InternalError
from irradia.export.glb import baked_glb, write_baked_glb
from irradia.formats.ktx2 import decode_ktx2
from irradia.scene.gltf import GltfDocument, document_to_scene, read_document
from irradia.scene.gltf.accessors import Accessors

NAME = "IRRADIA_lighting"


def entries_of(json_: dict, node: dict) -> list[dict]:
    return node.get("extensions", {}).get(NAME, {}).get("primitives", [])


@pytest.mark.parametrize("compatible", [False, True])
def test_every_attribute_of_every_corner_is_what_it_was(
    gallery: GltfDocument, bake, corners, compatible: bool
) -> None:
    baked = bake(gallery, compatible=compatible)
    n_checked = 0
    for before, after in zip(gallery.json["nodes"], baked.json["nodes"], strict=False):
        if "mesh" not in before or "mesh" not in after:
            continue
        for index in range(len(gallery.json["meshes"][before["mesh"]]["primitives"])):
            expected = corners(gallery, before["mesh"], index)
            found = corners(baked.document, after["mesh"], index)
            entry = (entries_of(baked.json, after) or [{}] * 9)[index]
            for name, values in expected.items():
                if name != f"TEXCOORD_{entry.get('texCoord')}":
                    assert found[name].dtype == values.dtype
                    np.testing.assert_array_equal(found[name], values)
                    n_checked += 1
    assert n_checked > 25


@pytest.mark.parametrize("compatible", [False, True])
def test_lightmap_uv_lead_each_instance_to_its_place(
    gallery: GltfDocument, bake, corners, compatible: bool
) -> None:
    baked = bake(gallery, compatible=compatible)
    seen = []
    for node in baked.json["nodes"]:
        for index, entry in enumerate(entries_of(baked.json, node)):
            if not entry:
                continue
            uv = corners(baked.document, node["mesh"], index)[f"TEXCOORD_{entry['texCoord']}"]
            for page, scale, offset in placements(baked.document, entry):
                seen.append((page, uv * np.float32(scale) + np.float32(offset)))
    expected = [
        (int(page), baked.layout.unwraps[i.primitive].uv * scale + offset)
        for i, page, scale, offset in zip(
            baked.scene.instances, baked.layout.page, baked.layout.scale, baked.layout.offset, strict=True
        )
        if page >= 0
    ]
    assert len(seen) == len(expected) == 8
    for page, uv in expected:
        assert any(page == p and uv.shape == q.shape and np.allclose(uv, q, atol=1e-6) for p, q in seen), (
            "an instance has lost its place"
        )


def placements(document: GltfDocument, entry: dict) -> list[tuple]:
    if "scaleOffsets" not in entry:
        return [(entry["page"], entry.get("scale", (1, 1)), entry.get("offset", (0, 0)))]
    accessors = Accessors(document)
    table = accessors.read(entry["scaleOffsets"]).values
    pages = accessors.read(entry["pages"]).values[:, 0] if "pages" in entry else [entry["page"]] * len(table)
    return [(int(p), row[:2], row[2:]) for p, row in zip(pages, table, strict=True)]


def test_what_the_bake_does_not_touch_keeps_index_and_meaning(gallery: GltfDocument, bake) -> None:
    baked = bake(gallery)
    before, after = gallery.json, baked.json
    for key in ("cameras", "animations", "skins", "scenes", "scene"):
        assert after[key] == before[key]
    assert after["asset"]["copyright"] == "kept"
    for old, new in zip(before["nodes"], after["nodes"], strict=True):
        assert {k: v for k, v in old.items() if k not in ("mesh", "extensions")} == {
            k: v for k, v in new.items() if k not in ("mesh", "extensions")
        }
    stranger = after["extensions"]["ACME_stranger"]
    assert stranger["nodes"] == [4]
    assert bytes(Accessors(baked.document).read_view(stranger["bufferView"])) == b"kept as it is"
    old, new = Accessors(gallery), Accessors(baked.document)
    for accessor in used_outside_meshes(before):
        np.testing.assert_array_equal(new.read(accessor).values, old.read(accessor).values)


def used_outside_meshes(json_: dict) -> list[int]:
    sampler = json_["animations"][0]["samplers"][0]
    instancing = json_["nodes"][7]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"]
    return [
        sampler["input"],
        sampler["output"],
        json_["skins"][0]["inverseBindMatrices"],
        *instancing.values(),
    ]


def test_mesh_names_extras_weights_and_unlit_primitives_stay(gallery: GltfDocument, bake) -> None:
    baked = bake(gallery)
    meshes = baked.json["meshes"]
    assert meshes[0]["extras"] == {"targetNames": ["a", "b"]}
    assert meshes[0]["weights"] == [0.0, 0.0]
    assert [mesh["name"] for mesh in meshes[:4]] == ["morphing", "skinned", "strip and unlit", "shared"]
    assert meshes[2]["primitives"][1]["material"] == 2
    assert "TEXCOORD_1" not in meshes[2]["primitives"][1]["attributes"]


def test_shared_meshes_stay_shared_and_the_other_scene_keeps_its_own(gallery: GltfDocument, bake) -> None:
    nodes = bake(gallery).json["nodes"]
    assert nodes[5]["mesh"] == nodes[6]["mesh"] == nodes[7]["mesh"] != 3
    assert nodes[9]["mesh"] == 3


def test_reading_it_again_gives_the_same_triangles(gallery: GltfDocument, bake) -> None:
    for compatible in (False, True):
        baked = bake(gallery, compatible=compatible)
        again = document_to_scene(baked.document)
        assert soup(again).tobytes() == soup(baked.scene).tobytes()


def soup(scene) -> np.ndarray:
    """World positions of all triangles, sorted."""
    parts = []
    for instance in scene.instances:
        primitive = scene.primitives[instance.primitive]
        world = instance.world_from_object
        corners = primitive.positions[primitive.indices.ravel()] @ world[:3, :3].T + world[:3, 3]
        parts.append(np.round(corners, 4).reshape(-1, 9) + 0.0)
    rows = np.concatenate(parts)
    return rows[np.lexsort(rows.T)]


def test_texture_that_reads_uv_1_keeps_it(gallery: GltfDocument, bake, corners) -> None:
    baked = bake(gallery)
    node = baked.json["nodes"][4]
    assert entries_of(baked.json, node)[0]["texCoord"] == 2
    before, after = corners(gallery, 2, 0), corners(baked.document, node["mesh"], 0)
    np.testing.assert_array_equal(before["TEXCOORD_1"], after["TEXCOORD_1"])
    material = baked.json["materials"][baked.json["meshes"][node["mesh"]]["primitives"][0]["material"]]
    assert material["occlusionTexture"]["texCoord"] == 1
    assert material["extensions"]["MOZ_lightmap"]["texCoord"] == 2


def test_texcoord_sets_have_no_gap(bake, corners, gallery: GltfDocument) -> None:
    attributes = gallery.json["meshes"][1]["primitives"][0]["attributes"]
    del attributes["TEXCOORD_0"]
    baked = bake(gallery)
    written = baked.json["meshes"][1]["primitives"][0]["attributes"]
    assert written["TEXCOORD_0"] == written["TEXCOORD_1"]


def test_hdr_map_comes_back_with_its_scale(gallery: GltfDocument, bake) -> None:
    baked = bake(gallery)
    lightmap = baked.json["extensions"][NAME]["lightmap"]
    assert lightmap["quantity"] == "irradiance_over_pi"
    assert (lightmap["width"], lightmap["height"], lightmap["pages"]) == (20, 16, 2)
    texture = decode_ktx2(bytes(Accessors(baked.document).read_view(lightmap["bufferView"])))
    largest = baked.pages.max(axis=-1, keepdims=True)
    assert np.all(np.abs(texture.pages * lightmap["scale"] - baked.pages) <= largest / 512)
    assert 0.5 < np.percentile(texture.pages.max(axis=-1), 99.9) < 2.0


def test_lights_in_the_map_shine_no_more_but_stay_known(gallery: GltfDocument, bake) -> None:
    baked = bake(gallery)
    assert baked.json["nodes"][8]["extensions"] == {NAME: {"bakedLight": 0}}
    assert (
        baked.json["extensions"]["KHR_lights_punctual"] == gallery.json["extensions"]["KHR_lights_punctual"]
    )


def add_measured_light(document: GltfDocument) -> dict:
    """Puts a measured light on a node of its own, and returns what that says of it."""
    said = {"light": 0, "multiplier": 2.0, "color": [1.0, 0.5, 0.25]}
    table = b"IESNA:LM-63-2002\nTILT=NONE\n1 -1 1 2 1 1 2 0 0 0 1 1 0\n0 90\n0\n100 50\n"
    uri = "data:application/x-ies-lm-63;base64," + base64.b64encode(table).decode()
    document.json["extensions"]["EXT_lights_ies"] = {"lights": [{"uri": uri}]}
    document.json["extensionsUsed"].append("EXT_lights_ies")
    node = {"name": "measured lamp", "extensions": {"EXT_lights_ies": dict(said)}}
    document.json["nodes"].append(node)
    document.json["scenes"][0]["nodes"].append(len(document.json["nodes"]) - 1)
    return said


def test_measured_lights_in_the_map_shine_no_more_but_stay_known(gallery: GltfDocument, bake) -> None:
    said = add_measured_light(gallery)
    baked = bake(gallery)
    assert baked.json["nodes"][-1]["extensions"] == {NAME: {"bakedIesLight": said}}
    assert baked.json["extensions"]["EXT_lights_ies"] == gallery.json["extensions"]["EXT_lights_ies"]
    before, after = baked.scene.lights[-1], document_to_scene(baked.document).lights[-1]
    assert (after.name, after.intensity) == (before.name, before.intensity)
    assert after.intensity == (2.0, 1.0, 0.5)
    assert after.profile is not None


def test_measured_lights_come_back_once_they_are_live(gallery: GltfDocument, bake) -> None:
    said = add_measured_light(gallery)
    again = bake(gallery).document
    again.json["nodes"][-1]["extras"] = {"irradia": {"mode": "mixed"}}
    assert bake(again).json["nodes"][-1]["extensions"] == {"EXT_lights_ies": said}


def test_variants_read_the_lightmap_too(gallery: GltfDocument, bake) -> None:
    baked = bake(gallery)
    primitive = baked.json["meshes"][2]["primitives"][0]
    mapped = primitive["extensions"]["KHR_materials_variants"]["mappings"][0]["material"]
    page = int(baked.layout.page[[i.node_index for i in baked.scene.instances].index(4)])
    for index in (primitive["material"], mapped):
        texture = baked.json["materials"][index]["extensions"]["MOZ_lightmap"]["index"]
        image = baked.json["images"][baked.json["textures"][texture]["source"]]
        assert image["name"] == f"lightmap {page}"
    assert baked.json["materials"][mapped]["name"] == "plain"


def test_compatible_gives_every_instance_a_lightmap_that_old_loaders_read(
    gallery: GltfDocument, bake
) -> None:
    shared, compatible = bake(gallery).json, bake(gallery, compatible=True).json
    assert count_moz(shared) == 3
    assert count_moz(compatible) == 8
    assert "EXT_mesh_gpu_instancing" not in compatible["extensionsUsed"]
    children = [compatible["nodes"][i] for i in compatible["nodes"][7]["children"]]
    assert [child.get("translation") for child in children[1:]] == [[0, 0, 0], [9, 0, 0], [0, 5, 0]]
    assert "mesh" not in compatible["nodes"][7]


def count_moz(json_: dict) -> int:
    """Visible (node, primitive) pairs whose material reads a lightmap."""
    materials = json_["materials"]
    primitives = [p for n in json_["nodes"] if "mesh" in n for p in json_["meshes"][n["mesh"]]["primitives"]]
    return sum(
        "MOZ_lightmap" in materials[p["material"]].get("extensions", {})
        for p in primitives
        if "material" in p
    )


def test_replaced_data_is_dropped(gallery: GltfDocument, bake) -> None:
    baked = bake(gallery)
    covered = np.zeros(len(baked.document.buffers[0]), bool)
    for view in baked.json["bufferViews"]:
        covered[view["byteOffset"] : view["byteOffset"] + view["byteLength"]] = True
    assert np.count_nonzero(~covered) < 4 * len(baked.json["bufferViews"])
    colours = Accessors(gallery).read_view(gallery.json["accessors"][4]["bufferView"])
    assert bytes(colours) not in baked.document.buffers[0]


def test_views_that_primitives_share_with_others_shed_what_went(gallery: GltfDocument, bake) -> None:
    """Exporters put all vectors into one buffer view; one untouched primitive must not keep them all."""
    merge_views(gallery.json)
    baked = bake(gallery)
    old, new = Accessors(gallery), Accessors(baked.document)
    for accessor in used_outside_meshes(gallery.json):
        np.testing.assert_array_equal(new.read(accessor).values, old.read(accessor).values)
    delta = old.read(gallery.json["meshes"][0]["primitives"][0]["targets"][0]["POSITION"]).values.tobytes()
    assert delta in gallery.buffers[0]
    assert delta not in baked.document.buffers[0]


def merge_views(json_: dict) -> None:
    """Turns the views of all accessors but indices and sparse ones into one over the whole buffer."""
    views = json_["bufferViews"]
    before = list(views)
    for accessor in json_["accessors"]:
        view = before[accessor.get("bufferView", 0)]
        if accessor["type"] != "SCALAR" and "bufferView" in accessor and "byteStride" not in view:
            accessor["byteOffset"] = view["byteOffset"]
            views[accessor["bufferView"]] = {"buffer": 0, "byteOffset": 0, "byteLength": 4}
            accessor["bufferView"] = 0
    views[0] = {"buffer": 0, "byteOffset": 0, "byteLength": json_["buffers"][0]["byteLength"]}


def test_extensions_are_listed_once_and_images_move_inside(gallery: GltfDocument, bake) -> None:
    baked = bake(gallery)
    assert baked.json["extensionsUsed"] == [*gallery.json["extensionsUsed"], NAME, "MOZ_lightmap"]
    assert "extensionsRequired" not in baked.json
    assert baked.json["images"][0] == {"name": "swatch", "mimeType": "image/png"} | {
        "bufferView": baked.json["images"][0]["bufferView"]
    }
    assert baked.document.images[0] == gallery.images[0]


@pytest.mark.parametrize(
    "name", ["torus.draco.glb", "torus.meshopt.glb", "torus.gltfpack-cc.glb", "torus.gltfpack-cz.glb"]
)
def test_compressed_files_are_written_plain(repo_root: Path, bake, corners, name: str) -> None:
    document = read_document(repo_root / "tests" / "scene" / "gltf" / "data" / name)
    baked = bake(document)
    used = baked.json["extensionsUsed"] + baked.json.get("extensionsRequired", [])
    assert not [extension for extension in used if "draco" in extension or "meshopt" in extension]
    assert "compression" not in json.dumps(baked.json)
    before, after = corners(document, 0, 0), corners(baked.document, 0, 0)
    for attribute, values in before.items():
        if attribute != "TEXCOORD_1":
            np.testing.assert_array_equal(after[attribute].astype(values.dtype), values)


def test_large_meshes_take_32_bit_indices_and_small_ones_16(gallery: GltfDocument, bake) -> None:
    from irradia.scene.builtin.builder import SceneBuilder
    from irradia.scene.builtin.matte import matte
    from irradia.scene.builtin.shapes import floor

    builder = SceneBuilder("sizes")
    white = builder.material(matte("white", (0.5, 0.5, 0.5)))
    builder.object("large", (floor(1, 1, 0, 120, 120), white))
    builder.object("small", (floor(1, 1, 2), white))
    json_ = bake(builder.build()).json
    kinds = [json_["accessors"][m["primitives"][0]["indices"]]["componentType"] for m in json_["meshes"]]
    assert kinds == [5125, 5123]


def test_same_scene_is_the_same_bytes(gallery: GltfDocument, bake) -> None:
    first, second = bake(gallery).path.read_bytes(), bake(gallery).path.read_bytes()
    assert first == second


def test_container_is_aligned_and_says_its_length(gallery: GltfDocument, bake) -> None:
    data = bake(gallery).path.read_bytes()
    magic, version, length = struct.unpack_from("<4sII", data)
    assert (magic, version, length) == (b"glTF", 2, len(data))
    json_bytes = struct.unpack_from("<I", data, 12)[0]
    binary_bytes = struct.unpack_from("<I", data, 20 + json_bytes)[0]
    assert json_bytes % 4 == binary_bytes % 4 == 0
    assert 28 + json_bytes + binary_bytes == len(data)


def test_scene_that_takes_no_lightmap_is_written_without_one(gallery: GltfDocument, bake) -> None:
    baked = bake(gallery)
    dark = replace(baked.layout, page=np.full_like(baked.layout.page, -1))
    text = baked_glb(baked.scene, dark, baked.pages)
    json_ = json.loads(text[20 : 20 + struct.unpack_from("<I", text, 12)[0]])
    for key in ("meshes", "materials", "nodes", "accessors", "textures", "extensions"):
        assert json_[key] == gallery.json[key]


def test_scene_without_document_is_our_own_fault(gallery: GltfDocument, bake) -> None:
    baked = bake(gallery)
    with pytest.raises(InternalError, match="document"):
        baked_glb(replace(baked.scene, document=None), baked.layout, baked.pages)


def test_file_is_written_whole(gallery: GltfDocument, bake, tmp_path: Path) -> None:
    baked = bake(gallery)
    write_baked_glb(tmp_path / "out" / "scene.baked.glb", baked.scene, baked.layout, baked.pages)
    assert (tmp_path / "out" / "scene.baked.glb").read_bytes() == baked.path.read_bytes()
    assert [file.name for file in (tmp_path / "out").iterdir()] == ["scene.baked.glb"]


def test_baking_a_baked_file_again_replaces_its_lightmap(gallery: GltfDocument, bake) -> None:
    once = bake(gallery, compatible=True)
    again = bake(once.document, compatible=True)
    for key in ("materials", "textures", "images", "meshes", "nodes", "extensionsUsed"):
        assert len(again.json[key]) == len(once.json[key])
    assert count_moz(again.json) == count_moz(once.json)
    assert len(again.document.buffers[0]) < 1.02 * len(once.document.buffers[0])
    assert entries_of(again.json, again.json["nodes"][4])[0]["texCoord"] == 2
    assert again.json["nodes"][8]["extensions"] == {NAME: {"bakedLight": 0}}


def test_baked_file_without_lightmap_the_second_time_has_none(gallery: GltfDocument, bake) -> None:
    once = bake(gallery)
    scene = document_to_scene(once.document)
    dark = replace(once.layout, unwraps=(None,) * len(scene.primitives))
    data = baked_glb(scene, dark, once.pages)
    json_ = json.loads(data[20 : 20 + struct.unpack_from("<I", data, 12)[0]])
    assert "MOZ_lightmap" not in json.dumps(json_)
    assert [node for node in json_["nodes"] if entries_of(json_, node)] == []
    assert "lightmap" not in json_["extensions"].get(NAME, {})
