"""``scene.baked.glb``: the scene as it came, with its lightmap inside."""

from __future__ import annotations

import copy
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

import irradia
from irradia.bake.directional import DirectionalMaps
from irradia.core.errors import InternalError
from irradia.core.files import write_atomic
from irradia.export import lighting_extension
from irradia.export.bindings import bind_nodes
from irradia.export.container import glb_container
from irradia.export.direct_extension import add_direct
from irradia.export.directional_extension import add_directional
from irradia.export.earlier_bake import remove_earlier_bake
from irradia.export.field_extension import add_field
from irradia.export.instances import GPU_INSTANCING, write_out_gpu_instances
from irradia.export.lighting_extension import InstanceTables, bind_node
from irradia.export.meshes import MeshVersions, freed_accessors, freed_materials, primitive_texcoord
from irradia.export.moz_lightmap import MozLightmaps
from irradia.export.occlusion_materials import OcclusionMaterials
from irradia.export.primitives import DRACO, MOZ_LIGHTMAP, PrimitiveWriter
from irradia.export.probes_extension import add_probes
from irradia.export.shadow_mask_extension import BakedShadows, add_shadow_mask, live_nodes
from irradia.export.slots import Slots
from irradia.export.validity_extension import add_validity
from irradia.formats.ktx2 import Encoding
from irradia.formats.probes import ProbeSet
from irradia.scene.gltf.accessors import Accessors
from irradia.scene.gltf.document import GltfDocument, Json
from irradia.scene.layout import LightmapLayout
from irradia.scene.types import Scene

_COMPRESSION = (DRACO, "EXT_meshopt_compression", "KHR_meshopt_compression")
_SIGNATURES = ((b"\x89PNG", "image/png"), (b"\xff\xd8", "image/jpeg"), (b"RIFF", "image/webp"))


@dataclass(frozen=True)
class Companions:
    """What goes into the document beside the lightmap.

    Attributes:
        directional: Maps that say where the light comes from.
        direct: (P, H, W, 3) E/π: the part of the lightmap that fields of indirect light lack.
        shadows: What arrives of the lights that shine live.
        probes: Light where nothing is baked.
        field: The file of a neural field.
        validity: (P, H, W) of :func:`~irradia.export.validity_extension.code_validity`, 0 outside charts.
    """

    directional: DirectionalMaps | None = None
    direct: NDArray[np.float32] | None = None
    shadows: BakedShadows | None = None
    probes: ProbeSet | None = None
    field: bytes | None = None
    validity: NDArray[np.uint8] | None = None


def write_baked_glb(
    path: Path | str,
    scene: Scene,
    layout: LightmapLayout,
    pages_irradiance_over_pi: NDArray[np.float32],
    companions: Companions | None = None,
    *,
    compatible: bool = False,
    encoding: Encoding = "rgb9e5",
) -> None:
    """Writes the scene's document with its lightmap, whole or not at all.

    Everything that the bake didn't touch keeps its meaning and its index. Vertices are split where
    the unwrap needs it, morph targets, joints and weights with them. Mesh compression is undone,
    images stay as encoded. Baked punctual lights move into our extension: their light is in the map.

    Args:
        path: The .glb.
        scene: As imported; its ``document`` is what is written.
        layout: Where charts lie.
        pages_irradiance_over_pi: (P, H, W, 3) linear E/π, dilated.
        companions: What goes with the map.
        compatible: Writes meshes with several instances out, one mesh and node each, so that loaders
            of MOZ_lightmap light them too. Otherwise such meshes stay shared, and only readers of
            IRRADIA_lighting light them.
        encoding: Of the HDR map.
    """
    pages = pages_irradiance_over_pi
    data = baked_glb(scene, layout, pages, companions, compatible=compatible, encoding=encoding)
    with write_atomic(path) as stream:
        stream.write(data)


def baked_glb(
    scene: Scene,
    layout: LightmapLayout,
    pages: NDArray[np.float32],
    companions: Companions | None = None,
    *,
    compatible: bool = False,
    encoding: Encoding = "rgb9e5",
) -> bytes:
    """The bytes of :func:`write_baked_glb`."""
    if scene.document is None:
        raise InternalError("the scene to export has no document")
    export = _Export(scene, scene.document, layout, pages, compatible)
    binary = export.run(encoding, companions or Companions())
    return glb_container(export.json, binary)


def write_occlusion_glb(
    path: Path | str, scene: Scene, layout: LightmapLayout, openness: NDArray[np.float32]
) -> None:
    """Writes the scene's document with ambient occlusion in its materials, whole or not at all.

    Lights stay where they are. Meshes with several instances are written out, since a material binds
    a texture, not a part of it.

    Args:
        path: The .glb.
        scene: As imported.
        layout: Where charts lie.
        openness: (P, H, W, 3) in [0, 1], three times the same.
    """
    if scene.document is None:
        raise InternalError("the scene to export has no document")
    export = _Export(scene, scene.document, layout, openness, compatible=True, materials=OcclusionMaterials)
    binary = export.run_without_light()
    with write_atomic(path) as stream:
        stream.write(glb_container(export.json, binary))


