"""Probes inside a baked .glb: written, read back, valid by schema; damage refused."""

from __future__ import annotations

import copy
from pathlib import Path

import numpy as np
import pytest

from irradia.core.errors import InputError
from irradia.export.probe_files import write_probe_files
from irradia.export.probes_extension import add_probes, read_baked_probes
from irradia.export.slots import Slots
from irradia.formats.probes import VALID, ProbeGrid, ProbeOctree, ProbeSet
from irradia.formats.probes_bin import read_probes_bin
from irradia.scene.gltf import GltfDocument, make_document
from irradia.scene.gltf.accessors import Accessors

from .probe_sets import OCTREE, made


def with_probes(probes: ProbeSet) -> GltfDocument:
    empty = make_document({"asset": {"version": "2.0"}}, b"", name="empty")
    json = copy.deepcopy(empty.json)
    slots = Slots(json, Accessors(empty))
    add_probes(json, slots, probes)
    return make_document(json, slots.finish(), name="with probes")


@pytest.mark.parametrize("structure", [made().structure, OCTREE, None])
def test_probes_come_back_within_half_precision(structure) -> None:
    probes = made(structure=structure)
    found = read_baked_probes(with_probes(probes))
    assert found is not None
    for exact in ("positions", "offsets", "validity", "state", "sky", "reach"):
        np.testing.assert_array_equal(getattr(found, exact), getattr(probes, exact))
    np.testing.assert_allclose(found.coefficients, probes.coefficients, rtol=1e-3, atol=1e-6)
    step = probes.reach.max() / 255
    np.testing.assert_allclose(found.distance, probes.distance, atol=0.51 * step)
    assert found.light == "indirect"
    match structure, found.structure:
        case ProbeGrid(), ProbeGrid(origin, spacing, shape):
            assert shape == structure.shape
            np.testing.assert_array_equal(origin, structure.origin)
            np.testing.assert_array_equal(spacing, structure.spacing)
        case ProbeOctree(), ProbeOctree(origin, size_m, cells, corners):
            assert size_m == structure.size_m
            np.testing.assert_array_equal(origin, structure.origin)
            np.testing.assert_array_equal(cells, structure.cells)
            np.testing.assert_array_equal(corners, structure.corners)
        case None, other:
            assert other is None


def test_bright_light_is_scaled_into_the_range_of_halfs() -> None:
    probes = made(coefficients=made().coefficients * np.float32(1e7))
    document = with_probes(probes)
    scale = document.json["extensions"]["IRRADIA_lighting"]["probes"]["scale"]
    assert np.log2(scale) == round(np.log2(scale))
    found = read_baked_probes(document)
    assert found is not None
    np.testing.assert_allclose(found.coefficients, probes.coefficients, rtol=1e-3, atol=10)


def test_document_without_probes_has_none() -> None:
    assert read_baked_probes(make_document({"asset": {"version": "2.0"}}, b"", name="bare")) is None


@pytest.mark.parametrize(
    ("key", "value"),
    [("count", 11), ("count", 0), ("positions", {"bufferView": 99}), ("positions", {"bufferView": 0}),
     ("positions", 1), ("coefficients", {"bufferView": 1}), ("coefficients", {}), ("light", "none"),
     ("scale", "x"), ("distances", {"size": 8, "bufferView": 7}),
     ("distances", {"size": 1 << 30, "bufferView": 7}), ("grid", {"shape": [2, 3, 3]}),
     ("grid", {"shape": [2, 3]}), ("states", {"bufferView": 0})],
)  # fmt: skip
def test_damage_is_refused(key, value) -> None:
    document = with_probes(made())
    document.json["extensions"]["IRRADIA_lighting"]["probes"][key] = value
    with pytest.raises(InputError):
        read_baked_probes(document)


def test_schema_allows_what_is_written_and_nothing_else(
    web_check, repo_root: Path, tmp_path: Path, gallery: GltfDocument, bake
) -> None:
    """The extension's own schema, through ajv, on a whole baked file."""
    import json
    import struct

    path = bake(gallery).path
    data = path.read_bytes()
    end = 20 + struct.unpack_from("<I", data, 12)[0]
    root = json.loads(data[20:end])
    for probes, wrong in ((made(), False), (made(structure=OCTREE), False), (made(), True)):
        entry = with_probes(probes).json["extensions"]["IRRADIA_lighting"]["probes"]
        root["extensions"]["IRRADIA_lighting"]["probes"] = entry | ({"lamp": 1} if wrong else {})
        text = json.dumps(root).encode()
        text += b" " * (-len(text) % 4)
        path.write_bytes(
            struct.pack("<4sIIII", b"glTF", 2, 20 + len(text) + len(data) - end, len(text), 0x4E4F534A)
            + text
            + data[end:]
        )
        complaints = web_check("validate", path, repo_root / "docs" / "IRRADIA_lighting" / "schema")
        assert bool(complaints["complaints"]) == wrong


def test_each_reader_finds_its_file_beside_the_scene(tmp_path: Path) -> None:
    names = [path.name for path in write_probe_files(tmp_path, made())]
    assert names == ["probes.npz", "probes.bin", "probes.three.json"]
    loose = write_probe_files(tmp_path / "loose", made(structure=None))
    assert [path.name for path in loose] == ["probes.npz", "probes.bin"]
    assert sorted(path.name for path in (tmp_path / "loose").iterdir()) == ["probes.bin", "probes.npz"]
    stored = read_probes_bin(tmp_path / "probes.bin")
    np.testing.assert_array_equal(stored.positions, made().places[made().state == VALID])
