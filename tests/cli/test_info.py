"""``irradia info``."""

from __future__ import annotations

import json

from irradia.cli import app


def test_the_inventory_is_the_scenes(capfd):
    assert app.run(["info", "builtin:cornell", "--json"]) == 0
    said = json.loads(capfd.readouterr().out)
    assert said["name"] == "cornell"
    assert said["n_cameras"] == 1
    assert said["emissive"] == ["lamp"]
    assert said["sources"][0]["kind"] == "emissive"
    assert said["sources"][0]["mean_irradiance"] > 0


def test_light_is_as_it_would_be_baked(capfd):
    assert app.run(["info", "builtin:cornell", "--env-color", "2", "--json"]) == 0
    sources = json.loads(capfd.readouterr().out)["sources"]
    assert sources[0]["kind"] == "environment"
    assert abs(sources[0]["mean_irradiance"] - 2 * 3.14159) < 1e-3


def test_people_read_what_was_found_and_added(capfd, shared_assets):
    assert app.run(["info", str(shared_assets / "antique-camera" / "AntiqueCamera.gltf")]) == 0
    shown = capfd.readouterr().out
    assert "AntiqueCamera" in shown
    assert "sun and sky were added" in shown
    assert "environment" in shown


def test_a_scene_that_stays_black_is_warned_about(capfd, shared_assets):
    model = shared_assets / "antique-camera" / "AntiqueCamera.gltf"
    assert app.run(["info", str(model), "--no-default-light"]) == 0
    shown = capfd.readouterr().out
    assert "would be black" in shown
    assert "    none" in shown
