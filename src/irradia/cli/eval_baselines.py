"""What else could hold a scene's light in as many bytes: grids of probes, and a lightmap."""

from __future__ import annotations

import contextlib
import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from irradia import __version__
from irradia.core.cache import cached_path
from irradia.core.errors import InputError
from irradia.core.progress import Progress
from irradia.field.baselines import ShGrid, probe_bytes, spacing_for
from irradia.formats.probes import ProbeGrid, ProbeSet, read_probes, write_probes
from irradia.scene.fingerprint import fingerprint
from irradia.scene.merge import merge
from irradia.scene.types import Scene

if TYPE_CHECKING:
    from irradia.transport.render import BakedLight

F32 = NDArray[np.float32]
_VERSION = 1
_RAYS_PER_PROBE = 1024
_SIGHT_BYTES = 16 * 16 * 2 * 2  # the octahedral map of distances beside each probe, in halves
_LIGHTMAP_SAMPLES = 256
MOST_BYTES = 4 << 20  # of a baseline: below it stays the number of probes that a grid may have
_SIGHTED_SPP = 4
_SMALLEST_EDGE = 32
_LEAST_BYTES = {
    "sh1": probe_bytes(1),
    "sh2": probe_bytes(2),
    "visibility": probe_bytes(2) + _SIGHT_BYTES,
    "lightmap": 4 * _SMALLEST_EDGE**2,
}


@dataclass(frozen=True)
class Baseline:
    """Light at any place from something other than a field.

    Attributes:
        key: Its name on the command line; ``field`` of the field itself.
        name: For people.
        n_bytes: As shipped.
        irradiance: E (N, 3) at positions and normals; None where it knows only surfaces.
        lightmap: To render from; None where it knows space.
        most_spp: Samples per pixel of its pictures at most: what answers slowly has rougher edges.
    """

    key: str
    name: str
    n_bytes: int
    irradiance: Callable[[F32, F32], F32] | None = None
    lightmap: BakedLight | None = None
    most_spp: int = 1 << 20


def make_baseline(key: str, scene: Scene, n_bytes: int, progress: Progress, seed: int) -> Baseline | None:
    """One of :data:`BASELINES`, or None where so few bytes can't hold it or so many would take too long."""
    if n_bytes > MOST_BYTES:
        progress.say(f"note: no baseline {key} of {n_bytes:,} bytes: more than {MOST_BYTES:,} take too long")
        return None
    if n_bytes < _LEAST_BYTES[key]:
        progress.say(f"note: {n_bytes} bytes are too few for the baseline {key}")
        return None
    if key == "lightmap":
        return _lightmap_if_charts_fit(scene, n_bytes, progress, seed)
    if key == "visibility":
        return sighted_grid(scene, n_bytes, progress, seed)
    return sh_grid(scene, int(key.removeprefix("sh")), n_bytes, progress, seed)


def sh_grid(scene: Scene, order: int, n_bytes: int, progress: Progress, seed: int = 0) -> Baseline:
    """A lattice of probes of SH to an order, read trilinearly."""
    probes = _probes(scene, n_bytes // probe_bytes(order), progress, seed)
    grid = ShGrid.of(*_lattice(probes), probes.coefficients, order)
    return Baseline(f"sh{order}", f"SH L{order} grid, {_by(probes)}", grid.n_bytes, grid.irradiance)


def sighted_grid(scene: Scene, n_bytes: int, progress: Progress, seed: int = 0) -> Baseline:
    """A lattice of probes of SH L2 with the distances that they see, which weigh them."""
    from irradia.bake.probes.interpolation import irradiance_at

    each = probe_bytes(2) + _SIGHT_BYTES
    probes = _probes(scene, n_bytes // each, progress, seed)

    def irradiance(positions: F32, normals: F32) -> F32:
        found = irradiance_at(
            probes, positions.astype(np.float64), normals.astype(np.float64), on_surface=False
        )
        return found.astype(np.float32)

    name = f"SH L2 grid with visibility, {_by(probes)}"
    return Baseline("visibility", name, each * len(probes), irradiance, most_spp=_SIGHTED_SPP)


def small_lightmap(scene: Scene, n_bytes: int, progress: Progress, seed: int = 0) -> Baseline:
    """A lightmap baked at the size at which its RGB9E5 texels, packed with zstd, take as many bytes."""
    edge = math.isqrt(n_bytes // 4)
    baked, size = _baked(scene, edge, progress, seed)
    better = round(edge * math.sqrt(n_bytes / size))
    if better > edge:
        edge = better
        baked, size = _baked(scene, edge, progress, seed)
    return Baseline("lightmap", f"lightmap, {edge}²", size, lightmap=baked)


def _lightmap_if_charts_fit(scene: Scene, n_bytes: int, progress: Progress, seed: int) -> Baseline | None:
    try:
        return small_lightmap(scene, n_bytes, progress, seed)
    except InputError as error:
        if error.where != "--resolution":
            raise
        progress.say(f"note: no lightmap of {n_bytes:,} bytes: {error.message}")
        return None


def _baked(scene: Scene, edge: int, progress: Progress, seed: int) -> tuple[BakedLight, int]:
    from irradia.bake.lightmap import start_bake
    from irradia.bake.options import BakeOptions
    from irradia.formats.ktx2 import encode_ktx2
    from irradia.scene.lightmap_uv import LayoutOptions, layout_lightmap
    from irradia.transport.render import BakedLight

    layout = layout_lightmap(scene, LayoutOptions(resolution=edge), progress)
    bake = start_bake(scene, layout, BakeOptions(samples=_LIGHTMAP_SAMPLES, seed=seed), progress)
    for _ in bake.passes(progress):
        pass
    result = bake.result(progress)
    pages = result.pages if result.all_light is None else result.all_light
    return BakedLight(layout, pages), len(encode_ktx2(pages, "rgb9e5"))


def _probes(scene: Scene, n_probes: int, progress: Progress, seed: int) -> ProbeSet:
    """Baked probes in a lattice, or those in the cache; a damaged or unwritable one does no harm."""
    from irradia.bake.probes import bake_probes
    from irradia.bake.probes.options import ProbeOptions

    path = cached_path("probes", _key(scene, n_probes, seed), ".npz")
    if path.exists():
        with contextlib.suppress(OSError, InputError):
            return read_probes(path)
    low, high = _box(scene)
    spacing_m = spacing_for(high - low, n_probes)
    options = ProbeOptions("grid", spacing_m, samples=_RAYS_PER_PROBE, seed=seed)
    probes = bake_probes(scene, None, None, options, progress)
    with contextlib.suppress(OSError):
        write_probes(path, probes)
    return probes


def _box(scene: Scene) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    from irradia.bake.probes.bounds import probe_box
    from irradia.transport.world import World

    mesh = merge(scene)
    return probe_box(World(scene, mesh), mesh)


def _key(scene: Scene, n_probes: int, seed: int) -> dict[str, Any]:
    key = {"version": _VERSION, "irradia": __version__, "scene": fingerprint(scene)}
    return {**key, "probes": n_probes, "rays": _RAYS_PER_PROBE, "seed": seed}


def _lattice(probes: ProbeSet) -> tuple[F32, F32, tuple[int, int, int]]:
    grid = probes.structure
    if not isinstance(grid, ProbeGrid):
        raise TypeError("these probes were not placed in a lattice")
    return grid.origin, grid.spacing, grid.shape


def _by(probes: ProbeSet) -> str:
    return " × ".join(str(n) for n in _lattice(probes)[2])
