"""``auto`` placement: an octree, split where surfaces are near and where light changes.

Coarse cells cover the space. Round by round, the leaves that need it most are split: those whose
corners disagree most about their light, and those that hold surfaces. A quick gather at every new
corner says how much light changes, a quick look whether it is inside something solid. Leaves that are
solid throughout are dropped; corners that no short way leads out of become no probes, later on.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from irradia.bake.probes.placement import Placement
from irradia.bake.probes.survey import MAX_BACKS, quick_validity
from irradia.core.progress import Stage
from irradia.core.sh import irradiance
from irradia.formats.probes import ProbeOctree
from irradia.scene.merge import MergedMesh
from irradia.scene.surface import sample_surface

if TYPE_CHECKING:
    from irradia.transport.world import World

F32 = NDArray[np.float32]
F64 = NDArray[np.float64]
I64 = NDArray[np.int64]
QuickGather = Callable[[F32, F32], F32]  # places (N, 3), spacing (N,) → coefficients (N, 9, 3)

LEVELS = 3  # times that a coarse cell may be split
_COARSE_SHARE = 1 / 8  # of all probes, for the coarse cells
_SURFACE_SAMPLES = 200_000
_NEW_CORNERS = 10  # per split, about: neighbours share them
_SMALL_CHANGE = 0.15  # of E: leaves without surfaces whose light changes less are left alone
_SURFACE_SCORE = 0.25  # a surface counts as much as such a change of light
CORNERS = np.array([(i & 1, i >> 1 & 1, i >> 2 & 1) for i in range(8)], np.int64)


@dataclass
class _Leaves:
    """Leaves as they stand: low corners in units of the finest cell, and levels."""

    low: I64
    level: I64

    @property
    def size(self) -> I64:
        return 1 << (LEVELS - self.level)

    @property
    def n_corners(self) -> int:
        return len(np.unique(pack(self.corners())))

    def corners(self) -> I64:
        """(C, 8, 3) in units of the finest cell."""
        return self.low[:, None] + CORNERS * self.size[:, None, None]


def place_octree(
    world: World, mesh: MergedMesh, low: F64, high: F64, max_probes: int, gather: QuickGather, stage: Stage
) -> Placement:
    """Builds the octree and puts a probe at each of its free corners.

    Args:
        world: The scene.
        mesh: Its surfaces.
        low: Corner of the space, metres.
        high: The opposite one.
        max_probes: Not to be exceeded.
        gather: Quick light at places.
        stage: Advances by a round at a time.
    """
    unit, shape = _finest_cell(low, high, max_probes)
    origin = 0.5 * (low + high) - 0.5 * shape * unit * (1 << LEVELS)
    surface = np.floor((sample_surface(mesh, _SURFACE_SAMPLES).positions - origin) / unit).astype(np.int64)
    index = np.stack(np.meshgrid(*map(np.arange, shape), indexing="ij"), axis=-1).reshape(-1, 3)
    leaves = _Leaves(index << LEVELS, np.zeros(len(index), np.int64))
    known = _KnownPlaces(world, origin, unit, gather)
    for number in range(LEVELS):
        score = _scores(leaves, known, surface)
        n_now = leaves.n_corners
        # Equal parts for all rounds, else the first takes all and nothing becomes fine.
        leaves = _split(leaves, score, n_now + (max_probes - n_now) // (LEVELS - number))
        stage.advance()
    return _finish(leaves, known, origin, unit)


def _finest_cell(low: F64, high: F64, max_probes: int) -> tuple[float, I64]:
    """Edge of the finest cell in metres, and how many coarse cells lie along each axis."""
    extent = np.maximum(high - low, 1e-3 * float((high - low).max()))
    n_coarse = max(max_probes * _COARSE_SHARE, 1.0)
    coarse_m = float((np.prod(extent) / n_coarse) ** (1.0 / 3.0))
    shape = np.maximum(np.ceil(extent / coarse_m - 0.25), 1).astype(np.int64)
    while np.prod(shape + 1) > max_probes and shape.max() > 1:
        coarse_m *= 1.25
        shape = np.maximum(np.ceil(extent / coarse_m - 0.25), 1).astype(np.int64)
    return coarse_m / (1 << LEVELS), shape


class _KnownPlaces:
    """Validity and quick light of corners, each found once."""

    def __init__(self, world: World, origin: F64, unit: float, gather: QuickGather) -> None:
        self._world, self._origin, self._unit, self._gather = world, origin, unit, gather
        self.key = np.zeros((0,), np.int64)
        self.valid = np.zeros((0,), np.bool_)
        self.light = np.zeros((0, 6, 3), np.float32)

    def look_up(self, corners: I64) -> NDArray[np.intp]:
        """Row of each corner (…, 3), having looked at the new ones."""
        keys = pack(corners)
        new = np.setdiff1d(keys.ravel(), self.key)
        if len(new):
            places = (self._origin + unpack(new) * self._unit).astype(np.float32)
            valid = quick_validity(self._world, places) >= 1.0 - MAX_BACKS
            light = np.zeros((len(new), 6, 3), np.float32)
            if valid.any():
                axes = np.concatenate([np.eye(3), -np.eye(3)])
                series = self._gather(places[valid], np.full(int(valid.sum()), self._unit, np.float32))
                light[valid] = irradiance(series[:, None], axes)
            order = np.argsort(np.concatenate([self.key, new]), kind="stable")
            self.key = np.concatenate([self.key, new])[order]
            self.valid = np.concatenate([self.valid, valid])[order]
            self.light = np.concatenate([self.light, light])[order]
        return np.searchsorted(self.key, keys)


def pack(corners: I64) -> I64:
    """One number for three coordinates of 0 to 2²⁰ − 1, x the most significant."""
    return (corners[..., 0] << 40) | (corners[..., 1] << 20) | corners[..., 2]


def unpack(keys: I64) -> I64:
    """See :func:`pack`."""
    mask = (1 << 20) - 1
    return np.stack([keys >> 40, keys >> 20 & mask, keys & mask], axis=-1)


def _scores(leaves: _Leaves, known: _KnownPlaces, surface: I64) -> F64:
    """(C,) how much a leaf wants to be split; 0 where not at all."""
    rows = known.look_up(leaves.corners())
    valid = known.valid[rows]
    light = known.light[rows].astype(np.float64)
    counts = valid & (valid.sum(axis=1) >= 2)[:, None]
    brightest = np.where(counts[..., None, None], light, 0.0).max(axis=1)
    dimmest = np.where(counts[..., None, None], light, brightest[:, None]).min(axis=1)
    usual = float(known.light[known.valid].mean()) if known.valid.any() else 0.0
    spread, typical = brightest - dimmest, 0.5 * (brightest + dimmest) + 0.05 * usual + 1e-20
    change = (spread / typical).mean(axis=(1, 2))
    near = _holds_surface(leaves, surface)
    score = change + _SURFACE_SCORE * near
    return np.where((valid.any(axis=1) | near) & (near | (change > _SMALL_CHANGE)), score, 0.0)


def _holds_surface(leaves: _Leaves, surface: I64) -> NDArray[np.bool_]:
    """(C,) whether any surface sample lies in the leaf."""
    holds = np.zeros(len(leaves.low), np.bool_)
    limit = 1 << 20
    inside = surface[np.all((surface >= 0) & (surface < limit), axis=1)]
    for level in np.unique(leaves.level):
        shift = LEVELS - int(level)
        own = leaves.level == level
        holds[own] = np.isin(pack(leaves.low[own] >> shift), np.unique(pack(inside >> shift)))
    return holds


def _split(leaves: _Leaves, score: F64, max_probes: int) -> _Leaves:
    """Splits the leaves of highest score, as many as ``max_probes`` corners allow."""
    order = np.argsort(-score * leaves.size, kind="stable")
    order = order[score[order] > 0.0][: max((max_probes - leaves.n_corners) // _NEW_CORNERS, 0)]
    while True:
        split = np.zeros(len(score), np.bool_)
        split[order] = True
        half = leaves.size[split] >> 1
        children = leaves.low[split][:, None] + CORNERS * half[:, None, None]
        level = np.repeat(leaves.level[split] + 1, 8)
        result = _Leaves(
            np.concatenate([leaves.low[~split], children.reshape(-1, 3)]),
            np.concatenate([leaves.level[~split], level]),
        )
        if len(order) == 0 or result.n_corners <= max_probes:
            return result
        order = order[: len(order) * 3 // 4]


def _finish(leaves: _Leaves, known: _KnownPlaces, origin: F64, unit: float) -> Placement:
    """Numbers the corners; leaves that are solid throughout are dropped."""
    rows = known.look_up(leaves.corners())
    lives = known.valid[rows].any(axis=1)
    leaves, rows = _Leaves(leaves.low[lives], leaves.level[lives]), rows[lives]
    used = np.unique(rows)
    number = np.zeros(len(known.key), np.uint32)
    number[used] = np.arange(len(used), dtype=np.uint32)
    spacing = np.full(len(known.key), 0, np.int64)
    np.maximum.at(spacing, rows.ravel(), np.repeat(leaves.size, 8))
    cells = np.concatenate([leaves.low >> (LEVELS - leaves.level)[:, None], leaves.level[:, None]], axis=1)
    order = np.lexsort((pack(cells[:, :3]), cells[:, 3]))
    tree = ProbeOctree(
        origin.astype(np.float32), unit * (1 << LEVELS), cells[order].astype(np.int32), number[rows][order]
    )
    positions = (origin + unpack(known.key[used]) * unit).astype(np.float32)
    return Placement(positions, (spacing[used] * unit).astype(np.float32), tree)
