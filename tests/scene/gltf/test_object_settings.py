"""Objects say in extras.irradia what part they have in the bake."""

from __future__ import annotations

import pytest

from irradia.core.errors import InputError
from irradia.core.progress import silent_progress
from irradia.scene.gltf import document_to_scene
from irradia.scene.lightmap_uv import LayoutOptions, layout_lightmap


def scene_with(gltf, **settings):
    gltf.triangle(name="other")
    gltf.triangle(name="this", extras={"irradia": settings})
    return document_to_scene(gltf.document())


@pytest.mark.parametrize(
    ("settings", "scale", "casts"),
    [
        ({}, 1.0, True),
        ({"receives": False}, 0.0, True),
        ({"casts": False}, 1.0, False),
        ({"receives": False, "casts": False}, 0.0, False),
        ({"lightmapScale": 3, "receives": True}, 3.0, True),
        ({"lightmapScale": 3, "receives": False}, 0.0, True),
    ],
)
def test_settings_reach_the_instance(gltf, settings, scale, casts):
    instance = scene_with(gltf, **settings).instances[1]
    assert (instance.lightmap_scale, instance.casts, instance.name) == (scale, casts, "this")


def test_only_receivers_have_a_place_on_a_page(gltf):
    scene = scene_with(gltf, receives=False)
    layout = layout_lightmap(scene, LayoutOptions(resolution=64), silent_progress())
    assert layout.page.tolist() == [0, -1]


@pytest.mark.parametrize("key", ["receives", "casts"])
def test_settings_of_the_wrong_type_are_input_errors(gltf, key):
    with pytest.raises(InputError, match=f"/nodes/1/extras/irradia/{key}: expected true or false"):
        scene_with(gltf, **{key: 1})


def test_misspelt_settings_are_noted_with_the_nearest_name(gltf):
    notes = scene_with(gltf, recieves=False).notes
    assert notes == (
        "/nodes/1/extras/irradia/recieves is not a setting of Irradia's. Did you mean 'receives'?",
    )
