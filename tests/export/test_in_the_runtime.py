"""What the exporter writes, @irradia/runtime reads to the same numbers as Python."""

from __future__ import annotations

import io
import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from irradia.bake.directional import DirectionalMaps
from irradia.bake.directional_modes import MODES
from irradia.core.rng import Seed
from irradia.core.sh import fibonacci_sphere
from irradia.export.field_extension import put_field
from irradia.export.glb import Companions, baked_glb
from irradia.export.probes_extension import read_baked_probes
from irradia.export.read_baked import read_baked
from irradia.field.encodings import (
    Composite,
    Frequency,
    HashGrid,
    Identity,
    OneBlob,
    SphericalHarmonics,
    TriPlane,
)
from irradia.field.field import Field
from irradia.field.init import new_parameters
from irradia.field.native_fields import decode_field, encode_field
from irradia.field.spec import FieldFrame, FieldSpec
from irradia.scene.gltf import read_document

from .probe_sets import OCTREE
from .probe_sets import made as made_probes

NODE_OF_INSTANCES = 7  # of the gallery, by EXT_mesh_gpu_instancing


@pytest.fixture
def read_in_node(runtime_node):
    """What the runtime reads in a .glb, as JSON."""

    def read(*arguments: Path) -> dict:
        done = runtime_node("print-baked.js", *arguments)
        assert done.returncode == 0, done.stderr
        return json.loads(done.stdout)

    return read


@pytest.mark.parametrize("encoding", ["rgb9e5", "half"])
@pytest.mark.parametrize("mode", MODES)
def test_lightmap_and_directional_maps(read_in_node, gallery, bake, tmp_path, mode, encoding):
    plain = bake(gallery)
    rng = np.random.default_rng(4)
    maps = {name: rng.random(plain.pages.shape).astype(np.float32) for name in MODES[mode].maps}
    directional = DirectionalMaps(mode, maps)
    path = tmp_path / "scene.baked.glb"
    path.write_bytes(
        baked_glb(
            plain.scene, plain.layout, plain.pages, Companions(directional=directional), encoding=encoding
        )
    )
    found, expected = read_in_node(path), read_baked(str(path))
    assert expected.directional is not None
    np.testing.assert_array_equal(np.float32(found["lightmap"]), expected.pages.ravel())
    assert list(found["directional"]) == list(MODES[mode].maps)
    for name, pages in expected.directional.pages.items():
        np.testing.assert_array_equal(np.float32(found["directional"][name]), pages.ravel())


def test_rectangles_of_every_instance(read_in_node, gallery, bake):
    baked = bake(gallery)
    nodes, expected = read_in_node(baked.path)["nodes"], read_baked(str(baked.path))
    checked = 0
    for index, instance in enumerate(expected.scene.instances):
        primitive = expected.scene.primitives[instance.primitive].primitive_index
        entry = nodes[str(instance.node_index)]["primitives"][primitive]
        if expected.layout.page[index] < 0:
            assert entry is None
            continue
        rectangle = entry["rectangles"][instance.gpu_instance or 0]
        assert rectangle["page"] == expected.layout.page[index]
        np.testing.assert_array_equal(np.float32(rectangle["scale"]), expected.layout.scale[index])
        np.testing.assert_array_equal(np.float32(rectangle["offset"]), expected.layout.offset[index])
        checked += 1
    assert checked > 5
    assert len(nodes[str(NODE_OF_INSTANCES)]["primitives"][0]["rectangles"]) == 3


def test_validity_and_the_light_of_the_map(read_in_node, gallery, bake, tmp_path):
    plain = bake(gallery)
    pages = np.random.default_rng(9).integers(0, 256, plain.pages.shape[:3]).astype(np.uint8)
    lamps = tuple(replace(lamp, mode="realtime") for lamp in plain.scene.lights)
    path = tmp_path / "validity.glb"
    scene = replace(plain.scene, lights=lamps)
    path.write_bytes(baked_glb(scene, plain.layout, plain.pages, Companions(validity=pages)))
    found = read_in_node(path)
    assert found["light"] == "indirect"
    for data, page in zip(found["validity"], pages, strict=True):
        with Image.open(io.BytesIO(bytes(data))) as image:
            np.testing.assert_array_equal(np.asarray(image), page)


