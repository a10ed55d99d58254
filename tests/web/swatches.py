"""Squares of paint in a row, and the same row behind panes: what materials do with light, each by itself."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from irradia.core.rng import Seed
from irradia.export.glb import Companions, write_baked_glb
from irradia.field.field import Field
from irradia.field.native_fields import decode_field, encode_field
from irradia.scene.builtin.builder import SceneBuilder
from irradia.scene.builtin.matte import matte
from irradia.scene.builtin.mesh import look_at
from irradia.scene.builtin.shapes import face
from irradia.scene.gltf import document_to_scene
from irradia.scene.types import Camera, Light, LightMode, Material, Scene

from .made_light import FIELDS, bounds, made_field, made_layout, made_pages

COLUMNS, ROWS = 8, 2
DISTANCE_M = 12.0
GOLD, WOOD, LEAF = (0.9, 0.7, 0.3, 1.0), (0.5, 0.25, 0.1, 1.0), (0.2, 0.6, 0.3, 0.4)
# By name: material, and extensions that the builder doesn't write.
PAINTS: dict[str, tuple[Material, dict[str, Any]]] = {
    "white": (matte("white", (0.9, 0.9, 0.9)), {}),
    "metal": (Material("metal", GOLD, metallic=1.0, roughness=0.3), {}),
    "half metal": (Material("half metal", WOOD, metallic=0.5, roughness=0.6), {}),
    "varnish": (Material("varnish", WOOD, metallic=0.0, roughness=0.2), {}),
    "diamond": (Material("diamond", WOOD, metallic=0.0), {"KHR_materials_ior": {"ior": 2.4}}),
    "tinted": (
        Material("tinted", WOOD, metallic=0.2),
        {"KHR_materials_specular": {"specularFactor": 0.7, "specularColorFactor": [1.0, 0.4, 0.2]}},
    ),
    "coated": (
        Material("coated", WOOD, metallic=0.0),
        {"KHR_materials_clearcoat": {"clearcoatFactor": 1.0}, "KHR_materials_sheen": {}},
    ),
    "lamp": (Material("lamp", WOOD, metallic=0.0, emission=(0.05, 0.1, 0.2)), {}),
}
PANES: dict[str, tuple[Material, dict[str, Any]]] = {
    "gauze": (Material("gauze", LEAF, metallic=0.0, alpha_mode="blend"), {}),
    "glass": (Material("glass", LEAF, metallic=0.0, transmission=0.9), {}),
    "both": (Material("both", LEAF, metallic=0.3, transmission=0.6, alpha_mode="blend"), {}),
    "two-sided": (Material("two-sided", LEAF, metallic=0.0, transmission=1.0, double_sided=True), {}),
    "hole": (Material("hole", LEAF, metallic=0.0, alpha_mode="mask"), {}),
    "thick": (
        Material("thick", LEAF, metallic=0.0, transmission=0.8),
        {"KHR_materials_volume": {"thicknessFactor": 0.3}, "KHR_materials_ior": {"ior": 1.8}},
    ),
    "glowing": (Material("glowing", LEAF, metallic=0.0, transmission=0.5, emission=(0.1, 0.0, 0.1)), {}),
}
MAPPED_TRANSMISSION = 200  # of 255


def swatches(lamp: LightMode | None = None, *, has_panes: bool = True) -> Scene:
    """The scene; with a lamp of this mode before it."""
    builder = SceneBuilder("swatches")
    texture = builder.texture("share", np.full((2, 2, 3), MAPPED_TRANSMISSION, np.uint8))
    panes = dict(PANES)
    mapped = Material("mapped", LEAF, metallic=0.0, transmission=1.0)
    panes["mapped"] = (
        mapped,
        {
            "KHR_materials_transmission": {
                "transmissionFactor": 1.0,
                "transmissionTexture": {"index": texture.image},
            }
        },
    )
    extensions: list[dict[str, Any]] = []

    def add(name: str, corners: NDArray, looks: tuple[Material, dict[str, Any]]) -> None:
        builder.object(name, (face(corners), builder.material(looks[0])))
        extensions.append(looks[1])

    for row in range(ROWS):
        for column, (name, looks) in enumerate(PAINTS.items()):
            add(f"{name} {row}", square(row, column, 0.0), looks)
    for column, (name, looks) in enumerate(panes.items() if has_panes else ()):
        add(name, square(0, column, 0.1), looks)
    if lamp is not None:
        builder.light(Light("point", (30.0, 20.0, 10.0), position=(4.0, 3.0, 4.0), name="lamp", mode=lamp))
    builder.camera(camera())
    builder.environment_color((0.0, 0.0, 0.0))
    document = builder.build()
    json = dict(document.json)
    json["materials"] = [
        {**material, "extensions": {**material.get("extensions", {}), **more}}
        for material, more in zip(json["materials"], extensions, strict=True)
    ]
    json["extensionsUsed"] = sorted(
        {name for m in json["materials"] for name in m["extensions"]} | {*json.get("extensionsUsed", [])}
    )
    return document_to_scene(replace(document, json=json))


def square(row: int, column: int, z: float) -> NDArray[np.float64]:
    """(4, 3) corners."""
    x, y = float(column), float(row)
    return np.array([(x, y, z), (x + 1, y, z), (x + 1, y + 1, z), (x, y + 1, z)])


def camera() -> Camera:
    """Far away, so that panes stand before their swatches."""
    middle = (COLUMNS / 2, ROWS / 2)
    yfov = 2 * np.arctan(0.55 * ROWS / DISTANCE_M)
    return Camera(look_at((*middle, DISTANCE_M), (*middle, 0.0)), yfov_rad=float(yfov), name="camera")


def light_of(scene: Scene) -> Field:
    """A smooth field that holds all baked light."""
    return replace(decode_field(made_field(FIELDS["identity"], bounds(scene))).field, backend_name="numpy")


def write_swatches(path: Path, lamp: LightMode | None = None, *, has_panes: bool = True) -> None:
    """The scene with its field, which a lamp isn't part of, and a lightmap that says something else."""
    scene = swatches(lamp, has_panes=has_panes)
    field = light_of(scene)
    frame = replace(field.frame, quantity="full" if lamp is None else "indirect")
    companions = Companions(field=encode_field(replace(field, frame=frame)))
    write_baked_glb(path, scene, made_layout(scene), made_pages(Seed(4), 0.5, 1.5), companions)


def means(picture: NDArray[np.float32]) -> NDArray[np.float64]:
    """(ROWS, COLUMNS, 3) mean colours of the squares, row 0 the lower; edges are left out."""
    height, width, _ = picture.shape
    size = height / (1.1 * ROWS)
    found = np.empty((ROWS, COLUMNS, 3))
    for row, column in np.ndindex(ROWS, COLUMNS):
        x = width / 2 + (column - COLUMNS / 2) * size
        y = height / 2 - (row + 1 - ROWS / 2) * size
        low, high = 0.2 * size, 0.8 * size
        block = picture[round(y + low) : round(y + high), round(x + low) : round(x + high)]
        found[row, column] = block.mean(axis=(0, 1), dtype=np.float64)
    return found
