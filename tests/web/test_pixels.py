"""Pixels in Chromium, with three.js' WebGPURenderer on both backends and its WebGLRenderer, are those of NumPy."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from irradia.scene.load import load_scene

from .made_light import FIELDS, bounds, made_field, read_field, write_made_scene
from .pixels import (
    BACKENDS,
    CHANNELS,
    Answer,
    BakedReference,
    Image,
    Pixels,
    ask,
    field_irradiance,
    steps_apart,
    view_of,
)

MAX_STEPS = 2.0  # of 255
SUBPIXEL = 1 / 16  # to which rasterisers may round vertices
SIZES = {"cornell": (64, 64), "atrium": (160, 90)}
SCENES = {  # by name: mode of the directional maps, and whether probes stand in an octree
    "sh": ("sh", False),
    "mono-sh": ("mono-sh", True),
    "dominant": ("dominant", False),
    "rnm": ("rnm", False),
}
SOURCES = {
    **{("sh", source): "inline" for source in ("lightmap", "directional", "probes", *FIELDS)},
    ("mono-sh", "directional"): "inline",
    ("mono-sh", "probes"): "inline",
    ("dominant", "directional"): "inline",
    ("rnm", "directional"): "inline",
}


@dataclass(frozen=True)
class Drawn:
    """A built-in scene in lights that were made up, as a browser drew it.

    Attributes:
        answers: By the name of the light.
        files: The scenes with it.
        fields: Files, by name.
    """

    name: str
    backend: str
    answers: dict[str, Answer]
    files: dict[str, Path]
    fields: dict[str, Path]

    def expected(self, light: str, source: str) -> Image:
        """The picture by one source of a light, worked out."""
        pixels = Pixels(self.answers[light])
        if source in self.fields:
            return pixels.picture(field_irradiance(read_field(self.fields[source]), pixels))
        return pixels.picture(getattr(BakedReference(self.files[light]), source)(pixels))


@pytest.fixture(scope="session")
def draw(web_check, chromium, tmp_path_factory) -> Callable[[str, str], Drawn]:
    """Draws a built-in scene by a backend in every light and by every source."""

    def drawn(name: str, backend: str) -> Drawn:
        folder = tmp_path_factory.mktemp(f"{name}-{backend}")
        scene = load_scene(f"builtin:{name}")
        files, fields = {}, {}
        for light, (mode, octree) in SCENES.items():
            files[light] = folder / f"{light}.glb"
            write_made_scene(files[light], name, mode, octree=octree)
        for field, case in FIELDS.items():
            fields[field] = folder / f"{field}.safetensors"
            fields[field].write_bytes(made_field(case, bounds(scene)))
        view = view_of(scene.cameras[0], *SIZES[name])
        requests = [request(light, backend, view) for light in SCENES]
        served = {f"/{path.name}": path for path in (*files.values(), *fields.values())}
        answers = ask(web_check, chromium, folder, requests, served)
        return Drawn(name, backend, dict(zip(SCENES, answers, strict=True)), files, fields)

    return drawn


def request(light: str, backend: str, view: dict[str, Any]) -> dict[str, Any]:
    wanted = [source for of, source in SOURCES if of == light]
    fields = [source for source in wanted if source in FIELDS]
    return {
        "backend": backend,
        "scene": f"/{light}.glb",
        "view": view,
        "channels": CHANNELS,
        "fields": {name: f"/{name}.safetensors" for name in fields},
        "pictures": {source: {"source": source, "how": "inline"} for source in wanted},
    }


@pytest.fixture(scope="session", params=BACKENDS)
def cornell(draw, request) -> Drawn:
    return draw("cornell", request.param)


def test_the_renderer_draws_by_the_backend_asked_for(cornell: Drawn) -> None:
    assert {answer.backend for answer in cornell.answers.values()} == {cornell.backend}


def test_positions_lie_behind_their_pixels(cornell: Drawn) -> None:
    camera = load_scene("builtin:cornell").cameras[0]
    pixels = Pixels(cornell.answers["sh"])
    camera_from_world = np.linalg.inv(camera.world_from_camera)
    x, y, z = (pixels.position @ camera_from_world[:3, :3].T + camera_from_world[:3, 3]).T
    height, width = pixels.hit.shape
    scale = 0.5 * height / np.tan(0.5 * camera.yfov_rad)
    rows, columns = np.nonzero(pixels.hit)
    np.testing.assert_allclose(0.5 * width + scale * x / -z, columns + 0.5, atol=SUBPIXEL)
    np.testing.assert_allclose(0.5 * height - scale * y / -z, rows + 0.5, atol=SUBPIXEL)


@pytest.mark.parametrize(("light", "source"), SOURCES)
def test_pixels_are_those_of_the_reference(cornell: Drawn, light: str, source: str) -> None:
    expected = cornell.expected(light, source)
    drawn = Pixels(cornell.answers[light]).drawn(source)
    steps = steps_apart(drawn, expected)
    print(cornell.backend, light, source, steps.max(), steps.mean(), np.sort(steps.max(1))[-5:])
    assert steps.max() <= MAX_STEPS
