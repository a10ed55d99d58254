"""Texel validity travels inside the baked .glb, and the lightmap says which light it holds."""

from __future__ import annotations

import io
from dataclasses import replace

import numpy as np
import pytest
from PIL import Image

from irradia.export.glb import Companions, baked_glb
from irradia.export.validity_extension import code_validity
from irradia.scene.gltf import read_document
from irradia.scene.gltf.accessors import Accessors

NAME = "IRRADIA_lighting"


@pytest.fixture
def export(gallery, bake, tmp_path):
    """Bakes the gallery again with validities, its lamp in a mode; gives the file and its pages."""

    def run(mode="baked"):
        plain = bake(gallery)
        lamps = tuple(replace(lamp, mode=mode) for lamp in plain.scene.lights)
        validity = np.random.default_rng(2).random(plain.pages.shape[:3])
        pages = np.where(validity < 0.3, 0, code_validity(validity)).astype(np.uint8)
        path = tmp_path / f"{mode}.glb"
        scene = replace(plain.scene, lights=lamps)
        path.write_bytes(baked_glb(scene, plain.layout, plain.pages, Companions(validity=pages)))
        return path, pages

    return run


def test_codes_rise_from_hidden_to_whole_and_none_is_0():
    codes = code_validity(np.linspace(0.0, 1.0, 255))
    np.testing.assert_array_equal(codes, np.arange(1, 256))


def test_every_page_is_an_image_of_its_own(export):
    path, pages = export()
    document = read_document(path)
    images = document.json["extensions"][NAME]["validity"]["pages"]
    for image, page in zip(images, pages, strict=True):
        with Image.open(io.BytesIO(bytes(Accessors(document).read_view(image["bufferView"])))) as picture:
            assert picture.mode == "L"
            np.testing.assert_array_equal(np.asarray(picture), page)


def test_a_bake_without_validity_writes_none(gallery, bake):
    assert "validity" not in bake(gallery).json["extensions"][NAME]


@pytest.mark.parametrize(
    ("mode", "light"), [("baked", "full"), ("off", "full"), ("mixed", "indirect"), ("realtime", "indirect")]
)
def test_a_map_that_leaves_live_lights_out_says_so(export, mode, light):
    document = read_document(export(mode)[0])
    assert document.json["extensions"][NAME]["lightmap"]["light"] == light


def test_the_file_is_valid(web_check, repo_root, export):
    schemas = repo_root / "docs" / "IRRADIA_lighting" / "schema"
    assert web_check("validate", export("realtime")[0], schemas) == {"issues": [], "complaints": []}
