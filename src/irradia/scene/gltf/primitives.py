"""One primitive of the file as the baker's triangles."""

from __future__ import annotations

import numpy as np

from irradia.scene.gltf.normals import flat_normals, mend_normals
from irradia.scene.gltf.skins import PosedSkin, skin_vertices
from irradia.scene.gltf.stored import StoredPrimitive
from irradia.scene.gltf.topology import unroll_triangles, with_area
from irradia.scene.gltf.vertices import Vertices, blend_vertices, morph_weights
from irradia.scene.types import F32, U32, Primitive


def make_primitive(
    stored: StoredPrimitive,
    weights: tuple[float, ...],
    skin: PosedSkin | None,
    *,
    mesh_index: int,
    primitive_index: int,
    name: str,
) -> tuple[Primitive, int]:
    """Poses a primitive and gives it triangles and normals; its material is chosen later.

    Args:
        stored: The primitive's data.
        weights: Of the morph targets; empty leaves them out.
        skin: Where joints take the vertices, or None.
        mesh_index: Its mesh in the file.
        primitive_index: Its place in that mesh.
        name: What it is called.

    Returns:
        The primitive, with no triangles if none has an area, and how many had none.

    Raises:
        InputError: The data is malformed; the message names the accessor.
    """
    vertices = blend_vertices(stored, morph_weights(stored, weights))
    indices = unroll_triangles(stored)
    if skin is not None:
        vertices, indices = skin_vertices(vertices, indices, stored, skin)
    covering = with_area(vertices.positions, indices)
    triangles, source, normals = _shade(vertices, covering)
    vertices = vertices.take(source)
    primitive = Primitive(
        positions=vertices.positions,
        normals=normals,
        texcoords=vertices.texcoords,
        colors=vertices.colors,
        indices=np.ascontiguousarray(triangles),
        material=0,
        mesh_index=mesh_index,
        primitive_index=primitive_index,
        vertex_source=source,
        name=name,
        tangents=vertices.tangents,
    )
    return primitive, len(indices) - len(covering)


def _shade(vertices: Vertices, indices: U32) -> tuple[U32, U32, F32]:
    """Triangles, the vertex that each of their vertices comes from, and unit normals.

    Without normals in the file, vertices are split: three to each triangle.
    """
    if vertices.normals is None:
        triangles = np.arange(indices.size, dtype=np.uint32).reshape(-1, 3)
        return triangles, indices.ravel(), flat_normals(vertices.positions, indices)
    source = np.arange(len(vertices.positions), dtype=np.uint32)
    return indices, source, mend_normals(vertices.normals, vertices.positions, indices)
