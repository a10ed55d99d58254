"""Small scenes whose parts have names."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
import pytest

from irradia.scene.types import Image, Instance, Material, Primitive, Scene, TextureRef


def _triangle(name: str, material: int, mesh: int) -> Primitive:
    """A right triangle with one set of texture coordinates."""
    return Primitive(
        positions=np.float32([[0, 0, 0], [1, 0, 0], [0, 1, 0]]),
        normals=np.tile(np.float32([0, 0, 1]), (3, 1)),
        texcoords=(np.float32([[0, 0], [1, 0], [0, 1]]),),
        colors=None,
        indices=np.array([[0, 1, 2]], np.uint32),
        material=material,
        mesh_index=mesh,
        primitive_index=0,
        vertex_source=np.arange(3, dtype=np.uint32),
        name=name,
    )


def _named_scene(nodes_and_meshes: Sequence[tuple[str, str]]) -> Scene:
    """A node for each pair; pairs that name the same mesh share it. The material is a textured one."""
    meshes = list(dict.fromkeys(mesh for _, mesh in nodes_and_meshes))
    image = Image("picture", np.full((2, 2, 4), (200, 100, 50, 128), np.uint8))
    return Scene(
        name="named",
        primitives=tuple(_triangle(mesh, 0, index) for index, mesh in enumerate(meshes)),
        instances=tuple(
            Instance(meshes.index(mesh), np.eye(4), index, name=node)
            for index, (node, mesh) in enumerate(nodes_and_meshes)
        ),
        materials=(Material("paint", base_color_texture=TextureRef(0)), Material("glow")),
        images=(image,),
    )


@pytest.fixture
def named_scene() -> Callable[[Sequence[tuple[str, str]]], Scene]:
    """Builds a scene of (node, mesh) pairs."""
    return _named_scene
