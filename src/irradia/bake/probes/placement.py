"""Where probes stand: in a grid, or spread at random over free space. The octree has its own file."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from irradia.bake.probes.options import MAX_PROBES, ProbeOptions
from irradia.bake.probes.survey import MAX_BACKS, quick_validity
from irradia.core.errors import InputError
from irradia.core.progress import Stage
from irradia.core.rng import Seed
from irradia.formats.probes import ProbeGrid, ProbeOctree

if TYPE_CHECKING:
    from irradia.transport.world import World

F32 = NDArray[np.float32]
F64 = NDArray[np.float64]

_CANDIDATES_AT_ONCE = 1 << 14
_MAX_CANDIDATES = 64  # for each probe that is asked for: below 1/64 of free space, something is wrong
# The generalised golden ratio in three dimensions (Roberts 2018, "The Unreasonable Effectiveness of
# Quasirandom Sequences"): g⁴ = g + 1.
_R3 = np.array([0.8191725133961645, 0.6710436067037893, 0.5497004779019703])


@dataclass(frozen=True)
class Placement:
    """Where probes stand.

    Attributes:
        positions: (N, 3) metres.
        spacing_m: (N,) to a neighbour.
        structure: What interpolation will go by.
    """

    positions: F32
    spacing_m: F32
    structure: ProbeGrid | ProbeOctree | None


def place_grid(low: F64, high: F64, spacing_m: float) -> Placement:
    """A lattice centred in a box, its outermost probes about half a spacing inside.

    Raises:
        InputError: It would have more than MAX_PROBES probes.
    """
    shape = np.maximum(np.round((high - low) / spacing_m), 1.0)
    if float(np.prod(shape)) > MAX_PROBES:
        nx, ny, nz = (int(v) for v in shape)
        wider = spacing_m * (float(np.prod(shape)) / MAX_PROBES) ** (1.0 / 3.0)
        raise InputError(
            f"expected at most {MAX_PROBES} probes, a grid of {nx} × {ny} × {nz} has {nx * ny * nz}",
            where="--probes",
            fix=f"Use a spacing of at least {wider:.2g} m.",
        )
    nx, ny, nz = (int(v) for v in shape)
    origin = 0.5 * (low + high) - 0.5 * (shape - 1.0) * spacing_m
    z, y, x = np.meshgrid(np.arange(nz), np.arange(ny), np.arange(nx), indexing="ij")
    index = np.stack([x.ravel(), y.ravel(), z.ravel()], axis=1)
    grid = ProbeGrid(origin.astype(np.float32), np.full(3, spacing_m, np.float32), (nx, ny, nz))
    positions = (grid.origin + index * grid.spacing).astype(np.float32)
    return Placement(positions, np.full(len(positions), spacing_m, np.float32), grid)


def place_random(
    world: World, low: F64, high: F64, options: ProbeOptions, seed: Seed, stage: Stage
) -> Placement:
    """Probes spread evenly over the free part of a box: a low-discrepancy sequence, walls left out.

    Raises:
        InputError: There is next to no free space.
    """
    start = seed.numpy().random(3)
    kept: list[F32] = []
    found, tried = 0, 0
    n_at_once = min(_CANDIDATES_AT_ONCE, 2 * options.count + 64)
    while found < options.count:
        if tried > _MAX_CANDIDATES * options.count + _CANDIDATES_AT_ONCE:
            raise InputError(
                f"expected free space for {options.count} probes, found room for {found}",
                where="--probes",
                fix="Check that the scene's surfaces face the space that is lit.",
            )
        index = np.arange(tried + 1, tried + 1 + n_at_once)[:, None]
        unit = (start + index * _R3) % 1.0
        candidates = (low + unit * (high - low)).astype(np.float32)
        free = candidates[quick_validity(world, candidates) >= 1.0 - MAX_BACKS]
        kept.append(free)
        tried += n_at_once
        stage.advance(min(len(free), options.count - found))
        found += len(free)
    positions = np.concatenate(kept)[: options.count]
    free_volume = float(np.prod(high - low)) * found / tried
    spacing_m = (free_volume / options.count) ** (1.0 / 3.0)
    return Placement(positions, np.full(len(positions), spacing_m, np.float32), None)
