"""The shadow mask inside a baked .glb: its pages on the document, each light's channel on its node."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from irradia.export.lighting_extension import NAME
from irradia.export.slots import Slots
from irradia.formats.shadow_mask import encode_shadow_mask
from irradia.scene.gltf.document import Json
from irradia.scene.types import Light


@dataclass(frozen=True)
class BakedShadows:
    """What arrives of live lights.

    Attributes:
        pages: (P, H, W, 4) visibility, as many and as large as the lightmap's.
        channels: By light of the scene: 0 … 3, or None for those without a mask.
    """

    pages: NDArray[np.float32]
    channels: tuple[int | None, ...]


def live_nodes(lights: Sequence[Light]) -> frozenset[int]:
    """Nodes whose lights shine on at run time."""
    return frozenset(
        light.node_index for light in lights if light.mode != "baked" and light.node_index is not None
    )


def add_shadow_mask(json: Json, slots: Slots, lights: Sequence[Light], shadows: BakedShadows | None) -> None:
    """Adds the mask beside the lightmap that the document already holds, and says whose it is.

    Args:
        json: The document being written; changed. What earlier bakes said of masks goes.
        slots: Where the images' bytes go.
        lights: The scene's.
        shadows: None where no light has a mask.
    """
    for node in json.get("nodes", []):
        _forget(node)
    if shadows is None:
        return
    for light, channel in zip(lights, shadows.channels, strict=True):
        if channel is not None and light.node_index is not None:
            extensions = json["nodes"][light.node_index].setdefault("extensions", {})
            extensions.setdefault(NAME, {})["shadowMaskChannel"] = channel
    images: list[Json] = [{"mimeType": "image/png", "bufferView": -1} for _ in shadows.pages]
    for image, page in zip(images, shadows.pages, strict=True):
        data = encode_shadow_mask(page)
        slots.add_blob(data, lambda view, image=image: image.update(bufferView=view))
    json["extensions"][NAME]["shadowMask"] = {"pages": images}


def _forget(node: Json) -> None:
    """Takes away an earlier bake's channel, and what is empty then."""
    extensions = node.get("extensions", {})
    if extensions.get(NAME, {}).pop("shadowMaskChannel", None) is None:
        return
    if not extensions[NAME]:
        del extensions[NAME]
    if not extensions:
        del node["extensions"]
