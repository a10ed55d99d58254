"""Lights and cameras stand in the world where their nodes put them."""

from __future__ import annotations

import math

import numpy as np
import pytest

from irradia.core.errors import InputError
from irradia.scene.gltf import document_to_scene

QUARTER_ABOUT_X = [np.sqrt(0.5), 0, 0, np.sqrt(0.5)]  # −Z turns to +Y


def light(gltf, json, **node):
    gltf.use("KHR_lights_punctual")
    gltf.triangle()
    gltf.json["extensions"] = {"KHR_lights_punctual": {"lights": [json]}}
    gltf.node(extensions={"KHR_lights_punctual": {"light": 0}}, **node)
    return document_to_scene(gltf.document()).lights[0]


def test_intensity_is_colour_times_candela(gltf):
    found = light(gltf, {"type": "point", "intensity": 50, "color": [1, 0.5, 0.1], "range": 7})
    assert found.kind == "point"
    assert found.intensity == pytest.approx((50, 25, 5))
    assert found.range_m == 7


def test_defaults(gltf):
    found = light(gltf, {"type": "spot"})
    assert found.intensity == (1, 1, 1)
    assert found.range_m is None
    assert (found.inner_cone_rad, found.outer_cone_rad) == (0.0, math.pi / 4)
    assert found.angle_deg == 0.0


def test_light_shines_along_its_nodes_minus_z_whatever_the_scale(gltf):
    node = {"translation": [1, 2, 3], "rotation": QUARTER_ABOUT_X, "scale": [5, 5, 5]}
    found = light(gltf, {"type": "spot", "spot": {"innerConeAngle": 0.1, "outerConeAngle": 0.2}}, **node)
    np.testing.assert_allclose(found.position, [1, 2, 3])
    np.testing.assert_allclose(found.direction, [0, 1, 0], atol=1e-7)
    assert (found.inner_cone_rad, found.outer_cone_rad) == (0.1, 0.2)


def test_sun_has_the_angle_that_extras_give(gltf):
    found = light(gltf, {"type": "directional", "extras": {"irradia": {"angleDeg": 0.53}}})
    assert found.angle_deg == 0.53


@pytest.mark.parametrize("extras", [None, 3, "irradia", {"irradia": 4}, {"other": {}}])
def test_other_extras_are_someone_elses(gltf, extras):
    assert light(gltf, {"type": "directional", "extras": extras}).angle_deg == 0.0


@pytest.mark.parametrize(
    ("json", "key"),
    [
        ({"type": "area"}, "type"),
        ({}, "type"),
        ({"type": "point", "intensity": -1}, "intensity"),
        ({"type": "point", "color": [1, 1]}, "color"),
        ({"type": "directional", "extras": {"irradia": {"angleDeg": "wide"}}}, "extras/irradia/angleDeg"),
    ],
)
def test_malformed_lights_name_the_key(gltf, json, key):
    with pytest.raises(InputError, match=f"/extensions/KHR_lights_punctual/lights/0/{key}"):
        light(gltf, json)


def test_light_that_does_not_exist_is_an_input_error(gltf):
    gltf.triangle(extensions={"KHR_lights_punctual": {"light": 2}})
    with pytest.raises(InputError, match=r"/nodes/0/extensions/KHR_lights_punctual/light"):
        document_to_scene(gltf.document())


def test_light_that_an_earlier_bake_put_away_shines_again_in_the_next(gltf):
    gltf.use("KHR_lights_punctual", "IRRADIA_lighting")
    gltf.triangle()
    gltf.json["extensions"] = {"KHR_lights_punctual": {"lights": [{"type": "point", "intensity": 9}]}}
    gltf.node(extensions={"IRRADIA_lighting": {"bakedLight": 0}})
    scene = document_to_scene(gltf.document())
    assert [light.intensity for light in scene.lights] == [(9, 9, 9)]
    assert scene.notes == ()


def camera(gltf, json, **node):
    gltf.triangle()
    gltf.add("cameras", json)
    gltf.node(camera=0, **node)
    return document_to_scene(gltf.document())


def test_perspective_camera(gltf):
    lens = {"yfov": 0.9, "aspectRatio": 1.5, "znear": 0.1}
    node = {"translation": [1, 2, 3], "rotation": QUARTER_ABOUT_X, "scale": [3, 3, 3]}
    (found,) = camera(gltf, {"name": "c", "type": "perspective", "perspective": lens}, **node).cameras
    assert (found.name, found.yfov_rad, found.aspect) == ("c", 0.9, 1.5)
    linear = found.world_from_camera[:3, :3]
    np.testing.assert_allclose(linear @ linear.T, np.eye(3), atol=1e-12)
    np.testing.assert_allclose(linear @ [0, 0, -1], [0, 1, 0], atol=1e-12)
    np.testing.assert_allclose(found.world_from_camera[:3, 3], [1, 2, 3])


def test_camera_without_aspect_gets_16_to_9(gltf):
    scene = camera(gltf, {"type": "perspective", "perspective": {"yfov": 0.9, "znear": 0.1}})
    assert scene.cameras[0].aspect == pytest.approx(16 / 9)


def test_orthographic_camera_is_noted(gltf):
    scene = camera(gltf, {"name": "plan", "type": "orthographic"})
    assert scene.cameras == ()
    assert any("orthographic camera 'plan'" in note for note in scene.notes)
