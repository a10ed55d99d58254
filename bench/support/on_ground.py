"""A model on a wide grey ground, as a .gltf of its own: something real for an environment to light."""

from __future__ import annotations

import json
import shutil
from pathlib import Path
from typing import Any

import numpy as np

from irradia.scene.load import load_scene
from irradia.scene.merge import merge

REACH = 1.5  # of the model's longest side, from its middle
SINK = 1e-4  # likewise: so far below the model that nothing coincides
GREY = (0.4, 0.4, 0.38, 1.0)


def put_on_ground(model: Path, folder: Path) -> Path:
    """Copies a .gltf with its files to a folder, adds the ground, and returns the new .gltf."""
    corners = merge(load_scene(str(model))).positions
    low, high = corners.min(axis=0), corners.max(axis=0)
    longest = float((high - low).max())
    middle = 0.5 * (low + high)
    x, z, reach = float(middle[0]), float(middle[2]), REACH * longest
    y = float(low[1]) - SINK * longest
    around = ((-1, 1), (1, 1), (1, -1), (-1, -1))
    positions = np.array([(x + i * reach, y, z + j * reach) for i, j in around], "<f4")

    folder.mkdir(parents=True, exist_ok=True)
    for file in model.parent.iterdir():
        shutil.copyfile(file, folder / file.name)
    (folder / "ground.bin").write_bytes(_buffer(positions))
    document = json.loads(model.read_text(encoding="utf-8"))
    _add(document, positions)
    path = folder / f"{model.stem}-on-ground.gltf"
    path.write_text(json.dumps(document), encoding="utf-8")
    return path


def _buffer(positions: np.ndarray) -> bytes:
    normals = np.tile(np.array([0, 1, 0], "<f4"), (4, 1))
    return positions.tobytes() + normals.tobytes() + np.array([0, 1, 2, 0, 2, 3], "<u2").tobytes()


def _add(document: dict[str, Any], positions: np.ndarray) -> None:
    buffer, view, accessor = (len(document[key]) for key in ("buffers", "bufferViews", "accessors"))
    document["buffers"].append({"byteLength": 108, "uri": "ground.bin"})
    document["bufferViews"] += [
        {"buffer": buffer, "byteOffset": first, "byteLength": size}
        for first, size in ((0, 48), (48, 48), (96, 12))
    ]
    box = {"min": positions.min(axis=0).tolist(), "max": positions.max(axis=0).tolist()}
    vectors = {"componentType": 5126, "count": 4, "type": "VEC3"}
    document["accessors"] += [
        {"bufferView": view, **vectors, **box},
        {"bufferView": view + 1, **vectors},
        {"bufferView": view + 2, "componentType": 5123, "count": 6, "type": "SCALAR"},
    ]
    look = {"baseColorFactor": GREY, "metallicFactor": 0.0}
    document.setdefault("materials", []).append({"name": "ground", "pbrMetallicRoughness": look})
    attributes = {"POSITION": accessor, "NORMAL": accessor + 1}
    primitive = {
        "attributes": attributes,
        "indices": accessor + 2,
        "material": len(document["materials"]) - 1,
    }
    document["meshes"].append({"primitives": [primitive]})
    document["nodes"].append({"name": "ground", "mesh": len(document["meshes"]) - 1})
    document["scenes"][document.get("scene", 0)]["nodes"].append(len(document["nodes"]) - 1)
