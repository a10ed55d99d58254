"""Datasets, some rows at a time: places in random order of space, and the light that is gathered there."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from irradia.bake.datasets.options import SampleOptions
from irradia.bake.datasets.placement import FreePlaces, LatticePlaces, SurfacePlaces
from irradia.bake.datasets.setting import F64, Setting
from irradia.bake.datasets.supply import N_AT_ONCE, MixedPlaces, Places, batches
from irradia.core.rng import Seed
from irradia.formats.sample_rows import SampleInfo
from irradia.scene.types import F32

if TYPE_CHECKING:
    from irradia.transport.receivers import Receivers

ON_SURFACES = 0.2
"""Share of a volume's points that lie on surfaces, under their normals (Coomans et al. 2026)."""

_RAYS_PER_LAUNCH = {"cpu": 1 << 21, "cuda": 1 << 26}
_FEWEST_POINTS, _MOST_POINTS = 1 << 8, 1 << 16  # of a launch, however many samples each has


def sample_info(setting: Setting, options: SampleOptions, provenance: Mapping[str, Any]) -> SampleInfo:
    """What a file of these samples says of itself."""
    low, high = _box(setting, options).astype(np.float32).tolist()
    return SampleInfo(
        kind="sh" if options.is_sh else "volume" if options.placement == "volume" else "surface",
        aabb=(tuple(low), tuple(high)),
        quantity=options.quantity,
        n_coefficients=options.n_coefficients,
        samples_per_point=options.samples,
        provenance=provenance,
    )


def sample_rows(setting: Setting, options: SampleOptions, name: str = "train") -> Iterator[F32]:
    """Rows of a dataset as a file holds them, a few thousand at a time.

    Every prefix is an unbiased sample of the whole. What comes doesn't depend on the device's threads.

    Args:
        setting: From :func:`set_up`, with the same options but for placement, count and samples.
        options: What is asked for.
        name: Of the stream of random numbers; another name gives an independent dataset.

    Raises:
        InputError: There is no free space.
    """
    seed = Seed(options.seed).child("samples").child(name)
    places, count = make_places(setting, options, seed.child("places"))
    light_seed, first = seed.child("light").uint32(), 0
    for batch in batches(places, points_per_launch(options.samples), count):
        yield _rows(setting, options, batch, first, light_seed)
        first += len(batch)


def make_places(setting: Setting, options: SampleOptions, seed: Seed) -> tuple[Places, int | None]:
    """The supply of places, and how many are wanted; None where the supply ends by itself."""
    world, mesh, stratified = setting.world, setting.mesh, options.stratified
    if options.placement == "surface":
        return SurfacePlaces(world, mesh, seed, stratified=stratified), options.n_points
    if options.placement == "sh-grid":
        return LatticePlaces(world, setting.space_box, grid_spacing_m(setting, options)), None
    free = FreePlaces(world, setting.space_box, seed.child("space"), stratified=stratified)
    if options.placement == "sh-random":
        return free, options.n_points
    surfaces = SurfacePlaces(
        world, mesh, seed.child("surface"), stratified=stratified, within=setting.space_box
    )
    return MixedPlaces(free, surfaces, ON_SURFACES, seed.child("mix")), options.n_points


def grid_spacing_m(setting: Setting, options: SampleOptions) -> float:
    """As asked for, or so that the box has about as many sites as were asked for."""
    if options.spacing_m is not None:
        return options.spacing_m
    low, high = setting.space_box
    return float((np.prod(high - low) / options.n_points) ** (1.0 / 3.0))


def expected_points(setting: Setting, options: SampleOptions) -> int:
    """How many points there will be; of a grid about, by a look at free space."""
    if options.placement != "sh-grid":
        return options.n_points
    lattice = LatticePlaces(setting.world, setting.space_box, grid_spacing_m(setting, options))
    n_sites = lattice.n_left
    return round(n_sites * len(lattice.draw(N_AT_ONCE)) / min(n_sites, N_AT_ONCE))


def points_per_launch(n_samples: int) -> int:
    """So that every launch traces about as many rays, and none is long."""
    from irradia.transport.backend import device

    n_points = _RAYS_PER_LAUNCH[device.kind] // (2 * n_samples)
    return min(max(n_points, _FEWEST_POINTS), _MOST_POINTS)


def _box(setting: Setting, options: SampleOptions) -> F64:
    return setting.surface_box if options.placement == "surface" else setting.space_box


def _rows(setting: Setting, options: SampleOptions, batch: Receivers, first: int, seed: int) -> F32:
    from irradia.transport.point_light import gather_coefficients, gather_irradiance

    world, cache = setting.world, setting.cache
    if options.is_sh:
        found = gather_coefficients(
            world, batch.positions, first, options.samples, seed, cache, options.n_coefficients
        )
        where = [batch.positions]
    else:
        found = gather_irradiance(world, batch, first, options.samples, seed, cache)
        where = [batch.positions, batch.normals]
    values = found.values.reshape(len(batch), -1)
    return np.concatenate([*where, values, found.variance[:, None]], axis=1)
