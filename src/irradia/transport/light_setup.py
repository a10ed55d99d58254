"""From a scene to its lights: which sources there are, and how they are chosen among."""

from __future__ import annotations

from typing import Literal

import numpy as np

from irradia.scene.emission import triangle_emission
from irradia.scene.environment import mean_radiance
from irradia.scene.merge import MergedMesh
from irradia.scene.surface import triangle_areas
from irradia.scene.types import Light, Scene
from irradia.transport.emissive import EmissiveTriangles
from irradia.transport.environment_light import EnvironmentLight
from irradia.transport.light_bounds import bounds_of_lights
from irradia.transport.light_choice import FixedChoice, LightChoice, TreeChoice, emitter_bounds
from irradia.transport.lights import DistantLights, Lights
from irradia.transport.punctual import PunctualLights

Selection = Literal["auto", "fixed", "tree"]
_TREE_FROM = 4  # local sources; below, going down a tree costs more than it saves
# Of all light. Below, the noise of local sources drowns in that of the sun and sky, and what the tree
# costs is lost: in the atrium, whose lanterns send 6e-4, a fifth of the time.
_LEAST_SHARE = 1e-3
_FAINT_WEIGHT = 1.0 / 3.0  # how often such sources are asked, against 1 for each other kind


def make_lights(scene: Scene, mesh: MergedMesh, selection: Selection = "auto") -> Lights:
    """All sources of a scene; lights that are ``off`` or black have no part.

    Args:
        scene: Lights, materials and environment.
        mesh: Its merged mesh.
        selection: How local sources are chosen: ``tree`` by what they may send to the receiver,
            ``fixed`` the same for all receivers (lights alike, triangles by power); ``auto`` takes
            the tree where there are enough of them and their light counts beside sun and sky.
    """
    on = [i for i, light in enumerate(scene.lights) if light.mode != "off" and max(light.intensity) > 0.0]
    distant = [i for i in on if scene.lights[i].kind == "directional"]
    local_lights = np.array([i for i in on if scene.lights[i].kind != "directional"], np.uint32)
    radiance = triangle_emission(scene, mesh)
    area = EmissiveTriangles(mesh, radiance) if radiance.any() else None
    faint = _local_share(scene, mesh, distant, local_lights, area) < _LEAST_SHARE
    if faint and selection == "auto":
        selection = "fixed"
    local, weight = _local_choice(scene, mesh, local_lights, area, selection)
    lit = scene.environment is not None and scene.environment.radiance.max() > 0.0
    return Lights(
        punctual=PunctualLights(scene.lights) if on else None,
        distant=_distant(scene.lights, distant) if distant else None,
        local=local,
        area=area,
        environment=EnvironmentLight(scene.environment) if lit and scene.environment else None,
        local_weight=_FAINT_WEIGHT if faint else weight,
    )


def _local_choice(
    scene: Scene,
    mesh: MergedMesh,
    local_lights: np.ndarray,
    area: EmissiveTriangles | None,
    selection: Selection,
) -> tuple[LightChoice | None, float]:
    """The choice, and how often it is asked: once for each kind of source that it doesn't weigh."""
    n_sources = len(local_lights) + (len(area.triangles) if area else 0)
    if n_sources == 0:
        return None, 0.0
    if selection == "fixed" or n_sources < (_TREE_FROM if selection == "auto" else 2):
        return FixedChoice(local_lights, area), float(len(local_lights) > 0) + float(area is not None)
    double_sided = np.array([material.double_sided for material in scene.materials], np.bool_)[mesh.material]
    triangles = emitter_bounds(mesh.positions[mesh.indices], area, double_sided)
    return TreeChoice(scene.lights, local_lights, area, triangles, len(mesh.indices)), 1.0


def _local_share(
    scene: Scene,
    mesh: MergedMesh,
    distant: list[int],
    local_lights: np.ndarray,
    area: EmissiveTriangles | None,
) -> float:
    """What part of the light on surfaces local sources send, by formula: their flux spread over all
    surfaces, and nothing in the way of sun and sky.
    """
    bounds = bounds_of_lights([scene.lights[i] for i in local_lights])
    flux = 2.0 * np.pi * (bounds.power * (1.0 - np.cos(bounds.spread))).sum()
    if area is not None:
        flux += np.pi * area.power.sum()
    local = flux / max(float(triangle_areas(mesh).sum()), 1e-20)
    others = sum(float(np.mean(scene.lights[i].intensity)) for i in distant) / 4.0
    if scene.environment is not None:
        others += np.pi * float(np.mean(mean_radiance(scene.environment)))
    return float(local / max(local + others, 1e-30))


def _distant(lights: tuple[Light, ...], indices: list[int]) -> DistantLights:
    return DistantLights(tuple(indices), tuple(float(np.mean(lights[i].intensity)) for i in indices))