@pytest.mark.parametrize("structure", ["grid", "octree", None])
def test_probes(read_in_node, gallery, bake, tmp_path, structure):
    probes = made_probes()
    if structure != "grid":
        probes = made_probes(structure=OCTREE if structure else None)
    plain = bake(gallery)
    path = tmp_path / "probes.glb"
    path.write_bytes(baked_glb(plain.scene, plain.layout, plain.pages, Companions(probes=probes)))
    found, expected = read_in_node(path)["probes"], read_baked_probes(read_document(path))
    assert expected is not None
    assert found.get("structure") == structure
    np.testing.assert_array_equal(
        np.float32(found["coefficients"]), expected.coefficients.reshape(len(probes), 27)
    )
    np.testing.assert_array_equal(np.float32(found["positions"]), expected.positions.ravel())
    assert found["states"] == expected.state.tolist()
    shares = expected.distance / expected.reach[:, None, None, None]
    np.testing.assert_allclose(np.array(found["distances"]) / 255.0, shares.ravel(), atol=1e-6)


PRIMES = (805459861, 2654435761, 1)
SPECS = {  # what vectors/ hold no example of
    "usual": FieldSpec(HashGrid(16, 12), SphericalHarmonics(5), width=64),
    "floor": FieldSpec(HashGrid(5, 10, 3, 5, 77, convention="floor", hash_all=True), Identity()),
    "primes": FieldSpec(HashGrid(4, 8, 1, 16, 100, primes=PRIMES), Identity(), width=7),
    "corners": FieldSpec(TriPlane(33, 5, align_corners=True), OneBlob(7), activation="gelu"),
    "waves": FieldSpec(Frequency(14), Frequency(2), n_hidden_layers=6, width=12, activation="silu"),
    "nested": FieldSpec(
        Composite((Composite((TriPlane(5, 2), Identity())), HashGrid(2, 6, 2, 4, 9))),
        head="linear",
        mode="sh2",
    ),
}


@pytest.mark.parametrize("name", SPECS)
@pytest.mark.parametrize("compress", [False, True])
def test_field(read_in_node, gallery, bake, tmp_path, name, compress):
    box = np.array([(-1, 0, 0.1), (1, 2.3, 4)], np.float32)
    data = encode_field(Field(SPECS[name], FieldFrame(box, 4.0), lively(SPECS[name])), compress=compress)
    path = bake(gallery).path
    put_field(path, data)
    positions = np.random.default_rng(7).uniform(box[0] - 0.1, box[1] + 0.1, (64, 3)).astype(np.float32)
    normals = fibonacci_sphere(64).astype(np.float32)
    questions = tmp_path / "questions.json"
    questions.write_text(json.dumps({"positions": positions.tolist(), "normals": normals.tolist()}))
    stored = replace(decode_field(data).field, backend_name="numpy")
    expected = stored.irradiance(positions, normals)
    found = np.array(read_in_node(path, questions)["irradiance"])
    assert np.abs(found - expected).max() <= 1e-5 * np.abs(expected).max()
    assert expected.std() > 0.01 * expected.mean() > 0.0


def lively(spec: FieldSpec) -> dict[str, np.ndarray]:
    """Weights whose every part matters."""
    parameters = new_parameters(spec, Seed(5))
    rng = np.random.default_rng(6)
    for name, values in parameters.items():
        if not name.endswith(".weight"):
            parameters[name] = rng.uniform(-0.5, 0.5, values.shape).astype(np.float32)
    return parameters
