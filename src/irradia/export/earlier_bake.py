"""What an earlier bake left in a document that is baked again."""

from __future__ import annotations

from irradia.export.lighting_extension import NAME
from irradia.export.primitives import MOZ_LIGHTMAP
from irradia.scene.gltf.document import Json


def remove_earlier_bake(json: Json) -> list[int]:
    """Takes bindings and MOZ_lightmap out of ``json``, which is changed; ``bakedLight`` stays.

    Returns:
        Textures that were lightmaps, in order: new pages take their places, since nothing may be
        renumbered.
    """
    json.get("extensions", {}).pop(NAME, None)
    for node in json.get("nodes", []):
        node.get("extensions", {}).get(NAME, {}).pop("primitives", None)
    textures = set()
    for material in json.get("materials", []):
        lightmap = material.get("extensions", {}).pop(MOZ_LIGHTMAP, None)
        if lightmap is not None:
            textures.add(lightmap["index"])
    for holder in (json, *json.get("nodes", []), *json.get("materials", [])):
        _drop_empty(holder)
    return sorted(textures)


def _drop_empty(holder: Json) -> None:
    extensions = {k: v for k, v in holder.get("extensions", {}).items() if v or k != NAME}
    if extensions:
        holder["extensions"] = extensions
    else:
        holder.pop("extensions", None)
