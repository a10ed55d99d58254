"""From a document to the scene that is baked."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from irradia.core.errors import InputError
from irradia.scene.gltf.accessors import Accessors
from irradia.scene.gltf.animation import sample_animations
from irradia.scene.gltf.cameras import read_cameras
from irradia.scene.gltf.document import GltfDocument
from irradia.scene.gltf.extensions import check_extensions
from irradia.scene.gltf.instancing import read_gpu_instances
from irradia.scene.gltf.lights import read_lights
from irradia.scene.gltf.material_table import MaterialTable
from irradia.scene.gltf.nodes import Hierarchy, NodePose, PlacedNode, read_hierarchy
from irradia.scene.gltf.notes import ImportNotes
from irradia.scene.gltf.object_settings import read_object_settings
from irradia.scene.gltf.primitives import make_primitive
from irradia.scene.gltf.skins import PosedSkin, pose_skin
from irradia.scene.gltf.stored import StoredPrimitive, read_stored_primitive
from irradia.scene.gltf.textures import Textures
from irradia.scene.gltf.topology import foreign_topology
from irradia.scene.gltf.view import JsonView
from irradia.scene.types import F64, Instance, Primitive, Scene


def document_to_scene(
    document: GltfDocument, *, pose_time: float | None = None, variant: str | None = None
) -> Scene:
    """Decodes and poses the default scene of ``document``.

    Args:
        document: What :func:`irradia.scene.gltf.read_document` returns.
        pose_time: Seconds into the animations at which the scene is posed; None takes the rest pose.
        variant: Name of a KHR_materials_variants variant; None takes each primitive's own material.

    Returns:
        The scene; its notes say what was left out.

    Raises:
        InputError: Something is malformed, requires an extension that isn't read, or there is no
            triangle to bake; ``where`` is a JSON pointer.
    """
    root = JsonView(document.json)
    notes = ImportNotes()
    check_extensions(root, notes)
    accessors = Accessors(document)
    hierarchy = read_hierarchy(root, _pose(root, accessors, pose_time, notes))
    textures = Textures(document)
    geometry = _Geometry(root, accessors, hierarchy, MaterialTable(root, textures, variant, notes), notes)
    for node in hierarchy.scene:
        geometry.add(node)
    finest = [node for node in hierarchy.scene if node.lod is None or node.lod.level == 0]
    if len(finest) < len(hierarchy.scene):
        notes.add("levels of detail (MSFT_lod): each has a lightmap, others are lit by the finest alone")
    if not geometry.instances:
        raise InputError(
            "this scene has no triangles to bake",
            where=document.name,
            fix=". ".join(("Check that the default scene shows a mesh of triangles", *notes.lines())),
        )
    return Scene(
        name=document.name,
        primitives=tuple(geometry.primitives),
        instances=tuple(geometry.instances),
        materials=geometry.materials.materials,
        images=textures.images,
        lights=read_lights(document, finest, notes),
        cameras=read_cameras(root, finest, notes),
        notes=notes.lines(),
        document=document,
    )


def _pose(
    root: JsonView, accessors: Accessors, pose_time: float | None, notes: ImportNotes
) -> dict[int, NodePose]:
    if pose_time is not None:
        return dict(sample_animations(root, accessors, pose_time, notes))
    if root.items("animations"):
        notes.add("this file is animated: its rest pose is taken; --pose-time takes another")
    return {}


class _Geometry:
    """Collects primitives and their instances, node by node; meshes in one pose are shared."""

    def __init__(
        self,
        root: JsonView,
        accessors: Accessors,
        hierarchy: Hierarchy,
        materials: MaterialTable,
        notes: ImportNotes,
    ) -> None:
        self.primitives: list[Primitive] = []
        self.instances: list[Instance] = []
        self.materials = materials
        self._root = root
        self._accessors = accessors
        self._hierarchy = hierarchy
        self._notes = notes
        self._stored: dict[tuple[int, int], StoredPrimitive] = {}
        self._made: dict[tuple, int | None] = {}
        self._skins: dict[int, PosedSkin] = {}

    def add(self, node: PlacedNode) -> None:
        """Adds the mesh of ``node``, if it has one."""
        mesh_index = node.view.index("mesh", self._root.length("meshes"))
        if mesh_index is None:
            return
        mesh = self._root.element("meshes", mesh_index)
        skin_index = node.view.index("skin", self._root.length("skins"))
        weights = node.weights or _weights(node.view) or _weights(mesh)
        placements = self._placements(node, skin_index)
        for primitive_index, view in enumerate(mesh.items("primitives")):
            key = (mesh_index, primitive_index, weights, skin_index)
            if key not in self._made:
                self._made[key] = self._make(view, key, mesh.string("name") or f"mesh {mesh_index}")
            primitive = self._made[key]
            if primitive is not None:
                self._place(node, primitive, placements)

    def _placements(self, node: PlacedNode, skin_index: int | None) -> list[tuple[int | None, F64]]:
        """Number and place of each instance of a node's mesh that has a size."""
        node_from_instance = read_gpu_instances(node.view, self._accessors)
        if skin_index is not None:
            if node_from_instance is not None:
                self._notes.tally(
                    "skinned meshes are taken once in spite of GPU instancing", node.view.pointer
                )
            return [(None, np.eye(4))]
        if node_from_instance is None:
            placements = [(None, node.world_from_node)]
        else:
            placements = [(i, node.world_from_node @ m) for i, m in enumerate(node_from_instance)]
        if not all(np.isfinite(world).all() for _, world in placements):
            raise InputError("this node's transform in the world is not finite", where=node.view.pointer)
        visible = [(i, world) for i, world in placements if _spans_a_plane(world)]
        if len(visible) < len(placements):
            self._notes.tally(
                "instances scaled to a line or point left out",
                node.view.pointer,
                len(placements) - len(visible),
            )
        return visible

    def _place(self, node: PlacedNode, primitive: int, placements: list[tuple[int | None, F64]]) -> None:
        settings = read_object_settings(node.view, self._notes)
        for gpu_instance, world_from_object in placements:
            self.instances.append(
                Instance(
                    primitive,
                    world_from_object,
                    node.index,
                    gpu_instance,
                    lightmap_scale=settings.lightmap_scale,
                    casts=settings.casts,
                    lod_group=node.lod.group if node.lod else None,
                    lod_level=node.lod.level if node.lod else 0,
                    name=node.name,
                )
            )

    def _make(self, view: JsonView, key: tuple, name: str) -> int | None:
        """Index of a new primitive, or None where it has no triangles."""
        mesh_index, primitive_index, weights, skin_index = key
        foreign = foreign_topology(view.integer("mode", 4))
        if foreign is not None:
            self._notes.tally(f"primitives of {foreign} left out", view.pointer)
            return None
        stored = self._read(view, mesh_index, primitive_index)
        skin = None if skin_index is None else self._skin(skin_index)
        primitive, n_without_area = make_primitive(
            stored, weights, skin, mesh_index=mesh_index, primitive_index=primitive_index, name=name
        )
        if n_without_area:
            self._notes.tally("triangles without area dropped", view.pointer, n_without_area)
        if not len(primitive.indices):
            return None
        material, order = self.materials.choose(view, len(primitive.texcoords))
        texcoords = tuple(primitive.texcoords[i] for i in order)
        self.primitives.append(replace(primitive, material=material, texcoords=texcoords))
        return len(self.primitives) - 1

    def _read(self, view: JsonView, mesh_index: int, primitive_index: int) -> StoredPrimitive:
        key = (mesh_index, primitive_index)
        if key not in self._stored:
            self._stored[key] = read_stored_primitive(self._accessors, view)
        return self._stored[key]

    def _skin(self, index: int) -> PosedSkin:
        if index not in self._skins:
            view = self._root.element("skins", index)
            self._skins[index] = pose_skin(view, self._accessors, self._hierarchy.world_from_node)
        return self._skins[index]


def _weights(view: JsonView) -> tuple[float, ...]:
    return view.numbers("weights", (0.0,) * len(view.items("weights")))


def _spans_a_plane(world_from_object: F64) -> bool:
    """Whether at least two axes keep a length: a scale of 0 hides things, one flat axis doesn't."""
    lengths = np.linalg.svd(world_from_object[:3, :3], compute_uv=False)
    return bool(lengths[1] > 1e-9 * lengths[0])
