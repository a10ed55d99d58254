"""What extras.irradia says of lights, and lights of EXT_lights_ies."""

from __future__ import annotations

import base64

import numpy as np
import pytest

from irradia.core.errors import InputError
from irradia.scene.gltf import document_to_scene
from irradia.scene.light_profile import light_candela

IES = b"IESNA:LM-63-2002\nTILT=%s\n1 -1 1 2 1 1 2 0 0 0 1 1 0\n0 90\n0\n100 50\n"


def lit(gltf, light, **node):
    gltf.use("KHR_lights_punctual")
    gltf.triangle()
    gltf.json["extensions"] = {"KHR_lights_punctual": {"lights": [light]}}
    gltf.node(extensions={"KHR_lights_punctual": {"light": 0}}, **node)
    return document_to_scene(gltf.document())


def extras(**settings):
    return {"irradia": settings}


def test_radius_and_mode_come_from_extras(gltf):
    (found,) = lit(gltf, {"type": "point", "extras": extras(radius=0.05, mode="mixed")}).lights
    assert (found.radius_m, found.mode) == (0.05, "mixed")


def test_defaults_are_baked_and_sharp(gltf):
    (found,) = lit(gltf, {"type": "spot"}).lights
    assert (found.radius_m, found.mode, found.profile) == (0.0, "baked", None)


def test_node_goes_before_the_light_that_it_shares(gltf):
    light = {"type": "point", "extras": extras(radius=0.05, mode="mixed")}
    (found,) = lit(gltf, light, extras=extras(mode="off")).lights
    assert (found.radius_m, found.mode) == (0.05, "off")


def test_directional_lights_have_no_radius(gltf):
    (found,) = lit(gltf, {"type": "directional", "extras": extras(radius=3.0, angleDeg=2.0)}).lights
    assert (found.radius_m, found.angle_deg) == (0.0, 2.0)


def test_misspelt_mode_is_an_error_that_names_the_nearest(gltf):
    with pytest.raises(InputError, match="Did you mean 'mixed'") as error:
        lit(gltf, {"type": "point", "extras": extras(mode="mixd")})
    assert error.value.where == "/extensions/KHR_lights_punctual/lights/0/extras/irradia/mode"


@pytest.mark.parametrize("settings", [{"radius": -1}, {"radius": "wide"}, {"mode": 3}])
def test_malformed_settings_name_the_key(gltf, settings):
    (key,) = settings
    with pytest.raises(InputError, match=f"/nodes/1/extras/irradia/{key}"):
        lit(gltf, {"type": "point"}, extras=extras(**settings))


def test_settings_that_nobody_reads_are_noted(gltf):
    scene = lit(gltf, {"type": "point", "extras": extras(radios=1)})
    assert any("radios" in note and "'radius'" in note for note in scene.notes)


def test_node_of_a_mesh_and_a_light_may_speak_of_both(gltf):
    gltf.use("KHR_lights_punctual")
    gltf.json["extensions"] = {"KHR_lights_punctual": {"lights": [{"type": "point"}]}}
    reference = {"KHR_lights_punctual": {"light": 0}}
    gltf.triangle(extensions=reference, extras=extras(mode="mixed", casts=False))
    scene = document_to_scene(gltf.document())
    assert scene.lights[0].mode == "mixed"
    assert not scene.instances[0].casts
    assert scene.notes == ()


def measured(gltf, profile, node=None, **reference):
    gltf.use("EXT_lights_ies", required=True)
    gltf.triangle()
    gltf.json["extensions"] = {"EXT_lights_ies": {"lights": [profile]}}
    gltf.node(extensions={"EXT_lights_ies": {"light": 0, **reference}}, **(node or {}))
    return document_to_scene(gltf.document())


def data_uri(tilt=b"NONE"):
    return "data:application/x-ies-lm-63;base64," + base64.b64encode(IES % tilt).decode()


@pytest.mark.parametrize("embedded", [True, False])
def test_profile_in_a_buffer_view_or_a_uri(gltf, embedded):
    profile = {"uri": data_uri()}
    if embedded:
        profile = {"bufferView": gltf.view(IES % b"NONE"), "mimeType": "application/x-ies-lm-63"}
    (light,) = measured(gltf, profile, multiplier=2.0, color=[1.0, 0.5, 1.0000001]).lights
    assert light.kind == "point"
    assert light.intensity == (2.0, 1.0, 2.0)
    down_z = light_candela(light, np.array([[0.0, 0.0, -1.0], [1.0, 0.0, 0.0]]))
    np.testing.assert_allclose(down_z, [100.0, 50.0], rtol=1e-6)


def test_profile_turns_with_its_node(gltf):
    quarter_about_x = [np.sqrt(0.5), 0, 0, np.sqrt(0.5)]  # −Z turns to +Y
    node = {"rotation": quarter_about_x, "scale": [3, 3, 3], "extras": extras(radius=0.1, mode="realtime")}
    (light,) = measured(gltf, {"uri": data_uri()}, node).lights
    np.testing.assert_allclose(light.direction, (0, 1, 0), atol=1e-7)
    np.testing.assert_allclose(light.up, (1, 0, 0), atol=1e-7)
    assert (light.radius_m, light.mode) == (0.1, "realtime")


def test_ignored_tilt_is_noted_once_for_the_profile(gltf):
    scene = measured(gltf, {"uri": data_uri(b"lamp.tlt")})
    assert [note for note in scene.notes if "TILT=lamp.tlt" in note and "/lights/0" in note]


@pytest.mark.parametrize(
    ("profile", "reference", "where"),
    [
        ({}, {}, "/extensions/EXT_lights_ies/lights/0"),
        ({"uri": "data:,hello"}, {}, "/extensions/EXT_lights_ies/lights/0"),
        ({"uri": "http://x/y.ies"}, {}, "/extensions/EXT_lights_ies/lights/0/uri"),
        ({"uri": data_uri()}, {"light": 3}, "/nodes/1/extensions/EXT_lights_ies/light"),
        ({"uri": data_uri()}, {"multiplier": -1}, "/nodes/1/extensions/EXT_lights_ies/multiplier"),
    ],
)
def test_malformed_profiles_are_input_errors_that_say_where(gltf, profile, reference, where):
    with pytest.raises(InputError) as error:
        measured(gltf, profile, **reference)
    assert error.value.where == where
