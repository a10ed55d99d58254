"""Versions of meshes: one for all nodes that read the lightmap in the same way."""

from __future__ import annotations

from collections.abc import Iterator

from irradia.core.errors import InternalError
from irradia.export.bindings import Binding, NodeBindings, page_uv
from irradia.export.instances import GPU_INSTANCING
from irradia.export.page_materials import PageMaterials
from irradia.export.primitives import DRACO, PrimitiveWriter, accessors_of, lightmap_texcoord
from irradia.scene.gltf.document import Json
from irradia.scene.layout import LightmapLayout
from irradia.scene.types import Scene

_VARIANTS = "KHR_materials_variants"


class MeshVersions:
    """Rewrites the meshes of ``json``, which is changed.

    Args:
        json: The document being written.
        scene: As it was baked.
        layout: As it was baked.
        writer: Writes split primitives.
        materials: Makes those that read a page.
    """

    def __init__(
        self,
        json: Json,
        scene: Scene,
        layout: LightmapLayout,
        writer: PrimitiveWriter,
        materials: PageMaterials,
    ) -> None:
        self._json = json
        self._scene = scene
        self._layout = layout
        self._writer = writer
        self._materials = materials

    def write(self, bound: dict[int, NodeBindings]) -> None:
        """Gives each node the version that its bindings need; one of them keeps the mesh's index."""
        meshes: list[Json] = self._json.get("meshes", [])
        users = mesh_users(self._json)
        for mesh_index, original in list(enumerate(meshes)):
            versions: dict[tuple, int] = {}
            # Nodes without lightmap come first, so that the mesh they share stays in place.
            nodes = sorted(users.get(mesh_index, []), key=lambda node: node in bound)
            for node in nodes:
                bindings = bound.get(node, {})
                key = tuple(sorted((k, binding.mesh_key) for k, binding in bindings.items()))
                if key not in versions:
                    version = self._version(mesh_index, original, bindings)
                    versions[key] = _place(meshes, mesh_index, version, first=not versions)
                self._json["nodes"][node]["mesh"] = versions[key]
            if not nodes:
                meshes[mesh_index] = self._version(mesh_index, original, {})

    def _version(self, mesh_index: int, original: Json, bindings: NodeBindings) -> Json:
        primitives = []
        for index, primitive in enumerate(original["primitives"]):
            if index in bindings:
                primitives.append(self._lit(primitive, bindings[index]))
            elif is_draco(primitive):
                primitives.append(self._writer.unpacked(mesh_index, index))
            else:
                primitives.append(primitive)
        return original | {"primitives": primitives}

    def _lit(self, original: Json, binding: Binding) -> Json:
        unwrap = self._layout.unwraps[binding.primitive]
        if unwrap is None:
            raise InternalError(f"primitive {binding.primitive} is bound but not unwrapped")
        texcoord = primitive_texcoord(self._json, original)
        primitive = self._scene.primitives[binding.primitive]
        uv = page_uv(self._layout, binding)
        lit = self._writer.lit(primitive, binding.primitive, unwrap, uv, texcoord)
        return self._with_page(lit, binding, texcoord) if binding.final else lit

    def _with_page(self, primitive: Json, binding: Binding, texcoord: int) -> Json:
        """The primitive with its material, and those of its variants, reading the page."""
        page = int(self._layout.page[binding.instances[0]])
        lit: Json = {
            **primitive,
            "material": self._materials.material(primitive.get("material"), page, texcoord),
        }
        variants = lit.get("extensions", {}).get(_VARIANTS)
        if variants is not None:
            mappings = [
                {**mapping, "material": self._materials.material(mapping["material"], page, texcoord)}
                for mapping in variants["mappings"]
            ]
            lit["extensions"] = {**lit["extensions"], _VARIANTS: {**variants, "mappings": mappings}}
        return lit


def mesh_users(json: Json) -> dict[int, list[int]]:
    """The nodes that show each mesh."""
    users: dict[int, list[int]] = {}
    for node_index, node in enumerate(json.get("nodes", [])):
        if "mesh" in node:
            users.setdefault(node["mesh"], []).append(node_index)
    return users


def is_draco(primitive: Json) -> bool:
    """Whether a primitive's data is Draco-compressed."""
    return DRACO in primitive.get("extensions", {})


def primitive_texcoord(json: Json, primitive: Json) -> int:
    """The set for the lightmap: one that no material of the primitive's reads."""
    materials = json.get("materials", [])
    return lightmap_texcoord([materials[index] for index in materials_of(primitive)])


def materials_of(primitive: Json) -> list[int]:
    """A primitive's material and those that variants give it."""
    mappings = primitive.get("extensions", {}).get(_VARIANTS, {}).get("mappings", [])
    own = [primitive["material"]] if "material" in primitive else []
    return own + [mapping["material"] for mapping in mappings]


def freed_accessors(json: Json, bound: dict[int, NodeBindings]) -> set[int]:
    """Accessors of primitives that are only shown rewritten, unless something else reads them too."""
    rewritten: set[int] = set()
    kept: set[int] = _accessors_outside_meshes(json)
    for primitive, bindings in _uses(json, bound):
        anew = is_draco(primitive) or all(bindings)
        (rewritten if anew else kept).update(accessors_of(primitive))
    return rewritten - kept


def freed_materials(json: Json, bound: dict[int, NodeBindings]) -> set[int]:
    """Materials that only primitives with page uv use, so that the originals needn't stay."""
    kept: set[int] = set()
    for primitive, bindings in _uses(json, bound):
        if not all(binding is not None and binding.final for binding in bindings):
            kept.update(materials_of(primitive))
    return set(range(len(json.get("materials", [])))) - kept


def _uses(json: Json, bound: dict[int, NodeBindings]) -> Iterator[tuple[Json, list[Binding | None]]]:
    """Each primitive with its binding in every node that shows it; one None where no node does."""
    users = mesh_users(json)
    for mesh_index, mesh in enumerate(json.get("meshes", [])):
        nodes = users.get(mesh_index, [])
        for index, primitive in enumerate(mesh["primitives"]):
            yield primitive, [bound.get(node, {}).get(index) for node in nodes] or [None]


def _accessors_outside_meshes(json: Json) -> set[int]:
    """Accessors of animations, skins and GPU instancing."""
    found = {skin["inverseBindMatrices"] for skin in json.get("skins", []) if "inverseBindMatrices" in skin}
    for animation in json.get("animations", []):
        for sampler in animation["samplers"]:
            found.update((sampler["input"], sampler["output"]))
    for node in json.get("nodes", []):
        found.update(node.get("extensions", {}).get(GPU_INSTANCING, {}).get("attributes", {}).values())
    return found


def _place(meshes: list[Json], index: int, version: Json, *, first: bool) -> int:
    if first:
        meshes[index] = version
        return index
    meshes.append(version)
    return len(meshes) - 1
