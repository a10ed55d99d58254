"""The node hierarchy: which nodes the scene shows, and where they stand in the world."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from irradia.core.errors import InputError
from irradia.scene.gltf.lods import Lod, place_levels, read_lods, walk
from irradia.scene.gltf.transforms import trs_matrix
from irradia.scene.gltf.view import JsonView
from irradia.scene.types import F64

_AFFINE_ROW = (0.0, 0.0, 0.0, 1.0)


@dataclass(frozen=True)
class NodePose:
    """What an animation sets of a node; None leaves what the node says.

    Attributes:
        rotation: Quaternion x, y, z, w.
        weights: Of the morph targets.
    """

    translation: tuple[float, ...] | None = None
    rotation: tuple[float, ...] | None = None
    scale: tuple[float, ...] | None = None
    weights: tuple[float, ...] | None = None


@dataclass(frozen=True)
class PlacedNode:
    """A node of the scene.

    Attributes:
        index: Its place in ``/nodes``.
        world_from_node: (4, 4).
        weights: Morph weights that the pose sets, or None.
        lod: The level of detail that it is part of, or None.
    """

    index: int
    view: JsonView
    world_from_node: F64
    weights: tuple[float, ...] | None = None
    lod: Lod | None = None

    @property
    def name(self) -> str:
        """The node's name, or its number."""
        return self.view.string("name") or f"node {self.index}"


@dataclass(frozen=True)
class Hierarchy:
    """All nodes of the file.

    Attributes:
        scene: The nodes that the default scene shows, parents before children, all levels of detail
            among them.
        world_from_node: By node index, for nodes outside the scene too (a skin's joints may be).
    """

    scene: list[PlacedNode]
    world_from_node: list[F64]


def read_hierarchy(root: JsonView, pose: Mapping[int, NodePose]) -> Hierarchy:
    """Places every node.

    Args:
        root: The document.
        pose: What animations set, by node index.

    Raises:
        InputError: A node has two parents, is its own ancestor, or a child doesn't exist.
    """
    nodes = root.items("nodes")
    children = [_indices(node, "children", len(nodes)) for node in nodes]
    roots = _roots(nodes, children)
    lods = read_lods(nodes)
    listed = _scene_roots(root, len(nodes))
    children, roots, scene_roots = place_levels(lods, children, roots, listed or [])
    world: list[F64 | None] = [None] * len(nodes)
    stack = [(index, np.eye(4)) for index in roots]
    while stack:
        index, world_from_parent = stack.pop()
        world_from_node = world_from_parent @ _parent_from_node(nodes[index], pose.get(index, NodePose()))
        world[index] = world_from_node
        stack.extend((child, world_from_node) for child in children[index])
    placed = [matrix for matrix in world if matrix is not None]
    if len(placed) < len(nodes):
        cyclic = next(i for i, matrix in enumerate(world) if matrix is None)
        raise InputError("this node is its own ancestor", where=nodes[cyclic].pointer)
    shown = walk(roots if listed is None else scene_roots, children, lods)
    scene = [PlacedNode(i, nodes[i], placed[i], pose.get(i, NodePose()).weights, lod) for i, lod in shown]
    return Hierarchy(scene, placed)


def _roots(nodes: list[JsonView], children: list[list[int]]) -> list[int]:
    parent: dict[int, int] = {}
    for index, its_children in enumerate(children):
        for child in its_children:
            if child in parent:
                raise InputError(
                    f"both node {parent[child]} and node {index} have this child", where=nodes[child].pointer
                )
            parent[child] = index
    return [index for index in range(len(nodes)) if index not in parent]


def _scene_roots(root: JsonView, n_nodes: int) -> list[int] | None:
    """The default scene's nodes, or the first scene's where none is the default; None without scenes."""
    scenes = root.items("scenes")
    chosen = root.index("scene", len(scenes))
    return _indices(scenes[chosen or 0], "nodes", n_nodes) if scenes else None


def _indices(view: JsonView, key: str, count: int) -> list[int]:
    """An array of node indices, each below ``count``."""
    found = []
    for element in view.items(key):
        value = element.value
        if isinstance(value, bool) or not isinstance(value, int) or not 0 <= value < count:
            raise InputError(f"expected an index below {count}, found {value!r}", where=element.pointer)
        found.append(value)
    return found


def _parent_from_node(node: JsonView, pose: NodePose) -> F64:
    moved = pose.translation or pose.rotation or pose.scale
    if node.has("matrix") and not moved:
        matrix = np.array(node.numbers("matrix", (0.0,) * 16)).reshape(4, 4).T
        if not np.allclose(matrix[3], _AFFINE_ROW, atol=1e-6):
            raise InputError(
                "expected an affine matrix (last row 0, 0, 0, 1)", where=f"{node.pointer}/matrix"
            )
        matrix[3] = _AFFINE_ROW
        return matrix
    translation = pose.translation or node.numbers("translation", (0.0, 0.0, 0.0))
    rotation = pose.rotation or node.numbers("rotation", (0.0, 0.0, 0.0, 1.0))
    scale = pose.scale or node.numbers("scale", (1.0, 1.0, 1.0))
    return trs_matrix(np.array(translation), np.array(rotation), np.array(scale))
