"""Shadow masks inside a document."""

from __future__ import annotations

import io

import numpy as np
from PIL import Image

from irradia.export.lighting_extension import NAME
from irradia.export.shadow_mask_extension import add_shadow_mask, bind_mask_channels
from irradia.export.slots import Slots
from irradia.scene.gltf.accessors import Accessors
from irradia.scene.gltf.document import GltfDocument


def _slots(json) -> Slots:
    return Slots(json, Accessors(GltfDocument({"asset": {"version": "2.0"}}, (), ())))


def test_every_page_is_an_image_in_a_buffer_view_of_its_own():
    json = {"asset": {"version": "2.0"}, "extensions": {NAME: {"version": 1, "lightmap": {}}}}
    slots = _slots(json)
    pages = np.stack([np.full((5, 7, 4), value, np.float32) for value in (0.0, 1.0)])
    add_shadow_mask(json, slots, pages)
    binary = slots.finish()
    images = json["extensions"][NAME]["shadowMask"]["pages"]
    for image, value in zip(images, (0, 255), strict=True):
        view = json["bufferViews"][image["bufferView"]]
        start = view.get("byteOffset", 0)
        with Image.open(io.BytesIO(binary[start : start + view["byteLength"]])) as picture:
            assert picture.size == (7, 5)
            assert picture.getextrema() == ((value, value),) * 4


def test_channels_stand_on_their_lights_nodes_and_earlier_ones_are_forgotten():
    lamp = {"KHR_lights_punctual": {"light": 0}}
    json = {
        "nodes": [
            {"extensions": {**lamp}},
            {"extensions": {**lamp, NAME: {"shadowMaskChannel": 3}}},
            {"extensions": {NAME: {"shadowMaskChannel": 1}}},
            {"extensions": {NAME: {"primitives": [{}], "shadowMaskChannel": 1}}},
            {"name": "plain"},
        ]
    }
    bind_mask_channels(json, {0: 2})
    assert json["nodes"] == [
        {"extensions": {**lamp, NAME: {"shadowMaskChannel": 2}}},
        {"extensions": lamp},
        {},
        {"extensions": {NAME: {"primitives": [{}]}}},
        {"name": "plain"},
    ]
