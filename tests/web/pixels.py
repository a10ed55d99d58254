"""Pixels that a browser drew in baked light, and the same worked out in NumPy from what the pixels show.

The page draws the scene without baked light as well: once dark, once under even light of E = 1, and once for
each of position, normals and lightmap uv. Surfaces are linear in E, so

    picture = dark + (white − dark) · E(position, normal, uv)

where E comes from the references: :mod:`irradia.field`, :mod:`irradia.bake.probes.interpolation`,
:mod:`irradia.bake.directional_modes`, and the texels of the file between which this interpolates.
"""

from __future__ import annotations

import base64
import json
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from irradia.bake.directional_modes import MODES, SurfaceFrame
from irradia.bake.probes.interpolation import interpolate
from irradia.core.colour import srgb_from_linear
from irradia.core.sh import irradiance
from irradia.export.direct_extension import read_direct
from irradia.export.probes_extension import read_baked_probes
from irradia.export.read_baked import BakedScene, read_baked
from irradia.field.field import Field
from irradia.formats.probes import ProbeGrid, ProbeSet
from irradia.scene.types import Camera

Backend = str
BACKENDS = ("webgl", "webgpu", "webgl2")  # WebGLRenderer, and WebGPURenderer on either of its backends
CHANNELS = ("unlit", "white", "position", "normal", "surfaceNormal", "tangent", "lightmapUv")
Image = NDArray[np.float64]


@dataclass(frozen=True)
class Answer:
    """What one page drew.

    Attributes:
        backend: What really drew.
        pictures: (H, W, 4) by name, linear, row 0 on top.
        objects: Node and primitive of the file, by the number that lightmapUv has in its blue, less one.
    """

    backend: Backend
    pictures: Mapping[str, Image]
    objects: NDArray[np.int64]


def ask(
    web_check: Callable[..., Any],
    chromium: str,
    folder: Path,
    requests: list[dict[str, Any]],
    files: Mapping[str, Path],
) -> list[Answer]:
    """Draws in one browser; see web/checks/pixels.ts."""
    path = folder / "requests.json"
    path.write_text(json.dumps(requests), encoding="utf-8")
    answers = web_check("pixels", path, chromium, *(f"{name}={file}" for name, file in files.items()))
    return [_decoded(answer, request["view"]) for answer, request in zip(answers, requests, strict=True)]


def view_of(camera: Camera, width: int, height: int) -> dict[str, Any]:
    """A camera as the page takes it."""
    return {
        "width": width,
        "height": height,
        "worldFromCamera": camera.world_from_camera.T.ravel().tolist(),
        "yfovRad": camera.yfov_rad,
    }


def _decoded(answer: dict[str, Any], view: dict[str, Any]) -> Answer:
    shape = (view["height"], view["width"], 4)
    pictures = {
        name: np.frombuffer(base64.b64decode(data), "<f4").reshape(shape).astype(np.float64)
        for name, data in answer["pictures"].items()
    }
    objects = np.array([(o["node"], o["primitive"]) for o in answer["objects"]], np.int64)
    return Answer(answer["backend"], pictures, objects)


class Pixels:
    """What the pixels of a view show; every array has those pixels in rows (N, …).

    Attributes:
        hit: (H, W) where there is something.
        dark, white: Pictures without light, and in that of E = 1.
        position, normal, surface_normal: World space, metres.
    """

    def __init__(self, answer: Answer) -> None:
        self._answer = answer
        self.hit: NDArray[np.bool_] = answer.pictures["position"][..., 3] == 1.0
        self.dark, self.white = self._rows("unlit"), self._rows("white")
        self.position = self._rows("position")
        self.normal, self.surface_normal = unit(self._rows("normal")), unit(self._rows("surfaceNormal"))

    def picture(self, irradiance: Image) -> Image:
        """(N, 3) colours where E (N, 3) arrives."""
        return self.dark + (self.white - self.dark) * irradiance

    def rows(self, picture: Image) -> Image:
        """(N, 3) colours of a picture of the same view."""
        return picture[self.hit][:, :3]

    @cached_property
    def frame(self) -> SurfaceFrame:
        """Tangents as the renderer derives them where there is a normal map; elsewhere any will do."""
        rows = self._answer.pictures["tangent"][self.hit]
        normal = self.surface_normal
        aside = np.where(np.abs(normal[:, 1:2]) < 0.9, (0.0, 1.0, 0.0), (1.0, 0.0, 0.0))
        is_bent = rows[:, 3:] != 0.0
        across = np.cross(aside, normal)
        tangent = unit(np.where(is_bent, rows[:, :3], across))
        sign = np.where(is_bent, rows[:, 3:], 1.0)
        return SurfaceFrame(normal, tangent, np.cross(normal, tangent) * sign)

    @cached_property
    def lightmap_rows(self) -> tuple[Image, NDArray[np.int64]]:
        """(N, 2) uv of the vertices, and (N, 3) node, primitive and number of the instance."""
        rows = self._answer.pictures["lightmapUv"][self.hit]
        numbers = np.round(rows[:, 2:]).astype(np.int64)
        return rows[:, :2], np.column_stack([self._answer.objects[numbers[:, 0] - 1], numbers[:, 1]])

    def _rows(self, name: str) -> Image:
        return self.rows(self._answer.pictures[name])


