"""Scenes of our own, taken wherever a scene is: ``builtin:NAME``.

Each is a glTF document made in memory, which goes through the importer like a user's file. What
glTF has no place for stands in the document's ``extras.irradia``; any .glb may hold the same:

    "extras": {"irradia": {
        "sky": {                       sky, as --sky gives it
            "sunElevationDeg": 41,     above the horizon
            "sunAzimuthDeg": 130,      direction of the sun: 0 is -Z, 90 is +X
            "turbidity": 3,            2 clear … 10 hazy
            "sun": false               whether the sky holds the sun's disc; a scene with a
        },                             directional light of its own says false
        "environmentColor": [r, g, b]  constant radiance, as --env-color gives it
    }}

``environmentColor`` (0, 0, 0) asks for black: no default light. What lights and nodes may hold stands
in :mod:`irradia.scene.gltf.lights` and :mod:`irradia.scene.gltf.object_settings`.
"""

from __future__ import annotations

import difflib
from importlib import import_module

from irradia.core.errors import InputError
from irradia.scene.gltf.document import GltfDocument

# Name → module of this package and the arguments of its ``build``.
_SCENES: dict[str, tuple[str, tuple]] = {
    "cornell": ("cornell", ()),
    "furnace": ("furnace", ("furnace", 0.5)),
    "furnace-80": ("furnace", ("furnace-80", 0.8)),
    "closed": ("closed", ()),
    "plane-point": ("plane_point", ()),
    "rectangle": ("rectangle", ()),
    "atrium": ("atrium", ()),
    "pane": ("pane", ()),
    "cylinder": ("cylinder", ()),
    "leaks": ("leaks", ()),
    "rooms": ("rooms", ()),
    "blocks": ("blocks", ()),
    "foliage": ("foliage", ()),
    "lights": ("lights", ()),
    "lights-10": ("lights", ("lights-10", 10)),
    "terrain": ("terrain", ()),
    "objects": ("objects", ("objects", False)),
    "objects-merged": ("objects", ("objects-merged", True)),
}

NAMES: tuple[str, ...] = tuple(_SCENES)

__all__ = ["NAMES", "build_document"]


def build_document(name: str) -> GltfDocument:
    """Makes the scene called ``name``.

    Raises:
        InputError: No scene has that name; the nearest one is suggested.
    """
    if name not in _SCENES:
        nearest = difflib.get_close_matches(name, NAMES, n=1, cutoff=0.0)[0]
        raise InputError(
            f"there is no built-in scene called {name!r}",
            where=f"builtin:{name}",
            fix=f"Did you mean builtin:{nearest}? There are: {', '.join(NAMES)}.",
        )
    module, arguments = _SCENES[name]
    return import_module(f"{__name__}.{module}").build(*arguments)
