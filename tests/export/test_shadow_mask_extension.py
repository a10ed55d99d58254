"""Shadow masks travel inside the baked .glb, and live lights stay on their nodes."""

from __future__ import annotations

import copy
import io
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from irradia.export.glb import Companions, baked_glb
from irradia.export.shadow_mask_extension import BakedShadows
from irradia.formats.shadow_mask import quantise_shadow_mask
from irradia.scene.gltf import GltfDocument, document_to_scene, read_document
from irradia.scene.gltf.accessors import Accessors

NAME = "IRRADIA_lighting"
LAMP = {"KHR_lights_punctual": {"light": 0}}
LAMP_NODE = 8


@pytest.fixture
def export(gallery: GltfDocument, bake, tmp_path: Path):
    """Bakes the gallery again with its lamp in a mode, the mask in channel 2 where it has one."""

    def run(mode: str, *, document: GltfDocument = gallery) -> tuple[Path, np.ndarray]:
        plain = bake(document)
        scene = replace(plain.scene, lights=tuple(replace(x, mode=mode) for x in plain.scene.lights))
        pages = np.random.default_rng(1).random((*plain.pages.shape[:3], 4), np.float32)
        shadows = BakedShadows(pages, (2,)) if mode == "mixed" else None
        path = tmp_path / f"{mode}.glb"
        path.write_bytes(baked_glb(scene, plain.layout, plain.pages, Companions(shadows=shadows)))
        return path, pages

    return run


def test_the_lamps_node_is_known_from_the_document(gallery):
    assert [light.node_index for light in document_to_scene(gallery).lights] == [LAMP_NODE]


def test_every_page_is_an_image_of_its_own(export):
    path, pages = export("mixed")
    document = read_document(path)
    images = document.json["extensions"][NAME]["shadowMask"]["pages"]
    for image, page in zip(images, pages, strict=True):
        data = bytes(Accessors(document).read_view(image["bufferView"]))
        with Image.open(io.BytesIO(data)) as picture:
            np.testing.assert_array_equal(np.asarray(picture), quantise_shadow_mask(page))


@pytest.mark.parametrize(
    ("mode", "extensions"),
    [
        ("mixed", {**LAMP, NAME: {"shadowMaskChannel": 2}}),
        ("realtime", LAMP),
        ("off", LAMP),
        ("baked", {NAME: {"bakedLight": 0}}),
    ],
)
def test_a_lamp_stays_on_its_node_unless_it_is_baked(export, mode, extensions):
    document = read_document(export(mode)[0])
    assert document.json["nodes"][LAMP_NODE]["extensions"] == extensions
    assert ("shadowMask" in document.json["extensions"][NAME]) == (mode == "mixed")


@pytest.mark.parametrize("first", ["mixed", "baked", "realtime"])
@pytest.mark.parametrize("second", ["mixed", "baked", "realtime"])
def test_a_later_bake_tells_what_it_would_tell_without_the_earlier_one(export, first, second):
    again = read_document(export(second, document=read_document(export(first)[0]))[0])
    fresh = read_document(export(second)[0])
    assert again.json["nodes"][LAMP_NODE] == fresh.json["nodes"][LAMP_NODE]
    assert again.json["extensions"][NAME].keys() == fresh.json["extensions"][NAME].keys()


@pytest.mark.parametrize("mode", ["mixed", "realtime"])
def test_the_file_is_valid(web_check, repo_root, export, mode):
    schemas = repo_root / "docs" / "IRRADIA_lighting" / "schema"
    assert web_check("validate", export(mode)[0], schemas) == {"issues": [], "complaints": []}


def test_the_imported_document_is_left_as_it_was(gallery, export):
    before = copy.deepcopy(gallery.json)
    export("mixed")
    assert gallery.json == before