class _Export:
    """One document on its way out: ``json`` is the copy that is changed."""

    def __init__(
        self,
        scene: Scene,
        document: GltfDocument,
        layout: LightmapLayout,
        pages: NDArray[np.float32],
        compatible: bool,
        materials: type[MozLightmaps] | type[OcclusionMaterials] = MozLightmaps,
    ) -> None:
        self.json: Json = copy.deepcopy(document.json)
        self._scene = scene
        self._layout = layout
        self._pages = pages
        self._document = document
        self._accessors = Accessors(document)
        nodes = (
            write_out_gpu_instances(self.json, scene, self._accessors)
            if compatible
            else [instance.node_index for instance in scene.instances]
        )
        self._bound = bind_nodes(scene, layout, nodes, write_out=compatible)
        free = freed_accessors(self.json, self._bound)
        self._slots = Slots(self.json, self._accessors, free)
        self._materials = materials(
            self.json,
            self._slots,
            pages,
            free_materials=freed_materials(self.json, self._bound),
            free_textures=remove_earlier_bake(self.json),
        )

    def run(self, encoding: Encoding, companions: Companions) -> bytes:
        """Changes the JSON and returns the binary chunk."""
        self._bind_nodes()
        writer = PrimitiveWriter(self._document, self._accessors, self._slots)
        MeshVersions(self.json, self._scene, self._layout, writer, self._materials).write(self._bound)
        used = {MOZ_LIGHTMAP} if self._materials.used else set()
        if self._bound:
            lighting_extension.move_baked_lights(self.json, live_nodes(self._scene.lights))
            light = lighting_extension.light_in_map(self._scene.lights)
            lighting_extension.add_lightmap(self.json, self._slots, self._pages, encoding, light)
            self._add(companions, encoding)
            used.add(lighting_extension.NAME)
        return self._finish(used)

    def _add(self, companions: Companions, encoding: Encoding) -> None:
        """Adds what goes with the lightmap."""
        if companions.directional is not None:
            add_directional(self.json, self._slots, companions.directional, encoding)
        if companions.direct is not None:
            add_direct(self.json, self._slots, companions.direct, encoding)
        add_shadow_mask(self.json, self._slots, self._scene.lights, companions.shadows)
        if companions.probes is not None:
            add_probes(self.json, self._slots, companions.probes)
        if companions.field is not None:
            add_field(self.json, self._slots, companions.field)
        if companions.validity is not None:
            add_validity(self.json, self._slots, companions.validity)

    def run_without_light(self) -> bytes:
        """Like :meth:`run`, with the pages in materials alone and all lights on their nodes."""
        writer = PrimitiveWriter(self._document, self._accessors, self._slots)
        MeshVersions(self.json, self._scene, self._layout, writer, self._materials).write(self._bound)
        lighting_extension.move_baked_lights(self.json, live=range(len(self.json.get("nodes", []))))
        return self._finish(set())

    def _finish(self, extensions: set[str]) -> bytes:
        self._embed_images()
        self._list_extensions(extensions)
        self.json["asset"]["generator"] = f"Irradia {irradia.__version__}"
        return self._slots.finish()

    def _bind_nodes(self) -> None:
        """Writes into nodes what their primitives read; meshes must still be the original ones."""
        number = [instance.gpu_instance or 0 for instance in self._scene.instances]
        for node_index, bindings in self._bound.items():
            node = self.json["nodes"][node_index]
            primitives = self.json["meshes"][node["mesh"]]["primitives"]
            texcoords = {index: primitive_texcoord(self.json, primitives[index]) for index in bindings}
            instancing = node.get("extensions", {}).get(GPU_INSTANCING)
            tables = None
            if instancing is not None:
                count = len(self._accessors.read(next(iter(instancing["attributes"].values()))))
                tables = InstanceTables(self._slots, count, number)
            bind_node(node, bindings, texcoords, len(primitives), self._layout, tables)

    def _embed_images(self) -> None:
        for image, data in zip(self.json.get("images", []), self._document.images, strict=False):
            if "uri" in image:
                del image["uri"]
                image.setdefault("mimeType", _mime_type(data))
                self._slots.add_blob(data, lambda view, image=image: image.update(bufferView=view))

    def _list_extensions(self, added: set[str]) -> None:
        """Adds ours and removes those that nothing uses any more."""
        gone = {*_COMPRESSION, MOZ_LIGHTMAP, lighting_extension.NAME} - added
        if GPU_INSTANCING not in _node_extensions(self.json):
            gone.add(GPU_INSTANCING)
        for key, extra in (("extensionsUsed", added), ("extensionsRequired", set())):
            names = [name for name in self.json.get(key, []) if name not in gone]
            names += sorted(extra - set(names))
            self.json.pop(key, None)
            if names:
                self.json[key] = names


def _node_extensions(json: Json) -> set[str]:
    return {name for node in json.get("nodes", []) for name in node.get("extensions", {})}


def _mime_type(data: bytes) -> str:
    return next((kind for magic, kind in _SIGNATURES if data.startswith(magic)), "application/octet-stream")
