"""Which glTF extensions Irradia reads, and what happens with the others."""

from __future__ import annotations

from irradia.core.errors import InputError
from irradia.scene.gltf.notes import ImportNotes
from irradia.scene.gltf.view import JsonView

READ = frozenset(
    {
        "EXT_lights_ies",
        "EXT_mesh_gpu_instancing",
        "EXT_meshopt_compression",
        "EXT_texture_webp",
        "IRRADIA_lighting",
        "KHR_draco_mesh_compression",
        "KHR_lights_punctual",
        "KHR_materials_diffuse_transmission",
        "KHR_materials_emissive_strength",
        "KHR_materials_ior",
        "KHR_materials_pbrSpecularGlossiness",
        "KHR_materials_specular",
        "KHR_materials_transmission",
        "KHR_materials_unlit",
        "KHR_materials_variants",
        "KHR_mesh_quantization",
        "KHR_meshopt_compression",
        "KHR_texture_transform",
        "MSFT_lod",
    }
)
"""Extensions whose data the import understands."""

_REMOVED_BY = {
    "EXT_texture_avif": "npx @gltf-transform/cli png in.glb out.glb",
    "KHR_texture_basisu": "npx @gltf-transform/cli ktxdecompress in.glb out.glb",
}
# Metadata, and the maps of an earlier bake: nothing that light could see.
_SILENT = frozenset({"KHR_xmp_json_ld", "MOZ_lightmap"})


def check_extensions(root: JsonView, notes: ImportNotes) -> None:
    """Refuses required extensions that aren't read, and notes the optional ones.

    Raises:
        InputError: A required extension isn't read; it names the public tool that removes it.
    """
    required = _names(root, "extensionsRequired")
    for index, name in enumerate(required):
        if name not in READ:
            raise InputError(
                f"this file requires {name}, which Irradia doesn't read",
                where=f"/extensionsRequired/{index}",
                fix=_way_out(name),
            )
    for name in _names(root, "extensionsUsed"):
        if name not in READ and name not in _SILENT:
            notes.add(f"{name} is optional here and not read: the bake goes without it")


def _names(root: JsonView, key: str) -> list[str]:
    names = [view.value for view in root.items(key)]
    if not all(isinstance(name, str) for name in names):
        raise InputError("expected the names of extensions", where=f"/{key}")
    return names


def _way_out(name: str) -> str:
    if name in _REMOVED_BY:
        return f"Remove it with: {_REMOVED_BY[name]}"
    return "Export the scene without it; what uses it is listed by: npx @gltf-transform/cli inspect in.glb"
