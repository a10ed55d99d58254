"""Lights where their nodes put them: KHR_lights_punctual and EXT_lights_ies.

What those extensions have no word for stands in a light's ``extras.irradia``, or in its node's, which
goes first where both say something:

    "extras": {"irradia": {
        "radius": 0.05,     metres: a point or spot is a sphere and casts soft shadows
        "angleDeg": 0.53,   angular diameter of a directional light
        "mode": "mixed"     baked, mixed, realtime or off
    }}
"""

from __future__ import annotations

import math
from typing import cast, get_args

import numpy as np

from irradia.core.errors import InputError
from irradia.core.names import did_you_mean
from irradia.scene.gltf.document import GltfDocument
from irradia.scene.gltf.extras import irradia_extras, note_unknown_keys
from irradia.scene.gltf.ies_lights import IesProfiles
from irradia.scene.gltf.nodes import PlacedNode
from irradia.scene.gltf.notes import ImportNotes
from irradia.scene.gltf.view import JsonView
from irradia.scene.types import Light, LightKind, LightMode, Rgb

LIGHT_SETTINGS = ("radius", "angleDeg", "mode")
_KINDS = get_args(LightKind)


def read_lights(document: GltfDocument, nodes: list[PlacedNode], notes: ImportNotes) -> tuple[Light, ...]:
    """The lights of the scene's nodes, in the order of the nodes.

    Raises:
        InputError: A node refers to a light that isn't there, or a light is malformed.
    """
    root = JsonView(document.json)
    extension = root.extension("KHR_lights_punctual")
    lights = extension.items("lights") if extension else []
    profiles = IesProfiles(document, notes)
    placed = []
    for node in nodes:
        reference = _reference(node.view)
        if reference is not None:
            index, pointer = reference
            if index >= len(lights):
                raise InputError(f"expected an index below {len(lights)}, found {index}", where=pointer)
            placed.append(_read_light(lights[index], node, notes))
        measured = _measured_reference(node.view)
        if measured is not None:
            placed.append(_read_measured_light(measured, profiles, node, notes))
    return tuple(placed)


def carries_light(node: JsonView) -> bool:
    """Whether a light stands at this node, so that its ``extras.irradia`` may speak of it."""
    return _reference(node) is not None or _measured_reference(node) is not None


def _reference(node: JsonView) -> tuple[int, str] | None:
    """The light that a node carries, also where an earlier bake took it out of loaders' sight."""
    for name, key in (("KHR_lights_punctual", "light"), ("IRRADIA_lighting", "bakedLight")):
        view = node.extension(name)
        if view is not None and view.has(key):
            return view.integer(key), f"{view.pointer}/{key}"
    return None


def _measured_reference(node: JsonView) -> JsonView | None:
    """What a node says of its measured light, also where an earlier bake took it out of loaders' sight."""
    baked = node.extension("IRRADIA_lighting")
    if baked is not None and baked.has("bakedIesLight"):
        return baked.object("bakedIesLight")
    return node.extension("EXT_lights_ies")


def _read_light(view: JsonView, node: PlacedNode, notes: ImportNotes) -> Light:
    intensity = view.number("intensity", 1.0, minimum=0.0)
    red, green, blue = view.numbers("color", (1.0, 1.0, 1.0))
    spot = view.object("spot")
    outer = min(spot.number("outerConeAngle", math.pi / 4, minimum=0.0), math.pi / 2)
    settings = _Settings(view, node, notes)
    kind = cast(LightKind, view.choice("type", _KINDS))
    return Light(
        kind=kind,
        intensity=(red * intensity, green * intensity, blue * intensity),
        position=_rgb(node.world_from_node[:3, 3]),
        direction=_along(node, 2, -1.0, (0.0, 0.0, -1.0)),
        range_m=view.number("range", 0.0, minimum=0.0) or None,
        inner_cone_rad=min(spot.number("innerConeAngle", 0.0, minimum=0.0), outer),
        outer_cone_rad=outer,
        angle_deg=settings.number("angleDeg"),
        radius_m=0.0 if kind == "directional" else settings.number("radius"),
        mode=settings.mode(),
        up=_along(node, 0, 1.0, (1.0, 0.0, 0.0)),
        name=view.string("name") or node.name,
        node_index=node.index,
    )


def _read_measured_light(
    view: JsonView, profiles: IesProfiles, node: PlacedNode, notes: ImportNotes
) -> Light:
    """A node's EXT_lights_ies: a point whose candela the profile gives."""
    profile, definition = profiles.read(view)
    multiplier = view.number("multiplier", 1.0, minimum=0.0)
    red, green, blue = view.fractions("color", (1.0, 1.0, 1.0))
    settings = _Settings(definition, node, notes)
    return Light(
        kind="point",
        intensity=(red * multiplier, green * multiplier, blue * multiplier),
        position=_rgb(node.world_from_node[:3, 3]),
        direction=_along(node, 2, -1.0, (0.0, 0.0, -1.0)),
        radius_m=settings.number("radius"),
        mode=settings.mode(),
        profile=profile,
        up=_along(node, 0, 1.0, (1.0, 0.0, 0.0)),
        name=node.name,
        node_index=node.index,
    )


class _Settings:
    """``extras.irradia`` of a light and its node."""

    def __init__(self, light: JsonView, node: PlacedNode, notes: ImportNotes) -> None:
        own = irradia_extras(node.view)
        shared = irradia_extras(light)
        note_unknown_keys(shared, LIGHT_SETTINGS, notes)
        if not node.view.has("mesh"):  # a mesh's node has settings of its own
            note_unknown_keys(own, LIGHT_SETTINGS, notes)
        self._own, self._shared = own, shared

    def number(self, key: str) -> float:
        """A number of at least 0; 0 where neither says one."""
        return self._speaker(key).number(key, 0.0, minimum=0.0)

    def mode(self) -> LightMode:
        """The part that the light has in the bake."""
        modes = get_args(LightMode)
        view = self._speaker("mode")
        mode = view.string("mode", "baked")
        if mode not in modes:
            raise InputError(
                f"expected one of {', '.join(modes)}, found {mode[:60]!r}",
                where=f"{view.pointer}/mode",
                fix=did_you_mean(mode, modes),
            )
        return cast(LightMode, mode)

    def _speaker(self, key: str) -> JsonView:
        return self._own if self._own.has(key) else self._shared


def _along(node: PlacedNode, column: int, sign: float, flat: Rgb) -> Rgb:
    """A node's axis in the world, unit; ``flat`` where a scale leaves it no length. Lights shine along
    −Z, and +X is where their profiles begin to turn.
    """
    axis = sign * node.world_from_node[:3, column]
    length = float(np.linalg.norm(axis))
    return _rgb(axis / length) if length > 0 else flat


def _rgb(values: np.ndarray) -> Rgb:
    x, y, z = (float(value) for value in values)
    return (x, y, z)
