"""Directional maps travel inside the baked .glb and come back."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from irradia.bake.directional import DirectionalMaps
from irradia.bake.directional_modes import MODES
from irradia.core.errors import InputError
from irradia.export.glb import Companions, baked_glb
from irradia.export.read_baked import read_baked
from irradia.scene.gltf import GltfDocument, document_to_scene, read_document

NAME = "IRRADIA_lighting"


@pytest.fixture
def schemas(repo_root: Path) -> Path:
    return repo_root / "docs" / "IRRADIA_lighting" / "schema"


def made_up(mode: str, shape: tuple[int, ...]) -> DirectionalMaps:
    rng = np.random.default_rng(4)
    pages = {name: rng.random(shape).astype(np.float32) for name in MODES[mode].maps}
    for name in MODES[mode].light_maps:
        pages[name] *= 300.0
    return DirectionalMaps(mode, pages)


def export(gallery: GltfDocument, bake, tmp_path: Path, mode: str) -> tuple[Path, DirectionalMaps]:
    plain = bake(gallery)
    maps = made_up(mode, plain.pages.shape)
    path = tmp_path / "directional.glb"
    path.write_bytes(baked_glb(plain.scene, plain.layout, plain.pages, Companions(directional=maps)))
    return path, maps


@pytest.mark.parametrize("mode", MODES)
def test_maps_come_back_with_their_mode_and_scale(gallery, bake, tmp_path, mode):
    path, maps = export(gallery, bake, tmp_path, mode)
    found = read_baked(str(path)).directional
    assert found is not None
    assert found.mode == mode
    assert tuple(found.pages) == MODES[mode].maps
    for name, pages in maps.pages.items():
        brightest = pages.max(axis=-1, keepdims=True)
        assert (np.abs(found.pages[name] - pages) <= brightest / 511).all()


def test_a_plain_bake_has_none(gallery, bake):
    assert read_baked(str(bake(gallery).path)).directional is None


@pytest.mark.parametrize("mode", MODES)
def test_the_file_is_valid(web_check, schemas, gallery, bake, tmp_path, mode):
    path, _ = export(gallery, bake, tmp_path, mode)
    assert web_check("validate", path, schemas) == {"issues": [], "complaints": []}


def test_baking_again_leaves_the_maps_behind(gallery, bake, tmp_path):
    path, _ = export(gallery, bake, tmp_path, "sh")
    again = bake(read_document(path))
    assert "directional" not in again.json["extensions"][NAME]
    assert read_baked(str(again.path)).directional is None


@pytest.mark.parametrize(
    ("spoil", "complaint"),
    [
        (lambda d: d.update(mode="cubist"), "expected one of dominant"),
        (lambda d: d["maps"].pop("sh_y"), "bufferView"),
        (lambda d: d["maps"]["sh_x"].update(bufferView=0), "sh_x"),
    ],
    ids=["unknown mode", "missing map", "no texture"],
)
def test_damage_is_an_input_error(gallery, bake, tmp_path, spoil, complaint):
    from irradia.export.directional_extension import read_directional
    from irradia.scene.gltf.accessors import Accessors

    path, _ = export(gallery, bake, tmp_path, "sh")
    document = read_document(path)
    spoil(document.json["extensions"][NAME]["directional"])
    assert document_to_scene(document).primitives
    with pytest.raises(InputError, match=complaint):
        read_directional(document, Accessors(document))
