"""Reads a baked .glb back: the scene, and the lightmap of its IRRADIA_lighting extension."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from irradia.bake.directional import DirectionalMaps
from irradia.core.errors import InputError
from irradia.export.direct_extension import read_direct
from irradia.export.directional_extension import read_directional
from irradia.export.lighting_extension import NAME, NO_PAGE, VERSION
from irradia.formats.ktx2 import decode_ktx2
from irradia.scene.gltf.accessors import Accessors
from irradia.scene.gltf.document import GltfDocument
from irradia.scene.gltf.view import JsonView
from irradia.scene.layout import LightmapLayout, Unwrap
from irradia.scene.load import LoadOptions, load_scene
from irradia.scene.types import F32, Instance, Primitive, Scene


@dataclass(frozen=True)
class BakedScene:
    """A scene with its finished lightmap.

    Attributes:
        pages: (P, H, W, 3) linear E/π.
        directional: Maps that say where the light comes from, or None.
        direct: (P, H, W, 3) the part of ``pages`` that baked punctual lights send straight, or None.
    """

    scene: Scene
    layout: LightmapLayout
    pages: NDArray[np.float32]
    directional: DirectionalMaps | None = None
    direct: NDArray[np.float32] | None = None


def read_baked(spec: str, options: LoadOptions | None = None) -> BakedScene:
    """Reads what :func:`~irradia.export.write_baked_glb` wrote.

    Raises:
        InputError: The file can't be read or holds no lightmap of ours.
    """
    scene = load_scene(spec, options)
    if scene.document is None or JsonView(scene.document.json).extension(NAME) is None:
        raise InputError(
            f"expected a lightmap inside ({NAME})", where=spec, fix="Make one with `irradia bake`."
        )
    document = scene.document
    accessors = Accessors(document)
    pages = _pages(document, accessors)
    rectangles = [_rectangle(document, accessors, scene, i) for i in range(len(scene.instances))]
    layout = LightmapLayout(
        n_pages=pages.shape[0],
        width_px=pages.shape[2],
        height_px=pages.shape[1],
        unwraps=tuple(_unwrap(document, accessors, scene, i) for i in range(len(scene.primitives))),
        page=np.array([r.page for r in rectangles], np.int32),
        scale=np.array([r.scale for r in rectangles], np.float32).reshape(-1, 2),
        offset=np.array([r.offset for r in rectangles], np.float32).reshape(-1, 2),
        texels_per_metre=0.0,
    )
    return BakedScene(scene, layout, pages, read_directional(document, accessors), read_direct(document))


@dataclass(frozen=True)
class _Rectangle:
    """Where an instance's uv lie."""

    page: int = -1
    scale: tuple[float, ...] = (1.0, 1.0)
    offset: tuple[float, ...] = (0.0, 0.0)


def _pages(document: GltfDocument, accessors: Accessors) -> NDArray[np.float32]:
    extension = JsonView(document.json).object("extensions").object(NAME)
    version = extension.integer("version")
    if version != VERSION:
        raise InputError(f"expected version {VERSION}, found {version}", where=f"{extension.pointer}/version")
    lightmap = extension.object("lightmap")
    data = bytes(accessors.read_view(lightmap.integer("bufferView")))
    return decode_ktx2(data, lightmap.pointer).pages * np.float32(lightmap.number("scale", 1.0))


def _entry(document: GltfDocument, instance: Instance, primitive: Primitive) -> JsonView | None:
    """What the extension says of one primitive of one node, or None where it takes no lightmap."""
    node = JsonView(document.json).element("nodes", instance.node_index)
    extension = node.extension(NAME)
    if extension is None or primitive.primitive_index >= extension.length("primitives"):
        return None
    entry = extension.element("primitives", primitive.primitive_index)
    return entry if entry.has("texCoord") else None


def _rectangle(document: GltfDocument, accessors: Accessors, scene: Scene, index: int) -> _Rectangle:
    instance = scene.instances[index]
    entry = _entry(document, instance, scene.primitives[instance.primitive])
    if entry is None:
        return _Rectangle()
    if not entry.has("scaleOffsets"):
        return _Rectangle(
            entry.integer("page"), entry.numbers("scale", (1.0, 1.0)), entry.numbers("offset", (0.0, 0.0))
        )
    row = _row(accessors.read(entry.integer("scaleOffsets")).floats(4), instance, entry)
    page = entry.integer("page", NO_PAGE)
    if entry.has("pages"):
        page = int(_row(accessors.read(entry.integer("pages")).indices(), instance, entry))
    return _Rectangle(-1 if page == NO_PAGE else page, tuple(row[:2]), tuple(row[2:]))


def _row(table: NDArray, instance: Instance, entry: JsonView) -> NDArray:
    number = instance.gpu_instance or 0
    if number >= len(table):
        raise InputError(f"expected a row for instance {number}, found {len(table)}", where=entry.pointer)
    return table[number]


def _unwrap(document: GltfDocument, accessors: Accessors, scene: Scene, index: int) -> Unwrap | None:
    """The primitive's stored uv, vertices as they are."""
    primitive = scene.primitives[index]
    users = [instance for instance in scene.instances if instance.primitive == index]
    entry = next((e for i in users if (e := _entry(document, i, primitive)) is not None), None)
    if entry is None:
        return None
    return Unwrap(
        vertex_source=np.arange(len(primitive.positions), dtype=np.uint32),
        indices=primitive.indices,
        uv=_texcoord(document, accessors, primitive, entry.integer("texCoord")),
        chart=np.zeros(len(primitive.indices), np.uint32),
    )


def _texcoord(document: GltfDocument, accessors: Accessors, primitive: Primitive, number: int) -> F32:
    """(V, 2) of the file's set ``number``, whatever order the importer gave the sets."""
    mesh = JsonView(document.json).element("meshes", primitive.mesh_index)
    stored = mesh.element("primitives", primitive.primitive_index).object("attributes")
    return accessors.read(stored.integer(f"TEXCOORD_{number}")).floats(2)[primitive.vertex_source]
