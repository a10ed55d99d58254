"""The shadow mask inside a baked .glb: its pages on the document, each light's channel on its node."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from irradia.export.lighting_extension import NAME
from irradia.export.slots import Slots
from irradia.formats.shadow_mask import encode_shadow_mask
from irradia.scene.gltf.document import Json


def add_shadow_mask(json: Json, slots: Slots, pages: NDArray[np.float32]) -> None:
    """Adds the mask beside the lightmap that the document already holds.

    Args:
        json: The document being written; changed.
        slots: Where the images' bytes go.
        pages: (P, H, W, 4) visibility, as many and as large as the lightmap's.
    """
    images: list[Json] = [{"mimeType": "image/png", "bufferView": -1} for _ in pages]
    for image, page in zip(images, pages, strict=True):
        data = encode_shadow_mask(page)
        slots.add_blob(data, lambda view, image=image: image.update(bufferView=view))
    json["extensions"][NAME]["shadowMask"] = {"pages": images}


def bind_mask_channels(json: Json, channel_of_node: Mapping[int, int]) -> None:
    """Tells nodes with live lights which channel holds their shadow; forgets what earlier bakes told."""
    for index, node in enumerate(json.get("nodes", [])):
        extensions = node.setdefault("extensions", {})
        ours = extensions.setdefault(NAME, {})
        ours.pop("shadowMaskChannel", None)
        if index in channel_of_node:
            ours["shadowMaskChannel"] = channel_of_node[index]
        _drop_empty(extensions, NAME)
        _drop_empty(node, "extensions")


def _drop_empty(holder: Json, key: str) -> None:
    if not holder[key]:
        del holder[key]
