"""Reads documents back with a few lines of its own, so that the scenes are tested without the importer."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache

import numpy as np
import pytest

from irradia.scene.builtin import build_document
from irradia.scene.gltf.document import GltfDocument

_DTYPES = {5126: "<f4", 5123: "<u2", 5125: "<u4"}
_COMPONENTS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3}


@dataclass(frozen=True)
class Part:
    """A primitive in world space."""

    node: str
    material: str
    positions: np.ndarray
    normals: np.ndarray
    uv: np.ndarray
    indices: np.ndarray


def accessor(document: GltfDocument, index: int) -> np.ndarray:
    entry = document.json["accessors"][index]
    view = document.json["bufferViews"][entry["bufferView"]]
    values = np.frombuffer(
        document.buffers[0],
        _DTYPES[entry["componentType"]],
        entry["count"] * _COMPONENTS[entry["type"]],
        view["byteOffset"],
    )
    return values.reshape(entry["count"], -1)


def world_from_object(node: dict) -> np.ndarray:
    x, y, z, w = node.get("rotation", (0, 0, 0, 1))
    rotation = np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    )
    matrix = np.eye(4)
    matrix[:3, :3] = rotation * node.get("scale", (1, 1, 1))
    matrix[:3, 3] = node.get("translation", (0, 0, 0))
    return matrix


def read_parts(document: GltfDocument) -> list[Part]:
    json = document.json
    parts = []
    for node in json["nodes"]:
        matrix = world_from_object(node)
        for primitive in json["meshes"][node["mesh"]]["primitives"] if "mesh" in node else []:
            attributes = primitive["attributes"]
            normals = accessor(document, attributes["NORMAL"]) @ np.linalg.inv(matrix[:3, :3])
            parts.append(
                Part(
                    node["name"],
                    json["materials"][primitive["material"]]["name"],
                    accessor(document, attributes["POSITION"]) @ matrix[:3, :3].T + matrix[:3, 3],
                    normals / np.linalg.norm(normals, axis=1, keepdims=True),
                    accessor(document, attributes["TEXCOORD_0"]),
                    accessor(document, primitive["indices"]).reshape(-1, 3).astype(np.int64),
                )
            )
    return parts


@pytest.fixture(scope="session")
def document() -> Callable[[str], GltfDocument]:
    return cache(build_document)


@pytest.fixture(scope="session")
def parts(document: Callable[[str], GltfDocument]) -> Callable[[str], list[Part]]:
    return cache(lambda name: read_parts(document(name)))
