"""A head-on picture of the wall: where its pixels lie, their normals, and the truth there."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from irradia.core import Seed
from irradia.scene.layout import LightmapLayout
from irradia.scene.merge import MergedMesh, merge
from irradia.scene.tangents import bitangents, world_tangents
from irradia.scene.types import Scene
from irradia.transport.backend import dr, mi
from irradia.transport.frames import TangentFrames
from irradia.transport.geometry import SurfacePoint
from irradia.transport.normal_maps import NormalMaps
from irradia.transport.path import direct, draw_ray, start, trace
from irradia.transport.sampling import Sampler, hash_u32
from irradia.transport.world import World
from support.normal_mapped_wall import HEIGHT_M, WIDTH_M

_SAMPLES_PER_PASS = 16


@dataclass(frozen=True)
class WallView:
    """Pixels of a picture of the wall.

    Attributes:
        shape: (height, width).
        triangle, barycentric: (N,) and (N, 2): what each pixel's centre shows.
        lightmap_uv: (N, 2).
        surface, tangent, bitangent: (N, 3) world-space frame of the wall.
        normal: (N, 3) as the normal map bends it.
    """

    shape: tuple[int, int]
    triangle: NDArray[np.uint32]
    barycentric: NDArray[np.float32]
    lightmap_uv: NDArray[np.float32]
    surface: NDArray[np.float32]
    tangent: NDArray[np.float32]
    bitangent: NDArray[np.float32]
    normal: NDArray[np.float32]

    def picture(self, values: NDArray) -> NDArray[np.float32]:
        """(N, 3) as (height, width, 3)."""
        return np.ascontiguousarray(values, np.float32).reshape(*self.shape, 3)

    def sampled(self, pages: NDArray) -> NDArray[np.float64]:
        """(N, 3) a lightmap's values at the pixels, filtered as a graphics card does."""
        page, (height, width) = pages[0].astype(np.float64), pages.shape[1:3]
        at = self.lightmap_uv.astype(np.float64) * (width, height) - 0.5
        low = np.floor(at).astype(int)
        fraction = at - low
        total = np.zeros((len(at), 3))
        for dx, dy in ((0, 0), (1, 0), (0, 1), (1, 1)):
            weight = np.abs(1 - dx - fraction[:, 0]) * np.abs(1 - dy - fraction[:, 1])
            row, column = np.clip(low[:, 1] + dy, 0, height - 1), np.clip(low[:, 0] + dx, 0, width - 1)
            total += page[row, column] * weight[:, None]
        return total


class WallTruth:
    """Path-traced E/π at the pixels of a view of the wall, for the normal that its map shows."""

    def __init__(self, scene: Scene, layout: LightmapLayout, height_px: int) -> None:
        mesh = merge(scene, layout)
        tangents = world_tangents(scene, mesh, layout)
        self._world = World(scene, mesh)
        self._maps = NormalMaps(scene, TangentFrames(tangents))
        self.view = self._look(mesh, tangents, height_px)

    def _look(self, mesh: MergedMesh, tangents: NDArray[np.float32], height_px: int) -> WallView:
        shape = (height_px, round(height_px * WIDTH_M / HEIGHT_M))
        y, x = np.divmod(np.arange(shape[0] * shape[1]), shape[1])
        place = np.stack(
            [((x + 0.5) / shape[1] - 0.5) * WIDTH_M, (1 - (y + 0.5) / shape[0]) * HEIGHT_M, 0 * x], axis=1
        )
        triangle, bary = _locate(mesh, place)
        weight = np.column_stack([1 - bary.sum(axis=1), bary])[..., None]
        tangent = (tangents[triangle] * weight).sum(axis=1)
        surface = (mesh.normals[mesh.indices[triangle]] * weight).sum(axis=1)
        uv = (mesh.lightmap_uv[mesh.indices[triangle]] * weight).sum(axis=1)
        self._where = mi.UInt32(triangle), mi.Point2f(*bary.T.astype(np.float32)), mi.Bool(True)
        normal = np.array(self._point().ns).T
        across = bitangents(surface, tangent)
        return WallView(shape, triangle, bary, uv, surface, tangent[:, :3], across, normal)

    def _point(self) -> SurfacePoint:
        return self._maps.apply(self._world, self._world.point(*self._where), *self._where)

    def trace(self, samples: int, seed: int) -> NDArray[np.float32]:
        """(N, 3) means of so many paths and next-event samples each."""
        total = mi.Color3f(0.0)
        stream = Seed(seed).child("wall").uint32()
        for first in range(0, samples, _SAMPLES_PER_PASS):
            last = min(first + _SAMPLES_PER_PASS, samples)
            total += self._pass(dr.opaque(mi.UInt32, first), dr.opaque(mi.UInt32, last), stream)
            dr.eval(total)
        return np.array(total).T / samples

    @dr.syntax
    def _pass(self, first: mi.UInt32, last: mi.UInt32, stream: int) -> mi.Color3f:
        point = self._point()
        pixel = dr.arange(mi.UInt32, len(self._where[0]))
        seed = hash_u32(pixel ^ hash_u32(dr.opaque(mi.UInt32, stream)))
        light = mi.Color3f(0.0)
        k = mi.UInt32(first)
        while k < last:
            sampler = Sampler(mi.UInt32(k), mi.UInt32(seed))
            drawn = draw_ray(point, sampler)
            ray = start(drawn.origin, drawn.direction, drawn.pdf, mi.Float(1.0), sampler, drawn.above)
            light += trace(self._world, ray, None).radiance * drawn.weight
            light += direct(self._world, point, sampler, mi.Float(1.0), mi.Bool(True)).light
            k += 1
        return light


def _locate(mesh: MergedMesh, place: NDArray) -> tuple[NDArray[np.uint32], NDArray[np.float32]]:
    """The triangle of the first instance, the wall, under each place, and barycentrics."""
    triangle = np.zeros(len(place), np.uint32)
    bary = np.full((len(place), 2), -1.0)
    for index in np.flatnonzero(mesh.instance == 0):
        a, b, c = mesh.positions[mesh.indices[index]].astype(np.float64)
        edges = np.stack([b - a, c - a])[:, :2]
        weights = (place - a)[:, :2] @ np.linalg.inv(edges)
        inside = (weights >= -1e-9).all(axis=1) & (weights.sum(axis=1) <= 1 + 1e-9)
        triangle[inside], bary[inside] = index, weights[inside]
    return triangle, np.clip(bary, 0.0, 1.0).astype(np.float32)
