"""Directional maps inside IRRADIA_lighting; docs/directional.md says how readers decode them."""

from __future__ import annotations

from typing import cast

from irradia.bake.directional import DirectionalMaps
from irradia.bake.directional_modes import MODES, DirectionalName
from irradia.core.errors import InputError
from irradia.export.lighting_extension import NAME
from irradia.export.map_entry import add_map_entry, read_map_entry
from irradia.export.slots import Slots
from irradia.formats.ktx2 import Encoding
from irradia.formats.lightmap import power_of_two_scale
from irradia.scene.gltf.accessors import Accessors
from irradia.scene.gltf.document import GltfDocument, Json
from irradia.scene.gltf.view import JsonView


def add_directional(json: Json, slots: Slots, maps: DirectionalMaps, encoding: Encoding) -> None:
    """Adds directional maps beside the lightmap that the document already holds.

    Args:
        json: The document being written; changed.
        slots: Where the textures' bytes go.
        maps: Pages as many and as large as the lightmap's.
        encoding: Of light; numbers of [−1, 1] are halves, since steps of 1/256 would show.
    """
    entries: Json = {}
    for name, pages in maps.pages.items():
        is_light = name in MODES[maps.mode].light_maps
        scale = power_of_two_scale(pages) if is_light else 1.0
        stored: Encoding = encoding if is_light else "half"
        entries[name] = add_map_entry(slots, pages, stored, scale)
    json["extensions"][NAME]["directional"] = {"mode": maps.mode, "maps": entries}


def read_directional(document: GltfDocument, accessors: Accessors) -> DirectionalMaps | None:
    """The directional maps of a baked document, or None where it has a plain lightmap alone.

    Raises:
        InputError: The mode is unknown, or a map that it needs is missing or damaged.
    """
    extension = JsonView(document.json).object("extensions").object(NAME)
    if not extension.has("directional"):
        return None
    directional = extension.object("directional")
    mode = cast(DirectionalName, directional.choice("mode", tuple(MODES)))
    maps = directional.object("maps")
    pages = {name: read_map_entry(maps.object(name), accessors) for name in MODES[mode].maps}
    shapes = {array.shape for array in pages.values()}
    if len(shapes) > 1:
        raise InputError("expected maps of one size", where=maps.pointer)
    return DirectionalMaps(mode, pages)
