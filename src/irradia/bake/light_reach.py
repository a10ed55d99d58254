"""Where lights may shine, shadows aside: decides which of them overlap.

The mapped surface is cut into patches whose number doesn't depend on the lightmap's size: large
triangles are quartered, runs of small ones along a space-filling curve are taken together. A patch
keeps bounds of its places and normals, so the answer errs on one side only: where a light is said
not to reach, it doesn't.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, fields

import numpy as np
from numpy.typing import NDArray

from irradia.core.colour import LUMINANCE_WEIGHTS
from irradia.scene.merge import MergedMesh
from irradia.scene.types import F64, Light

_N_PATCHES = 1 << 14  # about as many as there will be
_MAX_QUARTERINGS = 12
_MORTON_BITS = 10
_JUMPS_ACROSS = 64


@dataclass(frozen=True)
class Patches:
    """Pieces of the mapped surface.

    Attributes:
        low, high: (K, 3) bounds of the places, metres.
        normal_low, normal_high: (K, 3) bounds of the unit normals of the fronts.
        lowest: (K,) the least n · (p − centre) over a patch's places and normals.
        area_m2: (K,).
    """

    low: F64
    high: F64
    normal_low: F64
    normal_high: F64
    lowest: F64
    area_m2: F64

    def take(self, chosen: NDArray[np.bool_]) -> Patches:
        """Some of them."""
        return Patches(**{field.name: getattr(self, field.name)[chosen] for field in fields(self)})

    @property
    def centre(self) -> F64:
        """(K, 3) the middle of the bounds."""
        return (self.low + self.high) / 2


def cut_patches(mesh: MergedMesh) -> Patches:
    """Patches of all triangles that have texels."""
    corners = mesh.positions[mesh.indices[mesh.page >= 0]].astype(np.float64)
    corners = _quarter_large(corners)
    cross = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    length = np.linalg.norm(cross, axis=1)
    normals = cross / np.maximum(length, 1e-300)[:, None]
    centres, side = corners.mean(axis=1), _dominant_side(normals)
    order = np.lexsort((_morton(centres), side))
    starts = _starts_of_runs(centres[order], side[order])
    return _gather_runs(corners[order], normals[order], length[order] / 2, starts)


def reaches(light: Light, patches: Patches) -> NDArray[np.bool_]:
    """(K,) whether a light may reach some place of each patch that faces it."""
    if light.kind == "directional":
        slack = math.sin(min(math.radians(light.angle_deg) / 2, math.pi / 2))
        return _facing(patches, -np.array(light.direction), np.zeros(1), slack)
    reached = _in_range(light, patches)
    near = patches.take(reached)
    towards = np.array(light.position) - near.centre
    reached[reached] = _facing(near, towards, near.lowest, light.radius_m) & _in_cone(light, near)
    return reached


def strength(light: Light, patches: Patches, reached: NDArray[np.bool_]) -> float:
    """Luminance of the light that patches would get without shadows, by the middles of their bounds."""
    area = patches.area_m2[reached]
    luminance = float(np.dot(light.intensity, LUMINANCE_WEIGHTS))
    if light.kind == "directional":
        return luminance * float(area.sum())
    squared = ((np.array(light.position) - patches.centre[reached]) ** 2).sum(axis=1)
    return luminance * float((area / np.maximum(squared, area + 1e-12)).sum())


def _quarter_large(corners: F64) -> F64:
    """Splits triangles at the middles of their edges until the largest are small beside the whole."""
    edges = corners - np.roll(corners, 1, axis=1)
    area = np.linalg.norm(np.cross(edges[:, 0], edges[:, 1]), axis=1) / 2
    longest_m = math.sqrt(4.0 * float(area.sum()) / _N_PATCHES)
    done = []
    for _ in range(_MAX_QUARTERINGS):
        edges = corners - np.roll(corners, 1, axis=1)
        large = np.linalg.norm(edges, axis=2).max(axis=1, initial=0.0) > longest_m
        done.append(corners[~large])
        a, b, c = np.moveaxis(corners[large], 1, 0)
        ab, bc, ca = (a + b) / 2, (b + c) / 2, (c + a) / 2
        quarters = ((a, ab, ca), (ab, b, bc), (ca, bc, c), (bc, ca, ab))
        corners = np.concatenate([np.stack(q, axis=1) for q in quarters])
        if len(corners) == 0:
            break
    return np.concatenate([*done, corners])


def _dominant_side(normals: F64) -> NDArray[np.intp]:
    """(M,) which of the six axis directions each normal is nearest to."""
    axis = np.abs(normals).argmax(axis=1)
    return 2 * axis + (np.take_along_axis(normals, axis[:, None], 1)[:, 0] < 0)


def _morton(points: F64) -> NDArray[np.uint32]:
    """(M,) places along a Z-shaped space-filling curve through the points' bounds."""
    low, high = points.min(axis=0), points.max(axis=0)
    cells = (points - low) / max(float((high - low).max()), 1e-300) * ((1 << _MORTON_BITS) - 1)
    code = np.zeros(len(points), np.uint32)
    for axis in range(3):
        column = cells[:, axis].astype(np.uint32)
        for bit in range(_MORTON_BITS):
            code |= ((column >> bit) & 1) << np.uint32(3 * bit + axis)
    return code


