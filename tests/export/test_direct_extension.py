"""The direct map travels inside the baked .glb and comes back."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from irradia.core.errors import InputError
from irradia.export.direct_extension import read_direct
from irradia.export.glb import Companions, baked_glb
from irradia.export.read_baked import read_baked
from irradia.scene.gltf import GltfDocument, read_document

NAME = "IRRADIA_lighting"


@pytest.fixture
def export(gallery: GltfDocument, bake, tmp_path: Path):
    """Exports the gallery with a made-up direct map: its file, and the map."""
    plain = bake(gallery)
    pages = np.random.default_rng(8).random(plain.pages.shape).astype(np.float32) * 40.0
    path = tmp_path / "direct.glb"
    path.write_bytes(baked_glb(plain.scene, plain.layout, plain.pages, Companions(direct=pages)))
    return path, pages


def test_it_comes_back_with_its_scale(export):
    path, pages = export
    found = read_baked(str(path)).direct
    assert found is not None
    assert (np.abs(found - pages) <= pages.max(axis=-1, keepdims=True) / 511).all()
    entry = read_document(path).json["extensions"][NAME]["direct"]
    assert entry["encoding"] == "rgb9e5"
    assert entry["scale"] == 32.0


def test_a_map_without_any_light_is_black(gallery, bake, tmp_path):
    plain = bake(gallery)
    dark = Companions(direct=np.zeros_like(plain.pages))
    (tmp_path / "dark.glb").write_bytes(baked_glb(plain.scene, plain.layout, plain.pages, dark))
    found = read_baked(str(tmp_path / "dark.glb")).direct
    assert found is not None
    assert (found == 0.0).all()


def test_a_plain_bake_has_none(gallery, bake):
    assert read_baked(str(bake(gallery).path)).direct is None


def test_the_file_is_valid(web_check, repo_root, export):
    schemas = repo_root / "docs" / "IRRADIA_lighting" / "schema"
    assert web_check("validate", export[0], schemas) == {"issues": [], "complaints": []}


def test_baking_again_leaves_it_behind(export, bake):
    again = bake(read_document(export[0]))
    assert "direct" not in again.json["extensions"][NAME]


@pytest.mark.parametrize(
    ("spoil", "complaint"),
    [
        (lambda e: e["direct"].pop("bufferView"), "bufferView"),
        (lambda e: e["direct"].update(bufferView=0), "direct"),
        (lambda e: e["lightmap"].update(width=7), "as large as the lightmap"),
    ],
    ids=["no view", "no texture", "another size"],
)
def test_damage_is_an_input_error(export, spoil, complaint):
    document = read_document(export[0])
    spoil(document.json["extensions"][NAME])
    with pytest.raises(InputError, match=complaint):
        read_direct(document)
