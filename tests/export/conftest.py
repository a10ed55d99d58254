"""A document with one of everything that an exporter can spoil, and a way to see whether it did."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from irradia.export.glb import baked_glb
from irradia.scene.gltf import GltfDocument, document_to_scene, make_document, read_document
from irradia.scene.gltf.accessors import Accessors
from irradia.scene.gltf.stored import read_stored_primitive
from irradia.scene.gltf.topology import unroll_triangles
from irradia.scene.gltf.view import JsonView
from irradia.scene.layout import LightmapLayout, Unwrap
from irradia.scene.types import Scene

_COMPONENT_TYPES = {"i1": 5120, "u1": 5121, "i2": 5122, "u2": 5123, "u4": 5125, "f4": 5126}
_KINDS = {1: "SCALAR", 2: "VEC2", 3: "VEC3", 4: "VEC4", 16: "MAT4"}
PNG = bytes.fromhex(
    "89504e470d0a1a0a0000000d4948445200000001000000010802000000907753de"
    "0000000c49444154789c63f8cfc000000301010018dd8db00000000049454e44ae426082"
)


class Maker:
    """Writes accessors one behind another."""

    def __init__(self) -> None:
        self.json: dict[str, Any] = {"asset": {"version": "2.0", "copyright": "kept"}}
        self.binary = bytearray()

    def add(self, key: str, entry: Any) -> int:
        self.json.setdefault(key, []).append(entry)
        return len(self.json[key]) - 1

    def view(self, data: bytes, **fields: Any) -> int:
        self.binary.extend(bytes(-len(self.binary) % 4))
        entry = {"buffer": 0, "byteOffset": len(self.binary), "byteLength": len(data), **fields}
        self.binary.extend(data)
        return self.add("bufferViews", entry)

    def accessor(self, values: Any, dtype: str = "f4", **fields: Any) -> int:
        rows = np.asarray(values, f"<{dtype}")
        rows = rows.reshape(len(rows), -1)
        size = rows.shape[1] * rows.itemsize
        padded = size if rows.shape[1] == 1 else -(-size // 4) * 4
        packed = np.zeros((len(rows), padded), np.uint8)
        packed[:, :size] = np.ascontiguousarray(rows).view(np.uint8)
        stride = {"byteStride": padded} if padded != size else {}
        entry = {"componentType": _COMPONENT_TYPES[dtype], "count": len(rows), "type": _KINDS[rows.shape[1]]}
        return self.add("accessors", {"bufferView": self.view(packed.tobytes(), **stride), **entry, **fields})

    def document(self) -> GltfDocument:
        self.json["buffers"] = [{"byteLength": len(self.binary)}]
        return make_document(self.json, bytes(self.binary), name="made")


@pytest.fixture
def gallery() -> GltfDocument:
    """Morphs, a skin, quantised data, a strip, sharing, instancing, variants, an animation and strangers."""
    make = Maker()
    rng = np.random.default_rng(20)
    grid = np.array([(x, y, 0) for y in range(3) for x in range(3)], np.float32)
    quads = np.array([(0, 1, 4), (0, 4, 3), (1, 2, 5), (1, 5, 4), (3, 4, 7), (3, 7, 6), (4, 5, 8), (4, 8, 7)])
    up = np.tile((0.0, 0.0, 1.0), (9, 1))

    def bounds(values: np.ndarray) -> dict[str, list[float]]:
        return {"min": values.min(0).tolist(), "max": values.max(0).tolist()}

    positions = make.accessor(grid, **bounds(grid))
    normals = make.accessor(up)
    indices = make.accessor(quads.ravel(), "u2")
    quantised_uv = make.accessor(rng.integers(0, 65536, (9, 2)), "u2", normalized=True, name="uv")
    colours = make.accessor(rng.integers(0, 256, (9, 3)), "u1", normalized=True)
    second_uv = make.accessor(rng.random((9, 2)))
    common = {"POSITION": positions, "NORMAL": normals, "TEXCOORD_0": quantised_uv}

    make.add("images", {"name": "swatch", "uri": "data:image/png;base64," + _base64(PNG)})
    make.add("textures", {"source": 0})
    make.add("materials", {"name": "plain", "pbrMetallicRoughness": {"metallicFactor": 0.0}})
    occlusion = {"index": 0, "texCoord": 1}
    make.add("materials", {"name": "reads uv 1", "occlusionTexture": occlusion, "extras": {"kept": [1]}})
    make.add("materials", {"name": "unlit", "extensions": {"KHR_materials_unlit": {}}})

    delta = {"POSITION": make.accessor(rng.normal(size=(9, 3)), min=[-9] * 3, max=[9] * 3)}
    sparse = {
        "count": 2,
        "indices": {"bufferView": make.view(np.array([1, 7], "<u2").tobytes()), "componentType": 5123},
        "values": {"bufferView": make.view(rng.normal(size=(2, 3)).astype("<f4").tobytes())},
    }
    sparse_delta = {"componentType": 5126, "count": 9, "type": "VEC3", "sparse": sparse}
    targets = [delta, {"POSITION": make.add("accessors", sparse_delta)}]
    morphing = {"attributes": {**common, "COLOR_0": colours}, "indices": indices, "targets": targets}
    make.add(
        "meshes",
        {"name": "morphing", "weights": [0.0, 0.0], "extras": {"targetNames": ["a", "b"]},
         "primitives": [{**morphing, "material": 0}]},
    )  # fmt: skip
    joints = make.accessor(np.tile((0, 1, 0, 0), (9, 1)), "u1")
    weights = make.accessor(np.tile((192, 63, 0, 0), (9, 1)), "u1", normalized=True)
    skinned = {**common, "JOINTS_0": joints, "WEIGHTS_0": weights}
    make.add("meshes", {"name": "skinned", "primitives": [{"attributes": skinned, "indices": indices}]})
    strip = make.accessor([0, 3, 1, 4, 2, 5], "u2")
    variants = {"KHR_materials_variants": {"mappings": [{"material": 0, "variants": [0]}]}}
    two = [
        {"attributes": {**common, "TEXCOORD_1": second_uv, "_CUSTOM": second_uv}, "indices": strip, "mode": 5,
         "material": 1, "extensions": variants},
        {"attributes": {"POSITION": positions}, "indices": indices, "material": 2},
    ]  # fmt: skip
    make.add("meshes", {"name": "strip and unlit", "primitives": two})
    make.add(
        "meshes",
        {"name": "shared", "primitives": [{"attributes": common, "indices": indices, "material": 0}]},
    )

    identity = np.tile(np.eye(4).ravel(), (2, 1))
    make.add("skins", {"joints": [2, 3], "inverseBindMatrices": make.accessor(identity)})
    moves = make.accessor([(0, 0, 0), (9, 0, 0), (0, 5, 0)])
    sizes = make.accessor([(1, 1, 1), (2, 2, 2), (1, 1, 1)])
    instancing = {"EXT_mesh_gpu_instancing": {"attributes": {"TRANSLATION": moves, "SCALE": sizes}}}
    lamp = {"KHR_lights_punctual": {"light": 0}}
    for node in (
        {"mesh": 0, "name": "a", "extras": {"kept": True}},
        {"mesh": 1, "skin": 0, "name": "b"},
        {"name": "joint", "children": [3]},
        {"name": "joint too", "translation": [0, 0, 1]},
        {"mesh": 2, "name": "c", "translation": [0, 0, 5]},
        {"mesh": 3, "name": "d", "translation": [20, 0, 0]},
        {"mesh": 3, "name": "e", "scale": [-1, 1, 1]},
        {"mesh": 3, "name": "f", "extensions": instancing, "children": [8]},
        {"name": "camera and lamp", "camera": 0, "extensions": lamp},
        {"mesh": 3, "name": "in another scene"},
    ):
        make.add("nodes", node)
    make.json["scenes"] = [{"nodes": [0, 1, 2, 4, 5, 6, 7]}, {"nodes": [9]}]
    make.json["scene"] = 0
    make.add("cameras", {"type": "perspective", "perspective": {"yfov": 1.0, "znear": 0.1}})
    times = make.accessor([0.0, 1.0], min=[0.0], max=[1.0])
    sampler = {"input": times, "output": make.accessor([0.0, 0.0, 1.0, 1.0])}
    channel = {"sampler": 0, "target": {"node": 0, "path": "weights"}}
    make.add("animations", {"samplers": [sampler], "channels": [channel]})
    make.json["extensions"] = {
        "KHR_lights_punctual": {"lights": [{"type": "point"}]},
        "KHR_materials_variants": {"variants": [{"name": "plain"}]},
        "ACME_stranger": {"bufferView": make.view(b"kept as it is"), "nodes": [4]},
    }
    make.json["extensionsUsed"] = [
        "KHR_lights_punctual",
        "KHR_materials_variants",
        "KHR_materials_unlit",
        "EXT_mesh_gpu_instancing",
        "ACME_stranger",
    ]
    return make.document()


def _base64(data: bytes) -> str:
    import base64

    return base64.b64encode(data).decode()


@dataclass(frozen=True)
class Baked:
    """An exported scene and what it came from."""

    scene: Scene
    layout: LightmapLayout
    pages: np.ndarray
    document: GltfDocument
    path: Path

    @property
    def json(self) -> dict[str, Any]:
        return self.document.json


@pytest.fixture
def bake(tmp_path: Path):
    """Exports a document with a made-up layout: every triangle a chart, instances in cells, two pages."""

    def run(document: GltfDocument, *, compatible: bool = False) -> Baked:
        scene = document_to_scene(document)
        layout = made_up_layout(scene)
        rng = np.random.default_rng(21)
        pages = rng.random((layout.n_pages, layout.height_px, layout.width_px, 3)).astype(np.float32) * 3
        path = tmp_path / f"{'compatible' if compatible else 'shared'}.glb"
        path.write_bytes(baked_glb(scene, layout, pages, compatible=compatible))
        return Baked(scene, layout, pages, read_document(path), path)

    return run


def made_up_layout(scene: Scene) -> LightmapLayout:
    """Splits all corners; unlit materials have no place. Instance i has cell i of a 5 × 5 grid."""
    unwraps = []
    for primitive in scene.primitives:
        corners = primitive.indices.ravel()
        uv = np.random.default_rng(len(corners)).random((len(corners), 2)).astype(np.float32)
        triangles = np.arange(len(corners), dtype=np.uint32).reshape(-1, 3)
        unlit = scene.materials[primitive.material].unlit
        unwraps.append(None if unlit else Unwrap(corners, triangles, uv, triangles[:, 0] // 3))
    numbers = np.arange(len(scene.instances))
    lit = np.array([unwraps[instance.primitive] is not None for instance in scene.instances])
    cells = np.stack([numbers % 5, numbers // 5], axis=1)
    return LightmapLayout(
        n_pages=2,
        width_px=20,
        height_px=16,
        unwraps=tuple(unwraps),
        page=np.where(lit, numbers % 2, -1).astype(np.int32),
        scale=np.full((len(numbers), 2), 0.2, np.float32),
        offset=(cells * 0.2).astype(np.float32),
        texels_per_metre=1.0,
    )


@pytest.fixture
def corners():
    """Reads every attribute at every triangle corner of a mesh primitive, in the types of the file."""

    def read(document: GltfDocument, mesh: int, primitive: int) -> dict[str, np.ndarray]:
        view = JsonView(document.json).items("meshes")[mesh].items("primitives")[primitive]
        stored = read_stored_primitive(Accessors(document), view)
        triangles = unroll_triangles(stored).ravel()
        found = {name: data.values[triangles] for name, data in stored.attributes.items()}
        for index, target in enumerate(stored.targets):
            found |= {f"{index} {name}": data.values[triangles] for name, data in target.items()}
        return found

    return read


@pytest.fixture
def draw_in_three_js(web_check, chromium: str, tmp_path: Path):
    """Draws a .glb with stock three.js: ``draw(glb, view)`` gives linear (H, W, 3), top row first.

    ``view`` is the View of web/checks/view.ts.
    """

    def draw(glb: Path, view: dict[str, Any]) -> np.ndarray:
        (tmp_path / "view.json").write_text(json.dumps(view))
        drawing = web_check("draw", glb, tmp_path / "view.json", chromium)
        rgba = np.array(drawing["pixels"], np.float64).reshape(view["height"], view["width"], 4)
        return rgba[::-1, :, :3]

    return draw
