"""Sources of light with questions and the answers of the NumPy references."""

from __future__ import annotations

import json
import math
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

import numpy as np

Source = Literal["field", "lightmap", "directional", "probes", "things", "direct"]
N_COLUMNS = 5


@dataclass(frozen=True)
class Questions:
    """What shaders are asked, all (Q, k) and in world space.

    Attributes:
        position, normal, surface_normal: (Q, 3).
        tangent: (Q, 4).
        uv: (Q, 2) of the page.
        page: (Q,).
    """

    position: np.ndarray
    normal: np.ndarray
    surface_normal: np.ndarray
    tangent: np.ndarray
    uv: np.ndarray
    page: np.ndarray

    def packed(self) -> np.ndarray:
        """(Q, 5, 4) float32, as wrappers read it."""
        rows = np.zeros((len(self.page), N_COLUMNS, 4), np.float32)
        rows[:, 0, :3], rows[:, 0, 3] = self.position, self.page
        rows[:, 1, :3], rows[:, 2, :3] = self.normal, self.surface_normal
        rows[:, 3], rows[:, 4, :2] = self.tangent, self.uv
        return rows


@dataclass(frozen=True)
class Case:
    """A source of light, and what it should give.

    Attributes:
        name: Of its files.
        file: A field or a baked .glb.
        source: Which light of it.
        questions: What it is asked.
        expected: (Q, 3) E, or of a view its numbers.
        view: The view that is asked in place of the light.
        max_uniform_bytes: The device's; constants go to a texture where they are more.
        max_size: The device's largest side of a texture; longer lists go on in further layers.
        precision: Of a field's perceptron: ``float`` or ``half``.
        everywhere: Whether GLSL and HLSL are asked on lavapipe too, not just WGSL there and GLSL in WebGL2.
    """

    name: str
    file: Path
    source: Source
    questions: Questions
    expected: np.ndarray
    view: str | None = None
    max_uniform_bytes: int | None = None
    max_size: int | None = None
    precision: str = "float"
    everywhere: bool = True

    def job(self) -> dict[str, Any]:
        """For web/checks/shader-cases.ts."""
        job = {"name": self.name, "file": str(self.file), "source": self.source}
        job["precision"] = self.precision
        limits = {"maxUniformBytes": self.max_uniform_bytes, "maxSize": self.max_size}
        return job | {name: limit for name, limit in limits.items() if limit is not None}


@dataclass(frozen=True)
class Shader:
    """A case's text and what is bound to it, as web/checks/shader-cases.ts wrote it."""

    folder: Path
    json: dict[str, Any]

    def text(self, language: str) -> str:
        return self.json["texts"][language]

    def data(self, bound: dict[str, Any]) -> bytes:
        """Of one of its textures or uniforms."""
        return (self.folder / bound["file"]).read_bytes()

    @property
    def textures(self) -> list[dict[str, Any]]:
        return self.json["textures"]

    @property
    def uniforms(self) -> list[dict[str, Any]]:
        return self.json["uniforms"]

    def function(self, view: str | None) -> str:
        """The name of what is called."""
        return "irradia_light" if view is None else self.json["views"][view]

    def call(self, view: str | None, column: Callable[[int], str]) -> str:
        """An expression for the light of a question; ``column`` gives one of its vec4s."""
        inputs = {
            "position": f"{column(0)}.xyz",
            "normal": f"{column(1)}.xyz",
            "surfaceNormal": f"{column(2)}.xyz",
            "tangent": column(3),
            "lightmapUv": f"{column(4)}.xy",
            "page": f"{column(0)}.w",
        }
        return f"{self.function(view)}({', '.join(inputs[name] for name in self.json['inputs'])})"


def read_shaders(folder: Path) -> dict[str, Shader]:
    """By case's name."""
    found = json.loads((folder / "cases.json").read_text(encoding="utf-8"))
    return {entry["name"]: Shader(folder, entry) for entry in found}


def made_questions(n: int, low: np.ndarray, high: np.ndarray, n_pages: int = 1) -> Questions:
    """Places all over a box, and normals bent away from their surface's by up to a right angle."""
    rng = np.random.default_rng(31)
    surface, normal, tangent = unit(rng.normal(size=(3, n, 3)))
    normal = unit(surface + 0.8 * normal)
    tangent = unit(np.cross(surface, tangent))
    signs = np.where(rng.random(n) < 0.5, -1.0, 1.0)
    return Questions(
        position=np.float32(low + rng.random((n, 3)) * (high - low)),
        normal=np.float32(normal),
        surface_normal=np.float32(surface),
        tangent=np.float32(np.column_stack([tangent, signs])),
        uv=np.float32(rng.random((n, 2))),
        page=np.float32(rng.integers(0, n_pages, n)),
    )


def unit(vectors: np.ndarray) -> np.ndarray:
    return vectors / np.linalg.norm(vectors, axis=-1, keepdims=True)


def bilinear(pages: np.ndarray, uv: np.ndarray, page: np.ndarray) -> np.ndarray:
    """(Q, 3) of (P, H, W, 3) at page uv, clamped to the edge; row 0 is v = 0."""
    _, height, width, _ = pages.shape
    at = np.float64(uv) * (width, height) - 0.5
    base = np.floor(at).astype(int)
    share = at - base
    total = np.zeros((len(uv), 3))
    for dy, dx in ((0, 0), (0, 1), (1, 0), (1, 1)):
        column = np.clip(base[:, 0] + dx, 0, width - 1)
        row = np.clip(base[:, 1] + dy, 0, height - 1)
        weight = np.abs(1 - dx - share[:, 0]) * np.abs(1 - dy - share[:, 1])
        total += weight[:, None] * pages[page.astype(int), row, column]
    return total


def worst(found: np.ndarray, expected: np.ndarray) -> float:
    """The largest error, as a share of the largest value; infinite where anything isn't finite."""
    if not np.isfinite(found).all():
        return math.inf
    return float(np.abs(found - expected).max() / np.abs(expected).max())
