"""Tangents of the merged mesh: what normal maps and tangent-space lightmaps are turned by.

glTF's tangent space: x along the tangent, where u grows; y along the bitangent, ``cross(normal,
tangent) · w``, where v falls (the image's upward direction); z along the vertex normal.

A primitive's own TANGENT is taken where the file has it. Elsewhere tangents are derived as Mikkelsen
does ("Simulation of Wrinkled Surfaces Revisited", 2008, and its MikkTSpace): unit tangents of faces,
projected to the plane of the vertex normal and added up weighted by the corner's angle, over all
corners with the same position, normal, uv and handedness. Ours joins corners that share no edge, too.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from irradia.scene.layout import LightmapLayout
from irradia.scene.merge import MergedMesh
from irradia.scene.types import F32, F64, Instance, Primitive, Scene

# Three directions of tangent space, square to one another and equally steep: the basis of McTaggart
# 2004, "Half-Life 2 / Valve Source Shading".
RNM_BASIS = np.array(
    [
        [np.sqrt(2 / 3), 0.0, np.sqrt(1 / 3)],
        [-np.sqrt(1 / 6), np.sqrt(1 / 2), np.sqrt(1 / 3)],
        [-np.sqrt(1 / 6), -np.sqrt(1 / 2), np.sqrt(1 / 3)],
    ]
)
_TINY = 1e-20


def world_tangents(scene: Scene, mesh: MergedMesh, layout: LightmapLayout | None = None) -> F32:
    """Tangents in world space at the corners of all triangles.

    The derived ones follow the texture coordinates of the material's normal texture, its transform
    applied, or the first set. Where those say nothing (no uv, or no extent), any direction across
    the normal is taken, the same for equal normals.

    Args:
        scene: What was merged.
        mesh: Its merged mesh.
        layout: The one that it was merged with.

    Returns:
        (T, 3, 4): triangle, corner; unit vectors across the vertex normal, and the bitangent's sign.
    """
    tangents = _derived(scene, mesh)
    given = _given(scene, layout, len(mesh.positions))
    if given is not None:
        corners = given[mesh.indices]
        usable = np.linalg.norm(corners[..., :3], axis=-1) > 0.5
        tangents[usable] = corners[usable]
    across = _across(tangents[..., :3], mesh.normals[mesh.indices].astype(np.float64))
    return np.concatenate([across, tangents[..., 3:]], axis=-1).astype(np.float32)


def bitangents(normals: NDArray, tangents: NDArray) -> NDArray:
    """(…, 3) bitangents for normals (…, 3) and tangents (…, 4)."""
    return np.cross(normals, tangents[..., :3]) * tangents[..., 3:]


def _given(scene: Scene, layout: LightmapLayout | None, n_vertices: int) -> F64 | None:
    """(V, 4) the files' tangents by merged vertex, 0 where there are none; None if nowhere."""
    if all(scene.primitives[i.primitive].tangents is None for i in scene.instances):
        return None
    result = np.zeros((n_vertices, 4))
    first = 0
    for index, instance in enumerate(scene.instances):
        primitive = scene.primitives[instance.primitive]
        unwrap = layout.unwraps[instance.primitive] if layout and layout.page[index] >= 0 else None
        source = np.arange(len(primitive.positions)) if unwrap is None else unwrap.vertex_source
        if primitive.tangents is not None:
            result[first : first + len(source)] = _placed(primitive, instance)[source]
        first += len(source)
    return result


def _placed(primitive: Primitive, instance: Instance) -> F64:
    """(V, 4) a primitive's tangents in world space; mirroring turns the bitangent over."""
    linear = instance.world_from_object[:3, :3]
    tangents = np.asarray(primitive.tangents, np.float64)
    directions = tangents[:, :3] @ linear.T
    directions /= np.maximum(np.linalg.norm(directions, axis=1, keepdims=True), _TINY)
    sign = np.where(tangents[:, 3] < 0, -1.0, 1.0) * (1.0 if np.linalg.det(linear) >= 0 else -1.0)
    return np.column_stack([directions, sign])


