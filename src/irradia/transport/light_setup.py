"""From a scene to its lights: which sources there are, and how they are chosen among."""

from __future__ import annotations

from typing import Literal

import numpy as np

from irradia.scene.emission import triangle_emission
from irradia.scene.merge import MergedMesh
from irradia.scene.types import Light, Scene
from irradia.transport.emissive import EmissiveTriangles
from irradia.transport.environment_light import EnvironmentLight
from irradia.transport.light_choice import FixedChoice, LightChoice, TreeChoice, emitter_bounds
from irradia.transport.lights import DistantLights, Lights
from irradia.transport.punctual import PunctualLights

Selection = Literal["auto", "fixed", "tree"]
_TREE_FROM = 4  # local sources; below, going down a tree costs more than it saves


def make_lights(scene: Scene, mesh: MergedMesh, selection: Selection = "auto") -> Lights:
    """All sources of a scene; lights that are ``off`` or black have no part.

    Args:
        scene: Lights, materials and environment.
        mesh: Its merged mesh.
        selection: How local sources are chosen: ``tree`` by what they may send to the receiver,
            ``fixed`` the same for all receivers (lights alike, triangles by power); ``auto`` takes
            the tree where there are enough of them.
    """
    on = [i for i, light in enumerate(scene.lights) if light.mode != "off" and max(light.intensity) > 0.0]
    distant = [i for i in on if scene.lights[i].kind == "directional"]
    local_lights = np.array([i for i in on if scene.lights[i].kind != "directional"], np.uint32)
    radiance = triangle_emission(scene, mesh)
    area = EmissiveTriangles(mesh, radiance) if radiance.any() else None
    local, n_kinds = _local_choice(scene, mesh, local_lights, area, selection)
    lit = scene.environment is not None and scene.environment.radiance.max() > 0.0
    return Lights(
        punctual=PunctualLights(scene.lights) if on else None,
        distant=_distant(scene.lights, distant) if distant else None,
        local=local,
        area=area,
        environment=EnvironmentLight(scene.environment) if lit and scene.environment else None,
        n_local_kinds=n_kinds,
    )


def _local_choice(
    scene: Scene,
    mesh: MergedMesh,
    local_lights: np.ndarray,
    area: EmissiveTriangles | None,
    selection: Selection,
) -> tuple[LightChoice | None, int]:
    """The choice, and how many kinds of source it stands for."""
    n_sources = len(local_lights) + (len(area.triangles) if area else 0)
    if n_sources == 0:
        return None, 1
    if selection == "fixed" or n_sources < (_TREE_FROM if selection == "auto" else 2):
        return FixedChoice(local_lights, area), int(len(local_lights) > 0) + int(area is not None)
    double_sided = np.array([material.double_sided for material in scene.materials], np.bool_)[mesh.material]
    triangles = emitter_bounds(mesh.positions[mesh.indices], area, double_sided)
    return TreeChoice(scene.lights, local_lights, area, triangles, len(mesh.indices)), 1


def _distant(lights: tuple[Light, ...], indices: list[int]) -> DistantLights:
    return DistantLights(tuple(indices), tuple(float(np.mean(lights[i].intensity)) for i in indices))
