"""Scenes of a few rectangles, and their texels ready to be asked."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from irradia.bake.texels import TexelSet
from irradia.scene.layout import LightmapLayout
from irradia.scene.merge import MergedMesh
from irradia.scene.types import Image, Instance, Light, Material, Primitive, Scene

from .lit_scenes import instance_of, laid_out, places


def quad(corner: ArrayLike, edge_u: ArrayLike, edge_v: ArrayLike, material: int = 0) -> Primitive:
    """A rectangle whose front is on the side of edge_u × edge_v."""
    start, u, v = (np.asarray(x, np.float32) for x in (corner, edge_u, edge_v))
    normal = np.cross(u, v)
    return Primitive(
        positions=np.stack([start, start + u, start + u + v, start + v]),
        normals=np.tile((normal / np.linalg.norm(normal)).astype(np.float32), (4, 1)),
        texcoords=(np.float32([[0, 0], [1, 0], [1, 1], [0, 1]]),),
        colors=None,
        indices=np.uint32([[0, 1, 2], [0, 2, 3]]),
        material=material,
        mesh_index=0,
        primitive_index=0,
        vertex_source=np.arange(4, dtype=np.uint32),
    )


def quad_scene(
    *quads: Primitive,
    materials: Sequence[Material] = (Material(),),
    images: Sequence[Image] = (),
    lights: Sequence[Light] = (),
    mapped: int | None = None,
) -> Scene:
    """One instance of each; only the first ``mapped`` take a lightmap."""
    mapped = len(quads) if mapped is None else mapped
    instances = tuple(
        Instance(index, np.eye(4), index, lightmap_scale=1.0 if index < mapped else 0.0)
        for index in range(len(quads))
    )
    return Scene("quads", tuple(quads), instances, tuple(materials), tuple(images), tuple(lights))


class Traced:
    """A scene's texels on the device.

    Attributes:
        places: (N, S, 3) world positions of the sub-samples.
        instance: (N,) what each texel belongs to.
    """

    def __init__(self, scene: Scene, resolution: int) -> None:
        from irradia.transport.subsamples import Subsamples
        from irradia.transport.world import World

        layout: LightmapLayout = laid_out(scene, resolution)
        self.mesh: MergedMesh
        self.texels: TexelSet
        self.places: NDArray
        self.mesh, self.texels, self.places = places(scene, layout)
        self.instance: NDArray = instance_of(self.mesh, self.texels)
        self.world: Any = World(scene, self.mesh, (layout.width_px, layout.height_px))
        self.subsamples: Any = Subsamples(self.world, self.texels.pixel, self.texels.samples)
