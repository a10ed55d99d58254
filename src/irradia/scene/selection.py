"""Choosing objects by name: ``--only``."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from fnmatch import fnmatchcase

import numpy as np
from numpy.typing import NDArray

from irradia.core.errors import InputError
from irradia.core.names import did_you_mean
from irradia.scene.types import Scene


def select_instances(scene: Scene, names: Sequence[str], *, where: str = "--only") -> NDArray[np.bool_]:
    """Which instances bear one of the names.

    A name is that of the object's node, of its mesh, or of a node above it; ``*``, ``?`` and
    ``[…]`` stand for other characters.

    Args:
        scene: The scene.
        names: At least one.
        where: What an error names.

    Returns:
        (I,) by instance.

    Raises:
        InputError: Nothing bears a name; the nearest one is suggested.
    """
    borne = _names_by_instance(scene)
    known = set().union(*borne)
    chosen = np.zeros(len(borne), np.bool_)
    for name in names:
        matching = matching_names(name, known)
        if not matching:
            raise InputError(f"no object is called {name!r}", where=where, fix=did_you_mean(name, known))
        chosen |= np.array([not matching.isdisjoint(its_names) for its_names in borne], np.bool_)
    return chosen


def matching_names(pattern: str, known: Iterable[str]) -> set[str]:
    """The names that are ``pattern``; or, where none is, that match it with ``*``, ``?`` and ``[…]``."""
    known = set(known)
    return {pattern} if pattern in known else {name for name in known if fnmatchcase(name, pattern)}


def _names_by_instance(scene: Scene) -> list[set[str]]:
    above = _names_above(scene)
    return [
        {instance.name, scene.primitives[instance.primitive].name, *above.get(instance.node_index, ())} - {""}
        for instance in scene.instances
    ]


def _names_above(scene: Scene) -> dict[int, set[str]]:
    """The names of a node's ancestors, by node; the import has made sure that the nodes form trees."""
    nodes = scene.document.json.get("nodes", []) if scene.document else []
    parent_of = {child: parent for parent, node in enumerate(nodes) for child in node.get("children", [])}
    above: dict[int, set[str]] = {}
    for instance in scene.instances:
        names, node = set(), parent_of.get(instance.node_index)
        while node is not None:
            names.add(nodes[node].get("name", ""))
            node = parent_of.get(node)
        above[instance.node_index] = names
    return above
