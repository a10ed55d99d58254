"""Perspective cameras where their nodes put them."""

from __future__ import annotations

import numpy as np

from irradia.scene.gltf.nodes import PlacedNode
from irradia.scene.gltf.notes import ImportNotes
from irradia.scene.gltf.view import JsonView
from irradia.scene.types import F64, Camera


def read_cameras(root: JsonView, nodes: list[PlacedNode], notes: ImportNotes) -> tuple[Camera, ...]:
    """The perspective cameras of the scene's nodes; orthographic ones are noted."""
    cameras = []
    for node in nodes:
        if not node.view.has("camera"):
            continue
        view = root.element("cameras", node.view.integer("camera"))
        if view.choice("type", ("perspective", "orthographic")) == "orthographic":
            notes.add(f"orthographic camera '{view.string('name') or node.name}' is not supported")
            continue
        cameras.append(_perspective(view, node))
    return tuple(cameras)


def _perspective(view: JsonView, node: PlacedNode) -> Camera:
    lens = view.object("perspective")
    return Camera(
        world_from_camera=_without_scale(node.world_from_node),
        yfov_rad=lens.number("yfov", 0.8, minimum=1e-4),
        aspect=lens.number("aspectRatio", 16.0 / 9.0, minimum=1e-4),
        name=view.string("name") or node.name,
    )


def _without_scale(world_from_node: F64) -> F64:
    """A rigid transform with the same position, viewing direction and up: a camera has no size."""
    back = _unit(world_from_node[:3, 2], (0.0, 0.0, 1.0))
    right = _unit(np.cross(world_from_node[:3, 1], back), (1.0, 0.0, 0.0))
    rigid = np.eye(4)
    rigid[:3, :3] = np.column_stack([right, np.cross(back, right), back])
    rigid[:3, 3] = world_from_node[:3, 3]
    return rigid


def _unit(vector: F64, fallback: tuple[float, float, float]) -> F64:
    length = np.linalg.norm(vector)
    return vector / length if length > 0 else np.asarray(fallback)
