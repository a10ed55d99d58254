"""A room with a lamp that can be baked and learnt in seconds, as a file."""

from __future__ import annotations

import base64
import json
from pathlib import Path

from irradia.scene.builtin.builder import SceneBuilder
from irradia.scene.builtin.matte import matte
from irradia.scene.builtin.mesh import look_at
from irradia.scene.builtin.shapes import box, quad
from irradia.scene.types import Camera, Light


def write_studio(path: Path) -> None:
    """Two blocks in a coloured corner; the lamp is a small sphere, so that their shadows have soft edges.

    Args:
        path: The .gltf.
    """
    builder = SceneBuilder("studio")
    white, red, blue = (
        builder.material(matte(name, colour))
        for name, colour in (("white", (0.7, 0.7, 0.7)), ("red", (0.6, 0.1, 0.1)), ("blue", (0.1, 0.2, 0.6)))
    )
    builder.object("floor", (quad((-1, 0, -1), (0, 0, 2), (2, 0, 0)), white))
    builder.object("back", (quad((-1, 0, -1), (2, 0, 0), (0, 2, 0)), white))
    builder.object("left", (quad((-1, 0, 1), (0, 0, -2), (0, 2, 0)), red))
    builder.object("right", (quad((1, 0, -1), (0, 0, 2), (0, 2, 0)), blue))
    builder.object("low block", (box((-0.6, 0.0, -0.5), (-0.1, 0.5, 0.0)), white))
    builder.object("high block", (box((0.2, 0.0, -0.7), (0.6, 1.1, -0.3)), white))
    builder.light(Light("point", (4.0, 3.6, 3.0), position=(0.1, 1.8, 0.6), name="lamp", radius_m=0.1))
    eye = look_at((0.0, 1.0, 3.0), (0.0, 0.9, 0.0))
    builder.camera(Camera(eye, yfov_rad=0.75, aspect=16 / 9, name="camera"))
    builder.environment_color((0.0, 0.0, 0.0))
    document = builder.build()
    (data,) = document.buffers
    uri = f"data:application/octet-stream;base64,{base64.b64encode(data).decode()}"
    whole = {**document.json, "buffers": [{"byteLength": len(data), "uri": uri}]}
    path.write_text(json.dumps(whole), encoding="utf-8")
