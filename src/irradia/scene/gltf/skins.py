"""Skins: vertices moved by joints, straight into world space."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from irradia.core.errors import InputError
from irradia.scene.gltf.accessors import Accessors
from irradia.scene.gltf.stored import StoredPrimitive
from irradia.scene.gltf.vertices import Vertices
from irradia.scene.gltf.view import JsonView
from irradia.scene.types import F64, U32


@dataclass(frozen=True)
class PosedSkin:
    """A skin in a pose.

    Attributes:
        world_from_bind: (J, 4, 4): each joint's place times its inverse bind matrix.
    """

    world_from_bind: F64
    pointer: str


def pose_skin(view: JsonView, accessors: Accessors, world_from_node: list[F64]) -> PosedSkin:
    """Reads the skin at ``view`` with its joints where ``world_from_node`` puts them.

    Raises:
        InputError: A joint doesn't exist, or there are fewer inverse bind matrices than joints.
    """
    joints = []
    for joint in view.items("joints"):
        if not isinstance(joint.value, int) or not 0 <= joint.value < len(world_from_node):
            raise InputError(f"expected a node, found {joint.value!r}", where=joint.pointer)
        joints.append(world_from_node[joint.value])
    if not joints:
        raise InputError("this skin has no joints", where=view.pointer)
    world_from_bind = np.stack(joints)
    if view.has("inverseBindMatrices"):
        stored = accessors.read(view.integer("inverseBindMatrices"))
        if len(stored) < len(joints):
            raise InputError(f"expected {len(joints)} matrices, found {len(stored)}", where=stored.pointer)
        bind = stored.floats(16)[: len(joints)].astype(np.float64)
        world_from_bind = world_from_bind @ bind.reshape(-1, 4, 4).transpose(0, 2, 1)
    return PosedSkin(world_from_bind, view.pointer)


def skin_vertices(
    vertices: Vertices, indices: U32, stored: StoredPrimitive, skin: PosedSkin
) -> tuple[Vertices, U32]:
    """Vertices in world space, and the triangles; wound the other way where the joints mirror.

    Raises:
        InputError: The primitive has no joints and weights, or they name a joint that isn't there.
    """
    world_from_bind = _blended_matrices(stored, skin)
    linear = world_from_bind[:, :3, :3]
    positions = np.einsum("vij,vj->vi", linear, vertices.positions) + world_from_bind[:, :3, 3]
    determinant = np.linalg.det(linear)
    normals = vertices.normals
    if normals is not None:
        normals = np.einsum("vij,vj->vi", _cofactors(linear, determinant), normals).astype(np.float32)
    mirrored = np.count_nonzero(determinant < 0) * 2 > len(determinant)
    return vertices.moved(positions.astype(np.float32), normals), indices[:, ::-1] if mirrored else indices


def _blended_matrices(stored: StoredPrimitive, skin: PosedSkin) -> F64:
    """(V, 4, 4): each vertex's joints, weighted."""
    blended = np.zeros((stored.n_vertices, 4, 4))
    total = np.zeros(stored.n_vertices)
    n_joints = len(skin.world_from_bind)
    for joints, weights in _influences(stored):
        if int(joints.max()) >= n_joints:
            raise InputError(
                f"expected joints below {n_joints}, found {int(joints.max())}",
                where=f"{stored.pointer}/attributes",
            )
        for joint, weight in zip(joints.T, weights.T, strict=True):
            blended += weight[:, None, None] * skin.world_from_bind[joint]
            total += weight
    weightless = total <= 0  # such vertices follow the first joint, as in three.js
    blended[weightless], total[weightless] = skin.world_from_bind[0], 1.0
    return blended / total[:, None, None]


def _influences(stored: StoredPrimitive) -> list[tuple[np.ndarray, F64]]:
    """(V, 4) joints and weights of each set."""
    sets, index = [], 0
    while f"JOINTS_{index}" in stored.attributes and f"WEIGHTS_{index}" in stored.attributes:
        joints = stored.attributes[f"JOINTS_{index}"].values.astype(np.int64)
        weights = stored.attributes[f"WEIGHTS_{index}"].floats(4).astype(np.float64)
        sets.append((joints, np.maximum(weights, 0.0)))
        index += 1
    if not sets:
        raise InputError("this primitive is skinned but has no JOINTS_0 and WEIGHTS_0", where=stored.pointer)
    return sets


def _cofactors(linear: F64, determinant: F64) -> F64:
    """Inverse transposes up to a positive factor: they keep normals upright, on flat scales too."""
    a, b, c = linear[:, 0], linear[:, 1], linear[:, 2]
    cofactors = np.stack([np.cross(b, c), np.cross(c, a), np.cross(a, b)], axis=1)
    return cofactors * np.where(determinant < 0, -1.0, 1.0)[:, None, None]
