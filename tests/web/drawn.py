"""Built-in scenes in lights that were made up, drawn by three.js in a browser, once for each session."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from irradia.bake.directional_modes import DirectionalName
from irradia.scene.load import load_scene

from .made_light import FIELDS, WIDE_FIELDS, bounds, made_field, read_field, write_made_scene
from .pixels import BACKENDS, CHANNELS, Answer, BakedReference, Image, Pixels, ask, field_irradiance, view_of

SUBPIXEL = 1 / 16  # to which rasterisers may round vertices
SIZES = {"cornell": (64, 64), "atrium": (160, 90)}
LIGHTS: dict[str, tuple[DirectionalName, bool]] = {
    # by name: mode of the directional maps, and whether probes stand in an octree
    "sh": ("sh", False),
    "mono-sh": ("mono-sh", True),
    "dominant": ("dominant", False),
    "rnm": ("rnm", False),
}
FIRST = "sh"
SOURCES = [
    *(
        (FIRST, source)
        for source in ("lightmap", "directional", "probes", "three-probes", *FIELDS, *WIDE_FIELDS)
    ),
    ("mono-sh", "directional"),
    ("mono-sh", "probes"),
    ("dominant", "directional"),
    ("rnm", "directional"),
]
PASSES = [(source, how) for source in ("probes", "hash-int8", "sh", "indirect") for how in ("full", "half")]
# The atrium takes long to draw without a GPU: there WebGPURenderer's second backend is left out.
PAIRS = [
    *(pytest.param("cornell", backend) for backend in BACKENDS),
    *(pytest.param("atrium", backend, marks=pytest.mark.slow) for backend in ("webgl", "webgpu")),
]


@dataclass(frozen=True)
class MadeScene:
    """Files of a scene in made-up lights.

    Attributes:
        name: Of the built-in scene.
        lights: A .glb for each of LIGHTS.
        fields: A file for each of FIELDS and WIDE_FIELDS.
    """

    name: str
    lights: dict[str, Path]
    fields: dict[str, Path]


@dataclass(frozen=True)
class Drawn:
    """A scene as one backend drew it.

    Attributes:
        scene: What was drawn.
        answers: For each of LIGHTS; channels are in that of FIRST.
    """

    scene: MadeScene
    answers: dict[str, Answer]

    @cached_property
    def pixels(self) -> Pixels:
        """What they show, whatever the light."""
        return Pixels(self.answers[FIRST])

    @cached_property
    def offsets(self) -> NDArray[np.float64]:
        """(N,) how far from their pixels' middle the positions lie that these show, in pixels."""
        camera = load_scene(f"builtin:{self.scene.name}").cameras[0]
        assert camera.yfov_rad is not None
        camera_from_world = np.linalg.inv(camera.world_from_camera)
        x, y, z = (self.pixels.position @ camera_from_world[:3, :3].T + camera_from_world[:3, 3]).T
        height, width = self.pixels.hit.shape
        scale = 0.5 * height / np.tan(0.5 * camera.yfov_rad)
        rows, columns = np.nonzero(self.pixels.hit)
        across = np.abs(0.5 * width + scale * x / -z - columns - 0.5)
        along = np.abs(0.5 * height - scale * y / -z - rows - 0.5)
        return np.maximum(across, along)

    def expected(self, light: str, source: str) -> Image:
        """The picture by one source of a light, worked out."""
        baked, pixels = BakedReference(self.scene.lights[light]), self.pixels
        if source not in self.scene.fields:
            return pixels.picture(getattr(baked, source.replace("-", "_"))(pixels))
        field = read_field(self.scene.fields[source])
        irradiance = field_irradiance(field, pixels)
        if field.frame.quantity == "indirect":
            irradiance += baked.direct(pixels)
        return pixels.picture(irradiance)

    def found(self, light: str, picture: str) -> Image:
        """A picture that the browser drew, by its source, or by source and kind of pass."""
        return self.pixels.rows(self.answers[light].pictures[picture])


def make_scene(name: str, folder: Path) -> MadeScene:
    """Writes all files of a built-in scene."""
    lights = {light: folder / f"{light}.glb" for light in LIGHTS}
    for light, (mode, octree) in LIGHTS.items():
        write_made_scene(lights[light], name, mode, octree=octree)
    box = bounds(load_scene(f"builtin:{name}"))
    fields = {field: folder / f"{field}.safetensors" for field in (*FIELDS, *WIDE_FIELDS)}
    for field, case in (FIELDS | WIDE_FIELDS).items():
        fields[field].write_bytes(made_field(case, box))
    return MadeScene(name, lights, fields)


def draw_scene(
    scene: MadeScene, backend: str, web_check: Callable[..., Any], chromium: str, folder: Path
) -> Drawn:
    """Draws it in every light and by every source."""
    view = view_of(load_scene(f"builtin:{scene.name}").cameras[0], *SIZES[scene.name])
    requests = [{"backend": backend, "view": view, **_wishes(scene, light)} for light in LIGHTS]
    served = {f"/{path.name}": path for path in (*scene.lights.values(), *scene.fields.values())}
    answers = ask(web_check, chromium, folder, requests, served)
    return Drawn(scene, dict(zip(LIGHTS, answers, strict=True)))


def _wishes(scene: MadeScene, light: str) -> dict[str, Any]:
    """What is asked for in one light."""
    sources = [source for of, source in SOURCES if of == light]
    pictures = {source: {"source": source, "how": "inline"} for source in sources}
    if light == FIRST:
        pictures |= {f"{source} {how}": {"source": source, "how": how} for source, how in PASSES}
    return {
        "scene": f"/{light}.glb",
        "channels": CHANNELS if light == FIRST else [],
        "fields": {name: f"/{name}.safetensors" for name in sources if name in scene.fields},
        "pictures": pictures,
    }
