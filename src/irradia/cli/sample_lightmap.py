"""A finished bake as the light that surfaces shine with while a scene is sampled."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np

from irradia.bake.datasets.setting import BakedPages
from irradia.core.errors import InputError
from irradia.export.read_baked import read_baked
from irradia.scene.gltf.document import GltfDocument
from irradia.scene.load import LoadOptions
from irradia.scene.merge import merge
from irradia.scene.types import Scene

BAKED_NAME = "scene.baked.glb"
_BAKE_AGAIN = "Bake it with `irradia bake` in mode full and all lights baked, or leave --lightmap out."


def read_all_light(where: Path, scene: Scene, load: LoadOptions) -> tuple[Scene, BakedPages, Path]:
    """The baked scene under the lights of ``scene``, and its lightmap.

    Args:
        where: A bake's folder, or its ``scene.baked.glb``.
        scene: The one that was baked, lit as it was.
        load: The state of the file that is meant.

    Returns:
        The scene with the bake's vertices, its lightmap, and the file.

    Raises:
        InputError: There is no bake, it is of another scene, or it doesn't hold all light.
    """
    path = where / BAKED_NAME if where.is_dir() else where
    _check_mode(path.with_name("bake.json"))
    baked = read_baked(str(path), load)
    if not _same_surfaces(baked.scene, scene):
        raise InputError(f"expected a bake of {scene.name!r}, found other surfaces", where=str(path))
    if baked.scene.document is not None and _has_live_lights(baked.scene.document):
        raise InputError("the direct light of its live lights is missing", where=str(path), fix=_BAKE_AGAIN)
    lit = replace(baked.scene, name=scene.name, lights=scene.lights, environment=scene.environment)
    return lit, BakedPages(baked.layout, baked.pages), path


def _check_mode(record: Path) -> None:
    """Refuses a bake whose record says that it holds other than full light."""
    try:
        mode = json.loads(record.read_text(encoding="utf-8")).get("stats", {}).get("mode", "full")
    except (OSError, ValueError):
        return  # a .glb by itself
    if mode != "full":
        raise InputError(f"expected full light, found {mode}", where=str(record), fix=_BAKE_AGAIN)


def _same_surfaces(one: Scene, other: Scene) -> bool:
    """Whether two scenes have the same number of triangles, and these span the same box."""
    if one.n_triangles != other.n_triangles:
        return False
    boxes = []
    for scene in (one, other):
        positions = merge(scene).positions
        boxes.append(np.stack([positions.min(axis=0), positions.max(axis=0)]))
    size = float(np.ptp(boxes[0], axis=0).max())
    return bool(np.abs(boxes[0] - boxes[1]).max() <= 1e-3 * size)


def _has_live_lights(document: GltfDocument) -> bool:
    """Whether lights still stand at nodes: those whose light the map doesn't hold."""
    nodes = document.json.get("nodes", [])
    live = ("KHR_lights_punctual", "EXT_lights_ies")
    return any(name in node.get("extensions", {}) for node in nodes for name in live)
