"""Which texels a camera sees: inside its frustum, turned towards it, nothing opaque between."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from irradia.scene.types import Camera
from irradia.transport.backend import dr, mi
from irradia.transport.subsamples import Subsamples
from irradia.transport.world import World


def seen_texels(world: World, subsamples: Subsamples, camera: Camera) -> NDArray[np.bool_]:
    """(N,) whether the camera sees any of a texel's sub-samples; every one of them asks by a ray."""
    texel = dr.arange(mi.UInt32, subsamples.n_texels)
    seen = dr.zeros(mi.Bool, subsamples.n_texels)
    for number in range(subsamples.count):
        seen |= _sees(world, subsamples, texel, dr.opaque(mi.UInt32, number), camera, ~seen)
        dr.eval(seen)
    return np.array(seen)


def _sees(
    world: World,
    subsamples: Subsamples,
    texel: mi.UInt32,
    number: mi.UInt32,
    camera: Camera,
    active: mi.Bool,
) -> mi.Bool:
    point = subsamples.point(world, texel, number)
    eye = mi.Point3f(*camera.world_from_camera[:3, 3].tolist())
    towards = mi.Vector3f(eye - point.origin)
    distance = dr.norm(towards)
    direction = towards / dr.maximum(distance, 1e-20)
    active = active & (dr.dot(point.ng, direction) > 0.0) & _in_frustum(camera, -towards)
    through = world.transmittance(point.origin, direction, distance * (1.0 - 1e-4), active, point.lod)
    return active & (dr.max(through) > 0.0)


def _in_frustum(camera: Camera, from_eye: mi.Vector3f) -> mi.Bool:
    right, up, back = (mi.Vector3f(*column.tolist()) for column in camera.world_from_camera[:3, :3].T)
    depth = -dr.dot(from_eye, back)
    half_height = math.tan(0.5 * camera.yfov_rad)
    inside = dr.abs(dr.dot(from_eye, up)) <= half_height * depth
    inside &= dr.abs(dr.dot(from_eye, right)) <= half_height * camera.aspect * depth
    return inside & (depth > 0.0)
