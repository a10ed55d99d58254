"""Places in space to judge a field at: drawn at random and path-traced, or those of a dataset."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from irradia import __version__
from irradia.bake.datasets import SampleOptions, set_up
from irradia.bake.datasets.nearest import NearestSurface
from irradia.cli.eval_options import EvalJob, SpaceOptions
from irradia.core.cache import cached_arrays
from irradia.core.errors import InputError
from irradia.core.progress import Progress
from irradia.core.rng import Seed
from irradia.core.sh import light_on
from irradia.field.evaluation import NEAR_WALL_M
from irradia.scene.fingerprint import fingerprint
from irradia.scene.merge import MergedMesh, merge
from irradia.scene.types import Scene

if TYPE_CHECKING:
    from irradia.bake.datasets import Setting
    from irradia.field.field import Field
    from irradia.formats.samples import SampleFile
    from irradia.transport.receivers import Receivers

F32 = NDArray[np.float32]
_VERSION = 2
_PLACES_AT_ONCE = 1 << 14
_HOPELESS = 64  # times as many places as are wanted near walls, and there are next to none


@dataclass(frozen=True)
class SpaceSamples:
    """E at places.

    Attributes:
        positions, normals: (N, 3) metres, unit.
        irradiance: (N, 3) W·m⁻².
        variance: (N,) of its mean over channels.
        wall_m: (N,) to the nearest surface that doesn't shine.
        lamp_m: (N,) to the nearest that does; inf where there is none.
        evenly: (N,) those that are spread evenly over free space; the others are near surfaces.
    """

    positions: F32
    normals: F32
    irradiance: F32
    variance: F32
    wall_m: NDArray[np.float64]
    lamp_m: NDArray[np.float64]
    evenly: NDArray[np.bool_]

    @property
    def beside_lamps(self) -> NDArray[np.bool_]:
        """(N,) places where light changes by the centimetre, walls or none."""
        return self.lamp_m <= NEAR_WALL_M


def space_samples(job: EvalJob, scene: Scene, field: Field, progress: Progress) -> SpaceSamples | None:
    """What to judge by, or None where nothing is asked for.

    Raises:
        InputError: The dataset's light isn't the field's.
    """
    if job.space.samples is not None:
        with progress.stage("dataset"):
            return _from_file(job, scene, field)
    if job.space.count == 0:
        return None
    key = _key(scene, field.frame.quantity, job.space, job.seed)
    kept = cached_arrays("space", key, lambda: _draw(job, scene, field.frame.quantity, progress))
    return SpaceSamples(**kept)


def _draw(job: EvalJob, scene: Scene, quantity: Any, progress: Progress) -> dict[str, NDArray]:
    """Half of the places evenly in free space, half within 5 cm of surfaces; whole paths from each."""
    from irradia.transport.point_light import gather_irradiance
    from irradia.transport.receivers import Receivers

    options = SampleOptions("volume", quantity=quantity, integrator="path", samples=job.space.rays)
    setting = set_up(scene, options, None, progress)
    seed = Seed(job.seed).child("space")
    with progress.stage("places in space"):
        evenly, near = _places(setting, job.space.count, seed)
        places = Receivers.join([evenly, near])
    values, variance = [], []
    step, light_seed = max((1 << 21) // options.samples, 1), seed.child("light").uint32()
    with progress.stage("light in space", len(places) * options.samples, "samples") as stage:
        for first in range(0, len(places), step):
            part = places.take(slice(first, first + step))
            found = gather_irradiance(setting.world, part, first, options.samples, light_seed, None)
            values.append(found.values)
            variance.append(found.variance)
            stage.advance(len(part) * options.samples)
    return {
        "positions": places.positions,
        "normals": places.normals,
        "irradiance": np.concatenate(values),
        "variance": np.concatenate(variance),
        **_distances(scene, setting.mesh, places.positions),
        "evenly": np.arange(len(places)) < len(evenly),
    }


def _places(setting: Setting, count: int, seed: Seed) -> tuple[Receivers, Receivers]:
    """Evenly spread, and near surfaces."""
    from irradia.bake.datasets.placement import random_free_places
    from irradia.transport.receivers import Receivers

    box, world = setting.space_box, setting.world
    n_near = count // 2
    evenly = random_free_places(world, box, count - n_near, seed.child("evenly"))
    surface, found, n_found, n_tried = NearestSurface(setting.mesh), [evenly.take(slice(0, 0))], 0, 0
    while n_found < n_near and n_tried < _HOPELESS * n_near:
        more = random_free_places(world, box, _PLACES_AT_ONCE, seed.child(f"near-{n_tried}"))
        close = more.take(surface.distance_m(more.positions) <= NEAR_WALL_M)
        found.append(close)
        n_found, n_tried = n_found + len(close), n_tried + _PLACES_AT_ONCE
    return evenly, Receivers.join(found).take(slice(0, n_near))


def _distances(scene: Scene, mesh: MergedMesh, positions: F32) -> dict[str, NDArray[np.float64]]:
    """(N,) metres to what doesn't shine and to what does."""
    shines = np.array([max(material.emission) > 0.0 for material in scene.materials], np.bool_)[mesh.material]
    found = {}
    for name, chosen in (("wall_m", ~shines), ("lamp_m", shines)):
        lod = None if mesh.lod is None else mesh.lod[chosen]
        part = replace(mesh, indices=mesh.indices[chosen], lod=lod)
        nothing = np.full(len(positions), np.inf)
        found[name] = NearestSurface(part).distance_m(positions) if chosen.any() else nothing
    return found


def _key(scene: Scene, quantity: str, options: SpaceOptions, seed: int) -> dict[str, Any]:
    versions = {"version": _VERSION, "irradia": __version__}
    asked = {"quantity": quantity, "count": options.count, "rays": options.rays, "seed": seed}
    return {**versions, "scene": fingerprint(scene), **asked}


def _from_file(job: EvalJob, scene: Scene, field: Field) -> SpaceSamples:
    from irradia.formats.samples import open_samples

    path = job.space.samples
    if path is None:
        raise ValueError("no dataset was given")
    file = open_samples(path, job.space.bin_samples)
    if file.info.quantity != field.frame.quantity:
        raise InputError(
            f"expected samples of {field.frame.quantity} light as the field holds, "
            f"found {file.info.quantity}",
            where=str(path),
        )
    positions = np.ascontiguousarray(file.positions, np.float32)
    normals, values = _light_of(file, Seed(job.seed).child("normals"))
    evenly = np.ones(len(positions), np.bool_)
    distances = _distances(scene, merge(scene), positions)
    return SpaceSamples(positions, normals, values, np.array(file.variance), evenly=evenly, **distances)


def _light_of(file: SampleFile, seed: Seed) -> tuple[F32, F32]:
    """Normals and E: of coefficients under random normals."""
    if file.normals is not None:
        return np.array(file.normals, np.float32), np.array(file.values, np.float32)
    normals = seed.numpy().standard_normal((len(file), 3)).astype(np.float32)
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    light = light_on(file.values.reshape(len(file), -1, 3), normals)
    return normals, light.astype(np.float32)
