"""Which primitives take a lightmap, the charts they have, and how large they stand in the world."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from irradia.core.progress import Progress
from irradia.scene.lightmap_uv.charts import Charts, triangle_areas
from irradia.scene.lightmap_uv.unwrap import unwrap
from irradia.scene.lightmap_uv.validate import file_charts
from irradia.scene.types import F64, Instance, Primitive, Scene


@dataclass(frozen=True)
class Receiver:
    """A primitive with its charts and the instances that take a lightmap.

    Attributes:
        primitive: Index into ``Scene.primitives``.
        charts: uv in any unit.
        from_file: Whether the uv is the file's own, which stays as it is.
        instances: Indices into ``Scene.instances``.
        areas_m2: (K,) world area of each instance.
        metres_per_uv: (K,) world metres that one uv unit spans, times the object's lightmap scale;
            0 where the primitive has no area.
    """

    primitive: int
    charts: Charts
    from_file: bool
    instances: tuple[int, ...]
    areas_m2: F64
    metres_per_uv: F64

    @property
    def loose(self) -> bool:
        """Whether the charts may be moved one by one: they are ours, and for one instance only."""
        return not self.from_file and len(self.instances) == 1 and self.charts.n_charts > 0

    @property
    def median_metres_per_uv(self) -> float:
        """Over the instances that have an area; 0 where none has."""
        positive = self.metres_per_uv[self.metres_per_uv > 0]
        return float(np.median(positive)) if len(positive) else 0.0


def find_receivers(scene: Scene, progress: Progress, *, use_cache: bool) -> tuple[list[Receiver], list[str]]:
    """Charts for every primitive that takes a lightmap, and notes on the file's own uv sets."""
    users = _instances_by_primitive(scene)
    triangles = {p: len(scene.primitives[p].indices) for p in users}
    receivers, notes = [], []
    with progress.stage("unwrap", total=sum(triangles.values()), unit="tri") as stage:
        for primitive_index, instances in users.items():
            receiver, note = _receiver(scene, primitive_index, instances, use_cache)
            receivers.append(receiver)
            notes += [note] if note else []
            stage.advance(triangles[primitive_index])
    return receivers, notes


def _instances_by_primitive(scene: Scene) -> dict[int, list[int]]:
    users: dict[int, list[int]] = {}
    for index, instance in enumerate(scene.instances):
        primitive = scene.primitives[instance.primitive]
        if (
            instance.lightmap_scale > 0
            and not scene.materials[primitive.material].unlit
            and len(primitive.indices)
        ):
            users.setdefault(instance.primitive, []).append(index)
    return dict(sorted(users.items()))


def _receiver(
    scene: Scene, primitive_index: int, instances: list[int], use_cache: bool
) -> tuple[Receiver, str | None]:
    primitive = scene.primitives[primitive_index]
    placed = [scene.instances[i] for i in instances]
    areas = np.array([_world_area(primitive, instance) for instance in placed])
    charts, why_not = file_charts(primitive)
    from_file = charts is not None
    if charts is None:
        largest = placed[int(areas.argmax())]
        charts = unwrap(primitive, largest.world_from_object[:3, :3], use_cache=use_cache)
    uv_area = float(triangle_areas(charts.uv, charts.indices)[charts.solid].sum())
    scales = np.array([instance.lightmap_scale for instance in placed])
    receiver = Receiver(
        primitive=primitive_index,
        charts=charts,
        from_file=from_file,
        instances=tuple(instances),
        areas_m2=areas,
        metres_per_uv=np.sqrt(areas / uv_area) * scales if uv_area > 0 else np.zeros(len(areas)),
    )
    name = primitive.name or f"primitive {primitive_index}"
    return receiver, f"{name}: TEXCOORD_1 {why_not}, so it is unwrapped anew" if why_not else None


def _world_area(primitive: Primitive, instance: Instance) -> float:
    linear: NDArray = instance.world_from_object[:3, :3]
    return float(triangle_areas(primitive.positions.astype(np.float64) @ linear.T, primitive.indices).sum())
