"""Places to look around from: on the visible sides of surfaces, and in free space.

Each supply (:class:`irradia.bake.datasets.supply.Places`) draws candidates and drops what lies inside
something solid: on a surface where most of the rays above it first meet the back of a solid, as texels of a
bake; in space where a quarter of all rays do, as probes.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from irradia.bake.datasets.random_points import CubePoints, unit_vectors
from irradia.bake.datasets.supply import Buffer
from irradia.bake.probes.survey import MAX_BACKS
from irradia.core.errors import InputError
from irradia.core.rng import Seed
from irradia.scene.merge import LEVEL_BITS, MergedMesh
from irradia.scene.surface import triangle_areas

if TYPE_CHECKING:
    from irradia.transport.receivers import Receivers
    from irradia.transport.world import World

F32 = NDArray[np.float32]
F64 = NDArray[np.float64]

_FEW_RAYS, _MANY_RAYS = 8, 64
_MOSTLY = 0.5


class SurfacePlaces:
    """Points spread by area over the visible sides of surfaces, under their shading normals.

    Both sides of double-sided and translucent surfaces count. Unlit ones, coarser levels of detail and
    what alpha cuts out don't.

    Args:
        world: The scene.
        mesh: Its merged mesh.
        seed: Of this supply.
        stratified: Whether the points are spread evenly.
        within: (2, 3) only points in this box; None for all.

    Raises:
        InputError: No surface receives light.
    """

    n_left = None

    def __init__(
        self,
        world: World,
        mesh: MergedMesh,
        seed: Seed,
        *,
        stratified: bool = False,
        within: F64 | None = None,
    ) -> None:
        self._world, self._within = world, within
        self._triangle, self._back = _sides(world, mesh)
        self._running = np.cumsum(triangle_areas(mesh)[self._triangle])
        if len(self._running) == 0 or self._running[-1] <= 0.0:
            raise InputError("no surface of the scene receives light", where=world.scene.name)
        self._numbers = CubePoints(seed, stratified=stratified)

    def draw(self, n: int) -> Receivers:
        """See :class:`Places`."""
        from irradia.transport.receivers import surface_receivers

        u = self._numbers.draw(n)
        chosen = np.searchsorted(self._running, u[:, 0] * self._running[-1], side="right")
        chosen = np.minimum(chosen, len(self._running) - 1)
        root = np.sqrt(u[:, 1])
        bary = np.stack([root * (1.0 - u[:, 2]), root * u[:, 2]], axis=1).astype(np.float32)
        places, covers = surface_receivers(self._world, self._triangle[chosen], bary, self._back[chosen])
        fit = covers > 0.0
        if self._within is not None:
            fit &= ((places.positions >= self._within[0]) & (places.positions <= self._within[1])).all(axis=1)
        places = places.take(fit)
        return places.take(~_inside(self._world, places, _MOSTLY, all_round=False))


class FreePlaces:
    """Points in free space under random normals.

    Args:
        world: The scene.
        box: (2, 3) where they lie, metres.
        seed: Of this supply.
        stratified: Whether the points are spread evenly.
    """

    n_left = None

    def __init__(self, world: World, box: F64, seed: Seed, *, stratified: bool = False) -> None:
        self._world, self._box = world, box
        self._numbers = CubePoints(seed.child("positions"), stratified=stratified)
        self._normals = CubePoints(seed.child("normals"))

    def draw(self, n: int) -> Receivers:
        """See :class:`Places`."""
        low, high = self._box
        positions = low + self._numbers.draw(n) * (high - low)
        return _free(self._world, positions, unit_vectors(self._normals.draw(n)))


class LatticePlaces:
    """The sites of a lattice that lie in free space, each once, in an order that leaps through the box.

    Args:
        world: The scene.
        box: (2, 3) that the lattice is centred in, metres.
        spacing_m: Between neighbours.
    """

    def __init__(self, world: World, box: F64, spacing_m: float) -> None:
        self._world, self._spacing_m = world, spacing_m
        size = np.maximum(np.round((box[1] - box[0]) / spacing_m), 1.0).astype(np.int64)
        self._shape: tuple[int, int, int] = (int(size[0]), int(size[1]), int(size[2]))
        self._origin = 0.5 * (box[0] + box[1]) - 0.5 * (size - 1) * spacing_m
        self._n_sites, self._n_drawn = int(np.prod(size)), 0
        self._stride = _coprime_near_golden_ratio(self._n_sites)

    @property
    def n_left(self) -> int:
        """See :class:`Places`."""
        return self._n_sites - self._n_drawn

    def draw(self, n: int) -> Receivers:
        """See :class:`Places`."""
        step = np.arange(self._n_drawn, min(self._n_drawn + n, self._n_sites))
        self._n_drawn += len(step)
        # Python's integers: the product of two large ones leaves 64 bits.
        site = np.array([i * self._stride % self._n_sites for i in step.tolist()], np.int64)
        index = np.stack(np.unravel_index(site, self._shape), axis=1).reshape(-1, 3)
        positions = self._origin + index * self._spacing_m
        return _free(self._world, positions, np.zeros_like(positions))


def random_surface_places(world: World, mesh: MergedMesh, n: int, seed: Seed) -> Receivers:
    """Exactly ``n`` independent points on visible surfaces, by area."""
    return Buffer(SurfacePlaces(world, mesh, seed)).take(n)


def random_free_places(world: World, box: F64, n: int, seed: Seed) -> Receivers:
    """Exactly ``n`` independent points in the free space of a box (2, 3), under random normals."""
    return Buffer(FreePlaces(world, box, seed)).take(n)


def _sides(world: World, mesh: MergedMesh) -> tuple[NDArray[np.uint32], NDArray[np.bool_]]:
    """Triangle and side of everything that light can be received on."""
    from irradia.transport.materials import DOUBLE_SIDED, TRANSLUCENT, UNLIT

    flags = world.materials.flags[mesh.material]
    lit = (flags & UNLIT) == 0
    if mesh.lod is not None:
        lit &= (mesh.lod & ((1 << LEVEL_BITS) - 1)) == 0
    front = np.flatnonzero(lit)
    back = np.flatnonzero(lit & ((flags & (DOUBLE_SIDED | TRANSLUCENT)) != 0))
    triangle = np.concatenate([front, back]).astype(np.uint32)
    return triangle, np.arange(len(triangle)) >= len(front)


def _free(world: World, positions: F64, normals: F64) -> Receivers:
    """The positions (N, 3) that lie in free space."""
    from irradia.transport.receivers import Receivers

    places = Receivers.in_space(positions.astype(np.float32), normals.astype(np.float32))
    return places.take(~_inside(world, places, MAX_BACKS, all_round=True))


def _inside(world: World, places: Receivers, most: float, *, all_round: bool) -> NDArray[np.bool_]:
    """(N,) whether more than the share ``most`` of rays meet backs: a few decide where they agree."""
    from irradia.transport.point_light import share_of_backs

    share = share_of_backs(world, places, _FEW_RAYS, all_round=all_round)
    unsure = np.flatnonzero((share > 0.0) & (share < 1.0))
    share[unsure] = share_of_backs(world, places.take(unsure), _MANY_RAYS, all_round=all_round)
    return share > most


def _coprime_near_golden_ratio(n: int) -> int:
    """A stride that visits all of ``n`` places, each far from those just before."""
    stride = max(round(n * 0.6180339887498949), 1)
    while np.gcd(stride, n) != 1:
        stride += 1
    return stride
