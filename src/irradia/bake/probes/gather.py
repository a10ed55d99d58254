"""The probe bake: from a scene and its finished lightmap to probes that can be read anywhere."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from irradia.bake.probes.bounds import probe_box
from irradia.bake.probes.dilate import fill_invalid
from irradia.bake.probes.neighbours import neighbour_pairs
from irradia.bake.probes.octree import LEVELS, place_octree
from irradia.bake.probes.options import ProbeOptions
from irradia.bake.probes.placement import Placement, place_grid, place_random
from irradia.bake.probes.survey import Survey, survey
from irradia.bake.probes.window import window
from irradia.core.errors import InputError
from irradia.core.progress import Progress, Stage, silent_progress
from irradia.core.rng import Seed
from irradia.formats.probes import EMPTY, FILLED, NO_PROBE, VALID, ProbeOctree, ProbeSet
from irradia.scene.layout import LightmapLayout
from irradia.scene.merge import MergedMesh, merge
from irradia.scene.types import Scene

if TYPE_CHECKING:
    from irradia.transport.path import LightCache
    from irradia.transport.world import World

F32 = NDArray[np.float32]
_TURN = "Check that the scene's surfaces face the space that is lit."
_QUICK_SAMPLES = 64  # for where an octree needs probes
# Of the spacing: the mean of 1/r² over a ball around the probe is that at 1/√3 of its radius.
_LEAST_DISTANCE = 0.3


def bake_probes(
    scene: Scene,
    layout: LightmapLayout | None,
    pages: F32 | None,
    options: ProbeOptions,
    progress: Progress | None = None,
) -> ProbeSet:
    """Places probes, looks around from them, gathers their light and makes it fit for reading.

    Args:
        scene: With its lights.
        layout: Of the lightmap; None traces whole paths.
        pages: (P, H, W, 3) E/π of all light, dilated: what surfaces shine with. Where some lights are
            mixed or realtime, their direct light must be in it too, since it bounces.
        options: Which probes.
        progress: Shows the stages "probe places", "probe sight" and "probe light".

    Raises:
        InputError: The options ask for more probes than there may be, or there is no free space.
    """
    progress = progress or silent_progress()
    mesh, world, cache = _set_up(scene, layout, pages, options, progress)
    placement = _place(world, mesh, cache, options, progress)
    with progress.stage("probe sight", len(placement.positions), "probes") as stage:
        seen = survey(world, placement.positions, placement.spacing_m, stage)
    if isinstance(placement.structure, ProbeOctree):
        placement, seen = _without_buried(placement, placement.structure, seen)
    if not seen.valid.any():
        raise InputError("expected free space for probes, found none", where=scene.name, fix=_TURN)
    light = _gather(world, cache, placement, seen, options, progress)
    damped, strength = window(light)
    probes = _probe_set(scene, placement, seen, damped)
    with progress.stage("probes in walls"):
        pairs = neighbour_pairs(probes)
        filled, state = fill_invalid(world, probes.places, damped, seen.valid, pairs)
    stats = _stats(options, state, strength)
    return replace(probes, coefficients=filled, state=state, provenance=stats)


def _set_up(
    scene: Scene, layout: LightmapLayout | None, pages: F32 | None, options: ProbeOptions, progress: Progress
) -> tuple[MergedMesh, World, LightCache | None]:
    from irradia.transport.render import DisplayCache
    from irradia.transport.world import World

    with progress.stage("probe set-up"):
        mapped = layout is not None and pages is not None
        mesh = merge(scene, layout if mapped else None)
        size = (layout.width_px, layout.height_px) if layout is not None and mapped else None
        world = World(scene, mesh, size, robust=not options.fast_rays)
        cache = DisplayCache(pages) if pages is not None and mapped else None
    return mesh, world, cache


def _place(
    world: World, mesh: MergedMesh, cache: LightCache | None, options: ProbeOptions, progress: Progress
) -> Placement:
    seed = Seed(options.seed).child("probes")
    low, high = probe_box(world, mesh)
    if options.placement == "grid":
        return place_grid(low, high, options.spacing_m)
    if options.placement == "random":
        with progress.stage("probe places", options.count, "probes") as stage:
            return place_random(world, low, high, options, seed.child("places"), stage)

    def quick_gather(places: F32, spacing_m: F32) -> F32:
        return _gather_at(world, cache, places, spacing_m, _QUICK_SAMPLES, seed.child("quick"))

    with progress.stage("probe places", LEVELS, "rounds") as stage:
        return place_octree(world, mesh, low, high, options.count, quick_gather, stage)


def _without_buried(placement: Placement, tree: ProbeOctree, seen: Survey) -> tuple[Placement, Survey]:
    """Takes out of an octree the probes that no short way led out of something solid."""
    kept = np.flatnonzero(seen.valid)
    number = np.full(len(placement.positions), NO_PROBE, np.uint32)
    number[kept] = np.arange(len(kept), dtype=np.uint32)
    corners = number[tree.corners]
    lives = (corners != NO_PROBE).any(axis=1)
    tree = replace(tree, cells=tree.cells[lives], corners=corners[lives])
    rest = Survey(
        seen.offsets[kept], seen.validity[kept], seen.sky[kept], seen.distance[kept], seen.reach[kept]
    )
    return Placement(placement.positions[kept], placement.spacing_m[kept], tree), rest


def _gather(
    world: World,
    cache: LightCache | None,
    placement: Placement,
    seen: Survey,
    options: ProbeOptions,
    progress: Progress,
) -> F32:
    """(N, 9, 3) as traced; zeros for probes inside walls."""
    light = np.zeros((len(placement.positions), 9, 3), np.float32)
    valid = np.flatnonzero(seen.valid)
    places = (placement.positions + seen.offsets)[valid]
    seed = Seed(options.seed).child("probes").child("light")
    spacing_m = placement.spacing_m[valid]
    with progress.stage("probe light", len(valid) * options.samples, "samples") as stage:
        light[valid] = _gather_at(world, cache, places, spacing_m, options.samples, seed, stage)
    return light


def _gather_at(
    world: World,
    cache: LightCache | None,
    places: F32,
    spacing_m: F32,
    n_samples: int,
    seed: Seed,
    stage: Stage | None = None,
) -> F32:
    """(N, 9, 3) at places (N, 3)."""
    from irradia.transport.probe_light import gather_sh

    light = np.zeros((len(places), 9, 3), np.float32)
    least_m = _LEAST_DISTANCE * spacing_m
    for part, series in gather_sh(world, places, least_m, n_samples, seed.uint32(), cache):
        light[part] = series
        if stage is not None:
            stage.advance(len(series) * n_samples)
    return light


def _probe_set(scene: Scene, placement: Placement, seen: Survey, coefficients: F32) -> ProbeSet:
    live = any(light.mode in ("mixed", "realtime") for light in scene.lights)
    return ProbeSet(
        positions=placement.positions,
        offsets=seen.offsets,
        coefficients=coefficients,
        validity=seen.validity,
        state=np.where(seen.valid, VALID, EMPTY).astype(np.uint8),
        sky=seen.sky,
        distance=seen.distance,
        reach=seen.reach,
        light="indirect" if live else "full",
        structure=placement.structure,
    )


def _stats(options: ProbeOptions, state: NDArray[np.uint8], strength: NDArray[np.float64]) -> dict[str, Any]:
    return {
        "placement": options.placement,
        "samples_per_probe": options.samples,
        "seed": options.seed,
        "probes": len(state),
        "filled": int((state == FILLED).sum()),
        "empty": int((state == EMPTY).sum()),
        "windowed": int((strength > 0.0).sum()),
        "strongest_window": float(strength.max(initial=0.0)),
    }
