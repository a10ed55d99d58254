"""Light at places strewn evenly over a scene's surfaces: the estimators alone, without a bake round them."""

from __future__ import annotations

import time
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from irradia.core import Seed
from irradia.scene.merge import MergedMesh, merge
from irradia.scene.surface import triangle_areas
from irradia.scene.types import Scene
from irradia.transport.backend import dr, mi
from irradia.transport.light_setup import Selection, make_lights
from irradia.transport.path import direct, draw_ray, start, trace
from irradia.transport.sampling import Sampler, hash_u32
from irradia.transport.world import World


@dataclass(frozen=True)
class Estimate:
    """E/π at every place, and what it took.

    Attributes:
        light: (N, 3).
        seconds: Of the one launch, compiled before.
    """

    light: NDArray[np.float64]
    seconds: float


class Places:
    """A scene seen from ``n_places`` of its surfaces, the same for every way of choosing lights."""

    def __init__(self, scene: Scene, n_places: int, selection: Selection) -> None:
        mesh = merge(scene)
        self._world = World(scene, mesh)
        self._world.lights = make_lights(scene, mesh, selection)
        triangle, bary = _strewn(mesh, n_places)
        self._triangle = mi.UInt32(triangle)
        self._bary = mi.Point2f(bary)
        self.n_places = n_places
        dr.eval(self._triangle, self._bary)

    def estimate(self, n_samples: int, seed: int, *, bounces: bool) -> Estimate:
        """Draws ``n_samples`` at every place.

        Args:
            n_samples: Next-event samples, and as many gather rays where there are bounces.
            seed: Of the random numbers.
            bounces: Whether whole paths are followed, with a next-event sample at each bounce.
        """
        count, root = dr.opaque(mi.UInt32, n_samples), dr.opaque(mi.UInt32, seed)
        dr.sync_thread()
        before = time.perf_counter()
        light = self._loop(count, root, bounces)
        dr.eval(light)
        dr.sync_thread()
        seconds = time.perf_counter() - before
        return Estimate(np.array(light, np.float64).T / max(n_samples, 1), seconds)

    @dr.syntax
    def _loop(self, count: mi.UInt32, root: mi.UInt32, bounces: bool) -> mi.Color3f:
        lane = dr.arange(mi.UInt32, self.n_places)
        point = self._world.point(self._triangle, self._bary, mi.Bool(True))
        lane_seed = hash_u32(lane ^ hash_u32(root))
        total = mi.Color3f(0.0)
        k = mi.UInt32(0)
        while k < count:
            sampler = Sampler(mi.UInt32(k), mi.UInt32(lane_seed))
            total += direct(self._world, point, sampler, mi.Float(1.0), mi.Bool(True)).light
            if dr.hint(bounces, mode="scalar"):
                leaving = draw_ray(point, sampler)
                ray = start(
                    leaving.origin, leaving.direction, leaving.pdf, mi.Float(1.0), sampler, leaving.above
                )
                total += leaving.weight * trace(self._world, ray).radiance
            k += 1
        return total


def _strewn(mesh: MergedMesh, n_places: int) -> tuple[NDArray[np.uint32], NDArray[np.float32]]:
    """Triangles by area, and uniform barycentric coordinates (2, N); the same for the same mesh."""
    rng = Seed(1).child("places").numpy()
    running = np.cumsum(triangle_areas(mesh))
    triangle = np.searchsorted(running, rng.random(n_places) * running[-1], side="right")
    root, across = np.sqrt(rng.random(n_places)), rng.random(n_places)
    bary = np.stack([root * (1.0 - across), root * across]).astype(np.float32)
    return np.minimum(triangle, len(running) - 1).astype(np.uint32), bary