def _derived(scene: Scene, mesh: MergedMesh) -> F64:
    """(T, 3, 4) from the texture coordinates."""
    corners = mesh.positions[mesh.indices].astype(np.float64)
    normals = mesh.normals[mesh.indices].astype(np.float64)
    uv = _mapping(scene, mesh)
    e1, e2 = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    d1, d2 = uv[:, 1] - uv[:, 0], uv[:, 2] - uv[:, 0]
    area = d1[:, 0] * d2[:, 1] - d1[:, 1] * d2[:, 0]
    along_u = (e1 * d2[:, 1:] - e2 * d1[:, 1:]) * np.sign(area)[:, None]
    # v points down the image, so a face that shows it unmirrored has a negative area.
    handedness = np.where(area > 0, -1.0, 1.0)

    per_corner = _across(np.repeat(along_u[:, None], 3, axis=1), normals) * _angles(corners)[..., None]
    per_corner[area == 0] = 0.0
    group = _groups(mesh, uv, handedness)
    summed = np.stack([np.bincount(group, per_corner[..., k].ravel()) for k in range(3)], axis=1)
    directions = summed[group].reshape(-1, 3, 3)
    length = np.linalg.norm(directions, axis=-1, keepdims=True)
    directions = np.where(length > 1e-6, directions / np.maximum(length, _TINY), _any_across(normals))
    return np.concatenate([directions, np.broadcast_to(handedness[:, None, None], length.shape)], axis=-1)


def _mapping(scene: Scene, mesh: MergedMesh) -> F64:
    """(T, 3, 2) the texture coordinates that normal textures are read by."""
    uv = mesh.texcoords[:, 0][mesh.indices].astype(np.float64)
    for index, material in enumerate(scene.materials):
        texture = material.normal_texture
        if texture is None:
            continue
        chosen = mesh.material == index
        matrix = np.array(texture.uv_from_texcoord)
        own = mesh.texcoords[:, texture.texcoord & 1][mesh.indices[chosen]].astype(np.float64)
        uv[chosen] = own @ matrix[:, :2].T + matrix[:, 2]
    return uv


def _groups(mesh: MergedMesh, uv: F64, handedness: F64) -> NDArray[np.intp]:
    """(3T,) number of the group of equal corners that each corner belongs to."""
    rows = np.empty((len(uv), 3, 10), np.float32)
    rows[..., 0:3] = mesh.positions[mesh.indices]
    rows[..., 3:6] = mesh.normals[mesh.indices]
    rows[..., 6:8] = uv
    rows[..., 8] = handedness[:, None]
    rows[..., 9] = mesh.instance.astype(np.uint32).view(np.float32)[:, None]
    rows[..., :9] += np.float32(0.0)  # −0 and 0 are one place
    words = rows.reshape(-1, 10).view([("", np.uint32)] * 10).ravel()
    return np.unique(words, return_inverse=True)[1]


def _angles(corners: F64) -> F64:
    """(T, 3) interior angle at each corner."""
    after = np.roll(corners, -1, axis=1) - corners
    before = np.roll(corners, 1, axis=1) - corners
    cross = np.linalg.norm(np.cross(after, before), axis=-1)
    return np.arctan2(cross, (after * before).sum(-1))


def _across(vectors: NDArray, normals: F64) -> F64:
    """Unit vectors with the part along the normal taken off; where nothing is left, any across it."""
    flat = vectors - normals * (vectors * normals).sum(-1, keepdims=True)
    length = np.linalg.norm(flat, axis=-1, keepdims=True)
    scale = np.linalg.norm(vectors, axis=-1, keepdims=True)
    return np.where(length > 1e-6 * scale, flat / np.maximum(length, _TINY), _any_across(normals))


def _any_across(normals: F64) -> F64:
    """A unit vector across each normal (Duff et al. 2017, "Building an Orthonormal Basis, Revisited")."""
    x, y, z = np.moveaxis(normals, -1, 0)
    sign = np.copysign(1.0, z)
    a = -1.0 / (sign + z)
    return np.stack([1.0 + sign * x * x * a, sign * x * y * a, -sign * x], axis=-1)
