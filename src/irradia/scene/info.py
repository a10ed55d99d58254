"""What a scene holds, in numbers: everything that ``irradia info`` prints."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from irradia.scene.light_estimate import SourceEstimate, contrast_warning, estimate_sources
from irradia.scene.merge import MergedMesh, merge
from irradia.scene.surface import triangle_areas
from irradia.scene.types import Material, Rgb, Scene


@dataclass(frozen=True)
class SceneFacts:
    """A scene's inventory.

    Attributes:
        n_primitives, n_vertices: As stored; an instanced primitive counts once.
        n_instances, n_triangles: As traced, every instance counted.
        bounds_min_m, bounds_max_m: World-space box; zeros where there is nothing.
        surface_area_m2: Of all instances, one side of each triangle.
        alpha_mask, alpha_blend, transmissive, emissive, unlit, double_sided: Names of the
            materials in use that are so (``material N`` where one has none).
        sources: Every light source, the strongest first.
        notes: What the importer remarked: what it ignored and why.
        warnings: What makes the bake unlikely to look as meant.
    """

    name: str
    n_primitives: int
    n_instances: int
    n_triangles: int
    n_vertices: int
    n_materials: int
    n_textures: int
    n_lights: int
    n_cameras: int
    bounds_min_m: Rgb
    bounds_max_m: Rgb
    surface_area_m2: float
    alpha_mask: tuple[str, ...]
    alpha_blend: tuple[str, ...]
    transmissive: tuple[str, ...]
    emissive: tuple[str, ...]
    unlit: tuple[str, ...]
    double_sided: tuple[str, ...]
    sources: tuple[SourceEstimate, ...]
    notes: tuple[str, ...]
    warnings: tuple[str, ...]


def scene_facts(scene: Scene) -> SceneFacts:
    """Counts, measures and estimates; no ray is traced."""
    mesh = merge(scene)
    low, high = _bounds(mesh)
    sources = estimate_sources(scene, mesh)
    used = sorted({scene.primitives[instance.primitive].material for instance in scene.instances})

    def named(holds: Callable[[Material], bool]) -> tuple[str, ...]:
        return tuple(_label(scene, index) for index in used if holds(scene.materials[index]))

    return SceneFacts(
        name=scene.name,
        n_primitives=len(scene.primitives),
        n_instances=len(scene.instances),
        n_triangles=scene.n_triangles,
        n_vertices=sum(len(primitive.positions) for primitive in scene.primitives),
        n_materials=len(scene.materials),
        n_textures=len(scene.images),
        n_lights=len(scene.lights),
        n_cameras=len(scene.cameras),
        bounds_min_m=low,
        bounds_max_m=high,
        surface_area_m2=float(triangle_areas(mesh).sum()),
        alpha_mask=named(lambda material: material.alpha_mode == "mask"),
        alpha_blend=named(lambda material: material.alpha_mode == "blend"),
        transmissive=named(lambda material: max(material.transmission, material.diffuse_transmission) > 0.0),
        emissive=named(_emits),
        unlit=named(lambda material: material.unlit),
        double_sided=named(lambda material: material.double_sided),
        sources=sources,
        notes=scene.notes,
        warnings=tuple(_warnings(sources)),
    )


def _emits(material: Material) -> bool:
    return max(material.emission) > 0.0


def _label(scene: Scene, material: int) -> str:
    return scene.materials[material].name or f"material {material}"


def _bounds(mesh: MergedMesh) -> tuple[Rgb, Rgb]:
    if len(mesh.indices) == 0:
        return (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
    used = mesh.positions[np.unique(mesh.indices)]
    low, high = used.min(axis=0).tolist(), used.max(axis=0).tolist()
    return (low[0], low[1], low[2]), (high[0], high[1], high[2])


def _warnings(sources: tuple[SourceEstimate, ...]) -> list[str]:
    if not any(source.mean_irradiance > 0.0 for source in sources):
        return ["no light source reaches a surface: the bake would be black"]
    warning = contrast_warning(sources)
    return [warning] if warning else []