def _starts_of_runs(centres: F64, side: NDArray[np.intp]) -> NDArray[np.intp]:
    """Where runs begin: each is at most so long, faces one way and nowhere jumps across the scene."""
    longest = max(1, math.ceil(len(centres) / _N_PATCHES))
    jump_m = float(np.ptp(centres, axis=0).max()) / _JUMPS_ACROSS
    begins = np.arange(len(centres)) % longest == 0
    begins[1:] |= side[1:] != side[:-1]
    begins[1:] |= (np.abs(np.diff(centres, axis=0)) > jump_m).any(axis=1)
    return np.flatnonzero(begins)


def _gather_runs(corners: F64, normals: F64, area: F64, starts: NDArray[np.intp]) -> Patches:
    """Bounds over runs of pieces."""
    low = np.minimum.reduceat(corners.min(axis=1), starts)
    high = np.maximum.reduceat(corners.max(axis=1), starts)
    run = np.repeat(np.arange(len(starts)), np.diff([*starts, len(corners)]))
    offsets = corners - ((low + high) / 2)[run][:, None]
    heights = np.einsum("mkc,mc->mk", offsets, normals).min(axis=1)
    return Patches(
        low=low,
        high=high,
        normal_low=np.minimum.reduceat(normals, starts),
        normal_high=np.maximum.reduceat(normals, starts),
        lowest=np.minimum.reduceat(heights, starts),
        area_m2=np.add.reduceat(area, starts),
    )


def _facing(patches: Patches, towards: F64, lowest: F64, slack: float) -> NDArray[np.bool_]:
    """Whether n · (light − p) can be positive; bounds of each factor on its own, exact on planes."""
    products = np.maximum(patches.normal_low * towards, patches.normal_high * towards)
    return products.sum(axis=1) - lowest + slack > 0.0


def _in_range(light: Light, patches: Patches) -> NDArray[np.bool_]:
    if light.range_m is None:
        return np.ones(len(patches.low), np.bool_)
    position = np.array(light.position)
    gap = np.maximum(np.maximum(patches.low - position, position - patches.high), 0.0)
    return (gap**2).sum(axis=1) < (light.range_m + light.radius_m) ** 2


def _in_cone(light: Light, patches: Patches) -> NDArray[np.bool_]:
    """Whether a patch's bounding sphere, grown by the light's own, meets the cone."""
    half_angle = _cone_rad(light)
    if half_angle > math.pi / 2:
        return np.ones(len(patches.low), np.bool_)
    radius = np.linalg.norm(patches.high - patches.low, axis=1) / 2 + light.radius_m
    from_light = patches.centre - np.array(light.position)
    along = from_light @ np.array(light.direction)
    across = np.sqrt(np.maximum((from_light**2).sum(axis=1) - along**2, 0.0))
    outside = across * math.cos(half_angle) - along * math.sin(half_angle) > radius
    return ~outside & (along > -radius)


def _cone_rad(light: Light) -> float:
    """Angle from the axis beyond which a light sends nothing."""
    if light.profile is not None:
        rows = light.profile.candela.max(axis=1) > 0.0
        last = int(np.flatnonzero(rows)[-1]) + 1 if rows.any() else 0
        return math.pi * min(last / max(len(rows) - 1, 1), 1.0)
    return light.outer_cone_rad if light.kind == "spot" else math.pi
