"""A small scene as a file that tests can edit: a floor, a wall, a box, two lamps."""

from __future__ import annotations

import base64
import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

from irradia.cli import app
from irradia.scene.builtin.builder import SceneBuilder
from irradia.scene.builtin.matte import matte
from irradia.scene.builtin.shapes import centred_box, floor, quad
from irradia.scene.types import Light

Json = dict[str, Any]


def write_workshop(path: Path, edit: Callable[[Json], None] | None = None) -> Path:
    """Writes the scene as one .gltf, changed as wished; returns its path."""
    scene = SceneBuilder("workshop")
    grey = scene.material(matte("grey", (0.6, 0.6, 0.6)))
    red = scene.material(matte("red", (0.7, 0.1, 0.1)))
    scene.object("floor", (floor(6.0, 3.0), grey))
    scene.object("wall", (quad((-3.0, 0.0, -1.5), (6.0, 0.0, 0.0), (0.0, 2.0, 0.0)), grey))
    box = scene.mesh("box", (centred_box((0.5, 0.5, 0.5), (0.0, 0.25, 0.0)), red))
    scene.node("box", mesh=box, translation=(-2.0, 0.0, 0.0))
    scene.light(Light("point", (4.0, 4.0, 4.0), position=(-1.5, 1.8, 0.5), name="left lamp"))
    scene.light(Light("point", (2.0, 2.0, 3.0), position=(2.0, 1.8, 0.5), name="right lamp"))
    scene.environment_color((0.0, 0.0, 0.0))
    document = scene.build()
    changed = json.loads(json.dumps(document.json))
    data = base64.b64encode(document.buffers[0]).decode("ascii")
    changed["buffers"][0]["uri"] = f"data:application/octet-stream;base64,{data}"
    if edit is not None:
        edit(changed)
    path.write_text(json.dumps(changed))
    return path


def node(json: Json, name: str) -> Json:
    """The node of that name."""
    return next(each for each in json["nodes"] if each["name"] == name)


def lamp(json: Json, name: str) -> Json:
    """The punctual light of that name."""
    return next(each for each in json["extensions"]["KHR_lights_punctual"]["lights"] if each["name"] == name)


def bake(scene: Path, out: Path, *options: str) -> Json:
    """Bakes it small, without a report; returns what ``bake.json`` says."""
    arguments = ["--no-report", "--resolution", "32", *options]
    assert app.run(["bake", str(scene), "-o", str(out), *arguments]) == 0
    return json.loads((out / "bake.json").read_text())
