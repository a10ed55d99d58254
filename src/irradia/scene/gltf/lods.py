"""MSFT_lod: nodes that show one object in several levels of detail.

The file lists the lower levels in the finest one's extension and, as a rule, nowhere else. Each
stands, with all that is below it, where the finest stands: under the same parent, by its own
transform.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

from irradia.core.errors import InputError
from irradia.scene.gltf.view import JsonView

MAX_LEVELS = 256
_EXTENSION = "MSFT_lod"


@dataclass(frozen=True)
class Lod:
    """Which level of which object a node shows.

    Attributes:
        group: The object.
        level: 0 is the finest.
    """

    group: int
    level: int


def read_lods(nodes: Sequence[JsonView]) -> dict[int, Lod]:
    """The levels' topmost nodes, the finest included.

    Raises:
        InputError: A level doesn't exist, or belongs to two objects.
    """
    found: dict[int, Lod] = {}
    group = 0
    for index, node in enumerate(nodes):
        levels = list(_levels(node, index, len(nodes)))
        if len(levels) < 2:
            continue
        for level, (member, pointer) in enumerate(levels):
            if member in found:
                raise InputError(f"node {member} is a level of detail of an object already", where=pointer)
            found[member] = Lod(group, level)
        group += 1
    return found


def place_levels(
    lods: Mapping[int, Lod], children: list[list[int]], roots: Sequence[int], scene_roots: Sequence[int]
) -> tuple[list[list[int]], list[int], list[int]]:
    """The hierarchy with the lower levels beside the finest one, where they stand nowhere yet.

    Args:
        lods: From :func:`read_lods`.
        children: Of each node.
        roots: Nodes without a parent.
        scene_roots: Those that the scene shows.

    Returns:
        Children, roots and the scene's roots.
    """
    parent_of = {child: parent for parent, members in enumerate(children) for child in members}
    finest = {lod.group: node for node, lod in lods.items() if lod.level == 0}
    children, roots, scene_roots = [list(c) for c in children], list(roots), list(scene_roots)
    for node, lod in lods.items():
        if lod.level == 0 or node in parent_of or node in scene_roots:
            continue
        beside = finest[lod.group]
        if beside in parent_of:
            children[parent_of[beside]].append(node)
            roots.remove(node)
        elif beside in scene_roots:
            scene_roots.append(node)
    return children, roots, scene_roots


def walk(
    scene_roots: Sequence[int], children: Sequence[Sequence[int]], lods: Mapping[int, Lod]
) -> Iterator[tuple[int, Lod | None]]:
    """Each node that the scene shows, parents before children, with the level that it is part of.

    An object inside another one's level is part of that: its own lower levels are left out.
    """
    seen: set[int] = set()
    stack: list[tuple[int, Lod | None]] = [(root, None) for root in reversed(scene_roots)]
    while stack:
        node, inherited = stack.pop()
        own = lods.get(node)
        nested = own is not None and inherited is not None and own.group != inherited.group
        if node in seen or (nested and own is not None and own.level > 0):
            continue
        seen.add(node)
        part_of = inherited if own is None or nested else own
        yield node, part_of
        stack.extend((child, part_of) for child in reversed(children[node]))


def _levels(node: JsonView, index: int, n_nodes: int) -> Iterator[tuple[int, str]]:
    """A node and its lower levels, each with the pointer to where it is named."""
    yield index, node.pointer
    extension = node.extension(_EXTENSION)
    for element in extension.items("ids") if extension else []:
        value = element.value
        if isinstance(value, bool) or not isinstance(value, int) or not 0 <= value < n_nodes:
            raise InputError(f"expected an index below {n_nodes}, found {value!r}", where=element.pointer)
        yield value, element.pointer
    if extension and extension.length("ids") >= MAX_LEVELS:
        raise InputError(f"expected fewer than {MAX_LEVELS} levels", where=extension.pointer)
