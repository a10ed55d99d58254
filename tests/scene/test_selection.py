"""--only finds objects by the names that people see."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from irradia.core.errors import InputError
from irradia.scene.gltf.document import GltfDocument
from irradia.scene.selection import select_instances
from irradia.scene.types import Scene


@pytest.fixture
def street(named_scene) -> Scene:
    """Nodes "Lamp.1" and "Lamp.2" with the mesh "lamp", "House" with "wall", "House" below "Row"."""
    scene = named_scene([("Lamp.1", "lamp"), ("Lamp.2", "lamp"), ("House", "wall")])
    nodes = [{"name": "Lamp.1"}, {"name": "Lamp.2"}, {"name": "House"}, {"name": "Row", "children": [2]}]
    return replace(scene, document=GltfDocument({"nodes": nodes}, ()))


@pytest.mark.parametrize(
    ("names", "expected"),
    [
        (["Lamp.1"], [True, False, False]),
        (["lamp"], [True, True, False]),
        (["Lamp.*"], [True, True, False]),
        (["Row"], [False, False, True]),
        (["Lamp.2", "House"], [False, True, True]),
        (["*"], [True, True, True]),
        (["?ouse"], [False, False, True]),
    ],
)
def test_names_choose_the_objects_that_bear_them(street, names, expected):
    np.testing.assert_array_equal(select_instances(street, names), expected)


def test_brackets_are_taken_literally_where_a_name_has_them(named_scene):
    scene = named_scene([("tree[1]", "a"), ("tree1", "b")])
    np.testing.assert_array_equal(select_instances(scene, ["tree[1]"]), [True, False])


def test_unknown_names_get_the_nearest_one(street):
    with pytest.raises(InputError, match=r"(?s)--only: no object is called 'house'.*'House'"):
        select_instances(street, ["Lamp.1", "house"])
