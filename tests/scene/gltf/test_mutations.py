"""Whatever is wrong with a file, the error is ours and says where."""

from __future__ import annotations

import copy
import io
import random
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from PIL import Image as PillowImage

from irradia.core.errors import InputError
from irradia.scene.gltf import GltfDocument, document_to_scene, make_document, read_document

WRONG = [
    None,
    True,
    -1,
    0,
    1,
    7,
    10**12,
    0.5,
    1e30,
    "x",
    "",
    [],
    [0],
    [None],
    {},
    {"index": 0},
    [[0] * 3] * 3,
]


def spots(value, path=()):
    """Every place in a JSON value."""
    yield path
    children = (
        value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
    )
    for key, child in children:
        yield from spots(child, (*path, key))


def rich_document(gltf):
    """A bit of everything."""
    triangle = [[0, 0, 0], [1, 0, 0], [0, 1, 0]]
    gltf.add("images", {"bufferView": gltf.view(png())})
    gltf.add("samplers", {"wrapS": 33071, "magFilter": 9728})
    gltf.add("textures", {"source": 0, "sampler": 0})
    info = {
        "index": 0,
        "texCoord": 0,
        "extensions": {"KHR_texture_transform": {"offset": [0, 1], "rotation": 1}},
    }
    gltf.add(
        "materials",
        {
            "name": "m",
            "pbrMetallicRoughness": {"baseColorFactor": [1, 1, 1, 1], "baseColorTexture": info},
            "emissiveFactor": [1, 1, 1],
            "extensions": {
                "KHR_materials_transmission": {"transmissionFactor": 0.5, "transmissionTexture": info},
                "KHR_materials_pbrSpecularGlossiness": {"specularGlossinessTexture": info},
            },
        },
    )
    joints = [gltf.node(translation=[0, 1, 0]), gltf.node(rotation=[0, 0, 0, 1])]
    gltf.add("skins", {"joints": joints, "inverseBindMatrices": gltf.accessor([np.eye(4).ravel()] * 2)})
    attributes = {
        "POSITION": triangle,
        "TEXCOORD_0": [[0, 0]] * 3,
        "JOINTS_0": gltf.accessor([[0, 1, 0, 0]] * 3, "u1"),
        "WEIGHTS_0": [[0.5, 0.5, 0, 0]] * 3,
    }
    target = {"POSITION": gltf.accessor([[0, 0, 1]] * 3)}
    mesh = gltf.mesh(attributes, [0, 1, 2], material=0, targets=[target])
    variant = {"mappings": [{"material": 0, "variants": [0]}]}
    gltf.json["meshes"][mesh]["primitives"][0]["extensions"] = {"KHR_materials_variants": variant}
    gltf.json["meshes"][mesh]["weights"] = [0.5]
    gltf.node(mesh=mesh, skin=0)
    gltf.add("cameras", {"type": "perspective", "perspective": {"yfov": 1, "znear": 0.1}})
    light = {"type": "spot", "intensity": 5, "spot": {"outerConeAngle": 0.5}}
    gltf.json["extensions"] = {
        "KHR_lights_punctual": {"lights": [light]},
        "KHR_materials_variants": {"variants": [{"name": "v"}]},
    }
    instancing = {"attributes": {"TRANSLATION": gltf.accessor([[1, 0, 0], [2, 0, 0]])}}
    gltf.node(
        mesh=mesh,
        camera=0,
        extensions={"KHR_lights_punctual": {"light": 0}, "EXT_mesh_gpu_instancing": instancing},
        extras={"irradia": {"lightmapScale": 2}},
    )
    sampler = {"input": gltf.accessor([0, 1]), "output": gltf.accessor([[0, 0, 0], [1, 0, 0]])}
    channel = {"sampler": 0, "target": {"node": joints[0], "path": "translation"}}
    gltf.add("animations", {"samplers": [sampler], "channels": [channel]})
    gltf.json["scenes"] = [{"nodes": [0, 1, 2, 3]}]
    gltf.json["scene"] = 0
    return gltf.document()


def png() -> bytes:
    stream = io.BytesIO()
    PillowImage.new("RGBA", (2, 2), (1, 2, 3, 4)).save(stream, "PNG")
    return stream.getvalue()


def mutate(json, path, value):
    parent = json
    for key in path[:-1]:
        parent = parent[key]
    if value is KeyError and isinstance(parent, dict):
        del parent[path[-1]]
    elif value is not KeyError:
        parent[path[-1]] = value


def error_of(load: Callable[[], GltfDocument], variant: str | None = None) -> InputError | None:
    """The error that importing ends with, if it is ours; others pass through."""
    with np.errstate(all="ignore"):
        try:
            document_to_scene(load(), pose_time=0.5, variant=variant)
        except InputError as error:
            return error
    return None


def test_rich_document_imports(gltf):
    document = rich_document(gltf)
    scene = document_to_scene(document, pose_time=0.5, variant="v")
    assert (len(scene.instances), len(scene.lights), len(scene.cameras)) == (3, 1, 1)


def test_every_wrong_value_anywhere_is_read_or_an_input_error(gltf):
    document = rich_document(gltf)
    outcomes = set()
    for path in spots(document.json):
        for value in (*WRONG, KeyError):
            if path:
                json = copy.deepcopy(document.json)
                mutate(json, path, value)
                error = error_of(lambda json=json: make_document(json, document.buffers[0]), "v")
                outcomes.add(error is None)
                assert error is None or error.where
    assert outcomes == {True, False}


@pytest.mark.parametrize("name", ["torus.draco.glb", "torus.meshopt.glb", "torus.gltfpack-cz.glb"])
def test_random_bytes_in_compressed_files_are_read_or_an_input_error(tmp_path, name):
    whole = (Path(__file__).parent / "data" / name).read_bytes()
    generator = random.Random(5)
    for _ in range(60):
        damaged = bytearray(whole)
        for _ in range(4):
            damaged[generator.randrange(len(damaged))] = generator.randrange(256)
        (tmp_path / "x.glb").write_bytes(damaged)
        error = error_of(lambda: read_document(tmp_path / "x.glb"))
        assert error is None or error.where