class BakedReference:
    """E of the light inside a baked .glb, at pixels."""

    def __init__(self, path: Path) -> None:
        self._baked: BakedScene = read_baked(str(path))
        self._path = path

    @cached_property
    def _probes(self) -> ProbeSet:
        assert self._baked.scene.document is not None
        probes = read_baked_probes(self._baked.scene.document)
        assert probes is not None
        return probes

    def lightmap(self, pixels: Pixels) -> Image:
        """Of the plain map."""
        return np.pi * self._texels(self._baked.pages, pixels)

    def direct(self, pixels: Pixels) -> Image:
        """What fields of indirect light lack."""
        assert self._baked.scene.document is not None
        pages = read_direct(self._baked.scene.document)
        assert pages is not None
        return np.pi * self._texels(pages, pixels)

    def directional(self, pixels: Pixels) -> Image:
        """Of the map and its companions."""
        found = self._baked.directional
        assert found is not None
        maps = {name: self._texels(pages, pixels) for name, pages in found.pages.items()}
        plain = self._texels(self._baked.pages, pixels)
        return np.pi * MODES[found.mode].irradiance_over_pi(plain, maps, pixels.normal, pixels.frame)

    def probes(self, pixels: Pixels) -> Image:
        """Of the probes around that see the surface, for the normal that is lit."""
        series = interpolate(self._probes, pixels.position, pixels.surface_normal)
        return np.maximum(irradiance(series, pixels.normal), 0.0)

    def three_probes(self, pixels: Pixels) -> Image:
        """Of all probes around, walls or not, half a cell before the surface: three.js' own light probes.

        Outside of their cells there is none.
        """
        grid = self._probes.structure
        assert isinstance(grid, ProbeGrid)
        at = (pixels.position - grid.origin) / grid.spacing + 0.5 * pixels.normal
        is_inside = np.all((at >= -0.51) & (at <= np.array(grid.shape) - 0.49), axis=1)
        at = np.clip(at, 0.0, np.array(grid.shape) - 1.0)
        low = np.minimum(np.floor(at), np.array(grid.shape) - 2.0)
        nx, ny, nz = grid.shape
        lattice = self._probes.coefficients.reshape(nz, ny, nx, 9, 3)
        series = np.zeros((len(at), 9, 3))
        for step in np.ndindex(2, 2, 2):
            x, y, z = (low + step).astype(np.int64).T
            weight = np.prod(np.abs(1.0 - np.array(step) - (at - low)), axis=1)
            series += weight[:, None, None] * lattice[z, y, x]
        return np.maximum(irradiance(series, pixels.normal), 0.0) * is_inside[:, None]

    def _texels(self, pages: NDArray[np.float32], pixels: Pixels) -> Image:
        uv, number = pixels.lightmap_rows
        instance = np.array([self._instances[tuple(row)] for row in number.tolist()])
        layout = self._baked.layout
        page_uv = uv * layout.scale[instance] + layout.offset[instance]
        return bilinear(pages, layout.page[instance], page_uv)

    @cached_property
    def _instances(self) -> dict[tuple[int, ...], int]:
        """By node, primitive and number within EXT_mesh_gpu_instancing."""
        scene = self._baked.scene
        return {
            (found.node_index, scene.primitives[found.primitive].primitive_index, found.gpu_instance or 0): i
            for i, found in enumerate(scene.instances)
        }


def field_irradiance(field: Field, pixels: Pixels) -> Image:
    """E of a field, by the readable reference."""
    position, normal = pixels.position.astype(np.float32), pixels.normal.astype(np.float32)
    return field.irradiance(position, normal).astype(np.float64)


def bilinear(pages: NDArray[np.float32], page: NDArray, uv: Image) -> Image:
    """(N, 3) of pages (P, H, W, 3), clamped at their edges."""
    _, height, width, _ = pages.shape
    at = uv * (width, height) - 0.5
    low = np.floor(at).astype(np.int64)
    share = at - low
    total = np.zeros((len(uv), 3))
    for dx, dy in np.ndindex(2, 2):
        x = np.clip(low[:, 0] + dx, 0, width - 1)
        y = np.clip(low[:, 1] + dy, 0, height - 1)
        weight = np.abs(1 - dx - share[:, 0]) * np.abs(1 - dy - share[:, 1])
        total += weight[:, None] * pages[page, y, x]
    return total


def unit(vectors: Image) -> Image:
    """(N, 3) of length 1, in more digits than the browser gave."""
    return vectors / np.linalg.norm(vectors, axis=1, keepdims=True)


def srgb_steps(drawn: Image, expected: Image) -> Image:
    """(N, 3) differences in steps of 8-bit sRGB, where four fifths of what was expected aren't clipped."""
    exposure = 1.0 / np.quantile(expected, 0.8)
    shown = [255.0 * srgb_from_linear(exposure * picture) for picture in (drawn, expected)]
    return np.abs(shown[0] - shown[1])
