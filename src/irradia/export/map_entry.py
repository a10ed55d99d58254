"""A map inside IRRADIA_lighting beside the lightmap: its texture, and what the document says of it."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from irradia.export.slots import Slots
from irradia.formats.ktx2 import Encoding, decode_ktx2, encode_ktx2
from irradia.scene.gltf.accessors import Accessors
from irradia.scene.gltf.document import Json
from irradia.scene.gltf.view import JsonView


def add_map_entry(slots: Slots, pages: NDArray[np.float32], encoding: Encoding, scale: float) -> Json:
    """Stores a map; returns its entry, complete once the slots are finished.

    Args:
        slots: Where the texture's bytes go.
        pages: (P, H, W, 3) linear.
        encoding: Of its texels.
        scale: Power of two; texels times it are the map's values.
    """
    entry: Json = {"bufferView": -1, "encoding": encoding, "scale": scale}
    texture = encode_ktx2(pages / np.float32(scale), encoding, {"irradia:scale": repr(scale)})
    slots.add_blob(texture, lambda view: entry.update(bufferView=view))
    return entry


def read_map_entry(entry: JsonView, accessors: Accessors) -> NDArray[np.float32]:
    """(P, H, W, 3) the values of a map.

    Raises:
        InputError: It is missing or damaged.
    """
    data = bytes(accessors.read_view(entry.integer("bufferView")))
    return decode_ktx2(data, entry.pointer).pages * np.float32(entry.number("scale", 1.0))
