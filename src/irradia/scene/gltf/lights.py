"""KHR_lights_punctual lights where their nodes put them."""

from __future__ import annotations

import math
from typing import cast

import numpy as np

from irradia.core.errors import InputError
from irradia.scene.gltf.extras import irradia_extras
from irradia.scene.gltf.nodes import PlacedNode
from irradia.scene.gltf.view import JsonView
from irradia.scene.types import Light, LightKind, Rgb

_KINDS = ("directional", "point", "spot")


def read_lights(root: JsonView, nodes: list[PlacedNode]) -> tuple[Light, ...]:
    """The lights of the scene's nodes, in the order of the nodes.

    Raises:
        InputError: A node refers to a light that isn't there, or a light is malformed.
    """
    extension = root.extension("KHR_lights_punctual")
    lights = extension.items("lights") if extension else []
    placed = []
    for node in nodes:
        reference = _reference(node.view)
        if reference is None:
            continue
        index, pointer = reference
        if index >= len(lights):
            raise InputError(f"expected an index below {len(lights)}, found {index}", where=pointer)
        placed.append(_read_light(lights[index], node))
    return tuple(placed)


def _reference(node: JsonView) -> tuple[int, str] | None:
    """The light that a node carries, also where an earlier bake took it out of loaders' sight."""
    for name, key in (("KHR_lights_punctual", "light"), ("IRRADIA_lighting", "bakedLight")):
        view = node.extension(name)
        if view is not None and view.has(key):
            return view.integer(key), f"{view.pointer}/{key}"
    return None


def _read_light(view: JsonView, node: PlacedNode) -> Light:
    intensity = view.number("intensity", 1.0, minimum=0.0)
    red, green, blue = view.numbers("color", (1.0, 1.0, 1.0))
    spot = view.object("spot")
    outer = min(spot.number("outerConeAngle", math.pi / 4, minimum=0.0), math.pi / 2)
    return Light(
        kind=cast(LightKind, view.choice("type", _KINDS)),
        intensity=(red * intensity, green * intensity, blue * intensity),
        position=_rgb(node.world_from_node[:3, 3]),
        direction=_beam(node),
        range_m=view.number("range", 0.0, minimum=0.0) or None,
        inner_cone_rad=min(spot.number("innerConeAngle", 0.0, minimum=0.0), outer),
        outer_cone_rad=outer,
        angle_deg=irradia_extras(view).number("angleDeg", 0.0, minimum=0.0),
        name=view.string("name") or node.name,
    )


def _beam(node: PlacedNode) -> Rgb:
    """Lights shine along their node's −Z; a scale that flattens it leaves the world's."""
    axis = -node.world_from_node[:3, 2]
    length = float(np.linalg.norm(axis))
    return _rgb(axis / length) if length > 0 else (0.0, 0.0, -1.0)


def _rgb(values: np.ndarray) -> Rgb:
    x, y, z = (float(value) for value in values)
    return (x, y, z)
