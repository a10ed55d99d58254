"""IRRADIA_lighting: the true HDR lightmap and who reads which part of it; docs/IRRADIA_lighting/."""

from __future__ import annotations

from collections.abc import Container, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from irradia.core.colour import automatic_exposure_ev
from irradia.export.bindings import Binding, NodeBindings
from irradia.export.slots import Slots
from irradia.formats.ktx2 import Encoding, encode_ktx2
from irradia.formats.lightmap import QUANTITY, power_of_two_scale
from irradia.scene.gltf.document import Json
from irradia.scene.layout import LightmapLayout
from irradia.scene.types import Light

NAME = "IRRADIA_lighting"
VERSION = 1
NO_PAGE = 0xFFFF
_LIGHTS, _MEASURED_LIGHTS = "KHR_lights_punctual", "EXT_lights_ies"


def light_in_map(lights: Sequence[Light]) -> Literal["full", "indirect"]:
    """Which light a map holds by the modes of the lights that it was baked with."""
    return "indirect" if any(light.mode in ("mixed", "realtime") for light in lights) else "full"


def add_lightmap(
    json: Json,
    slots: Slots,
    pages: NDArray[np.float32],
    encoding: Encoding,
    light: Literal["full", "indirect"] = "full",
) -> None:
    """Adds the map to the document's root.

    Args:
        json: The document being written.
        slots: Where the texture's bytes go.
        pages: (P, H, W, 3) E/π.
        encoding: Of the texture's texels.
        light: ``indirect`` where first bounces of live lights are left out.
    """
    scale, exposure_ev = _brightness(pages)
    lightmap: Json = {
        "quantity": QUANTITY,
        "light": light,
        "mimeType": "image/ktx2",
        "bufferView": -1,
        "encoding": encoding,
        "scale": scale,
        "exposure": round(exposure_ev, 3),
        "width": pages.shape[2],
        "height": pages.shape[1],
        "pages": pages.shape[0],
    }
    texture = encode_ktx2(pages / np.float32(scale), encoding, {"irradia:scale": repr(scale)})
    slots.add_blob(texture, lambda view: lightmap.update(bufferView=view))
    json.setdefault("extensions", {})[NAME] = {"version": VERSION, "lightmap": lightmap}


def _brightness(pages: NDArray[np.float32]) -> tuple[float, float]:
    """Scale and exposure of what isn't black."""
    lit = pages[pages.max(axis=-1) > 0.0]
    return power_of_two_scale(lit), automatic_exposure_ev(lit)


@dataclass(frozen=True)
class InstanceTables:
    """Where an instanced node's per-instance data goes.

    Attributes:
        slots: Takes the accessors.
        count: Instances that EXT_mesh_gpu_instancing places.
        number: Place among them of each of the scene's instances.
    """

    slots: Slots
    count: int
    number: Sequence[int]


def bind_node(
    node: Json,
    bindings: NodeBindings,
    texcoords: dict[int, int],
    n_primitives: int,
    layout: LightmapLayout,
    tables: InstanceTables | None,
) -> None:
    """Writes what a node's primitives read.

    Args:
        node: The node's JSON, which is changed.
        bindings: By primitive of its mesh.
        texcoords: The set that holds the uv, by primitive.
        n_primitives: Of its mesh.
        layout: Of the lightmap.
        tables: For a node with EXT_mesh_gpu_instancing.
    """
    entries: list[Json] = []
    for index in range(n_primitives):
        binding = bindings.get(index)
        if binding is None:
            entries.append({})
        elif tables is None or binding.final:
            entries.append({"texCoord": texcoords[index], **_rectangle(layout, binding)})
        else:
            entries.append({"texCoord": texcoords[index], **_by_instance(layout, binding, tables)})
    node.setdefault("extensions", {}).setdefault(NAME, {})["primitives"] = entries


def move_baked_lights(json: Json, live: Container[int] = ()) -> None:
    """Takes lights off their nodes, because the map holds their light.

    A punctual light's number moves to ``bakedLight`` of our extension, and what a node says of a measured
    one to ``bakedIesLight``; the definitions stay where they are. Lights that shine live stay on their
    nodes, and come back to them where an earlier bake took them off.

    Args:
        json: The document being written; changed.
        live: Nodes whose lights shine live.
    """
    for index, node in enumerate(json.get("nodes", [])):
        extensions = node.get("extensions", {})
        if index in live:
            _put_back(extensions)
        else:
            _take_off(extensions)


def _take_off(extensions: Json) -> None:
    punctual, measured = (extensions.pop(name, None) for name in (_LIGHTS, _MEASURED_LIGHTS))
    if punctual is not None:
        extensions.setdefault(NAME, {})["bakedLight"] = punctual["light"]
    if measured is not None:
        extensions.setdefault(NAME, {})["bakedIesLight"] = measured


def _put_back(extensions: Json) -> None:
    ours = extensions.get(NAME, {})
    if "bakedLight" in ours:
        extensions[_LIGHTS] = {"light": ours.pop("bakedLight")}
    if "bakedIesLight" in ours:
        extensions[_MEASURED_LIGHTS] = ours.pop("bakedIesLight")
    if NAME in extensions and not ours:
        del extensions[NAME]


def _rectangle(layout: LightmapLayout, binding: Binding) -> Json:
    """Page of a single instance; scale and offset where uv is still the rectangle's own."""
    instance = binding.instances[0]
    entry: Json = {"page": int(layout.page[instance])}
    if not binding.final:
        entry["scale"] = layout.scale[instance].tolist()
        entry["offset"] = layout.offset[instance].tolist()
    return entry


def _by_instance(layout: LightmapLayout, binding: Binding, tables: InstanceTables) -> Json:
    """Accessors with scale and offset of each GPU instance, and with pages where they differ."""
    members = list(binding.instances)
    rows = [tables.number[instance] for instance in members]
    scale_offset = np.zeros((tables.count, 4), np.float32)
    scale_offset[rows] = np.hstack([layout.scale[members], layout.offset[members]])
    pages = np.full((tables.count, 1), NO_PAGE, np.uint16)
    pages[rows, 0] = layout.page[members]
    entry: Json = {"scaleOffsets": tables.slots.add_table(scale_offset, "VEC4")}
    if (pages == pages[0]).all():
        return entry | {"page": int(pages[0, 0])}
    return entry | {"pages": tables.slots.add_table(pages, "SCALAR")}
