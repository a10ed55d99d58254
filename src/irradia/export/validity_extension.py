"""Texel validity inside IRRADIA_lighting: how much of each of the lightmap's texels isn't hidden."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from irradia.export.lighting_extension import NAME
from irradia.export.slots import Slots
from irradia.formats.png import encode_png
from irradia.scene.gltf.document import Json


def code_validity(validity: NDArray[np.floating]) -> NDArray[np.uint8]:
    """Validity in [0, 1] as 1 … 255, of any shape; 0 is left for texels outside all charts."""
    return (1.0 + np.round(np.clip(validity, 0.0, 1.0) * 254.0)).astype(np.uint8)


def add_validity(json: Json, slots: Slots, pages: NDArray[np.uint8]) -> None:
    """Adds pages beside the lightmap that the document already holds.

    Args:
        json: The document being written; changed.
        slots: Where the images' bytes go.
        pages: (P, H, W) of :func:`code_validity`, as many and as large as the lightmap's.
    """
    images: list[Json] = [{"mimeType": "image/png", "bufferView": -1} for _ in pages]
    for image, page in zip(images, pages, strict=True):
        slots.add_blob(encode_png(page), lambda view, image=image: image.update(bufferView=view))
    json["extensions"][NAME]["validity"] = {"pages": images}
