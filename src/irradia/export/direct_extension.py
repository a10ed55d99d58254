"""The direct map inside IRRADIA_lighting: the part of the lightmap that fields of indirect light lack."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from irradia.core.errors import InputError
from irradia.export.lighting_extension import NAME
from irradia.export.map_entry import add_map_entry, read_map_entry
from irradia.export.slots import Slots
from irradia.formats.ktx2 import Encoding
from irradia.formats.lightmap import power_of_two_scale
from irradia.scene.gltf.accessors import Accessors
from irradia.scene.gltf.document import GltfDocument, Json
from irradia.scene.gltf.view import JsonView


def add_direct(json: Json, slots: Slots, pages: NDArray[np.float32], encoding: Encoding) -> None:
    """Adds the map beside the lightmap that the document already holds.

    Args:
        json: The document being written; changed.
        slots: Where the texture's bytes go.
        pages: (P, H, W, 3) E/π, as many and as large as the lightmap's.
        encoding: Of the texture's texels.
    """
    scale = power_of_two_scale(pages[pages.max(axis=-1) > 0.0])
    json["extensions"][NAME]["direct"] = add_map_entry(slots, pages, encoding, scale)


def read_direct(document: GltfDocument) -> NDArray[np.float32] | None:
    """(P, H, W, 3) E/π of the first bounce of baked punctual lights, or None where there is no such map.

    Raises:
        InputError: The map is damaged, or of another size than the lightmap.
    """
    extension = JsonView(document.json).object("extensions").object(NAME)
    if not extension.has("direct"):
        return None
    entry, lightmap = extension.object("direct"), extension.object("lightmap")
    pages = read_map_entry(entry, Accessors(document))
    expected = tuple(lightmap.integer(name) for name in ("pages", "height", "width"))
    if pages.shape[:3] != expected:
        raise InputError(
            f"expected a map as large as the lightmap, {expected}, found {pages.shape[:3]}",
            where=entry.pointer,
        )
    return pages
