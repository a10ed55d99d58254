"""What a node says of its object's part in the bake: ``extras.irradia``.

    "extras": {"irradia": {
        "lightmapScale": 2.0,   texels per metre against the scene's; 0 takes no lightmap
        "receives": false,      takes no lightmap: its light goes on as a path
        "casts": false          rays pass through it: it neither shadows nor lights anything
    }}

Both false leaves the object out of the bake.
"""

from __future__ import annotations

from dataclasses import dataclass

from irradia.scene.gltf.extras import irradia_extras, note_unknown_keys
from irradia.scene.gltf.lights import LIGHT_SETTINGS, carries_light
from irradia.scene.gltf.notes import ImportNotes
from irradia.scene.gltf.view import JsonView

_KEYS = ("lightmapScale", "receives", "casts")


@dataclass(frozen=True)
class ObjectSettings:
    """A node's wishes.

    Attributes:
        lightmap_scale: Relative texel density; 0 where the object takes no lightmap.
        casts: Whether it blocks and reflects light for others.
    """

    lightmap_scale: float = 1.0
    casts: bool = True


def read_object_settings(node: JsonView, notes: ImportNotes) -> ObjectSettings:
    """Reads a mesh's node.

    Raises:
        InputError: A setting has the wrong type.
    """
    extras = irradia_extras(node)
    known = (*_KEYS, *LIGHT_SETTINGS) if carries_light(node) else _KEYS
    note_unknown_keys(extras, known, notes)
    scale = extras.number("lightmapScale", 1.0, minimum=0.0)
    return ObjectSettings(
        lightmap_scale=scale if extras.boolean("receives", True) else 0.0,
        casts=extras.boolean("casts", True),
    )
