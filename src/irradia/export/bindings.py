"""Which node reads which part of the lightmap, and how many versions of a mesh that takes."""

from __future__ import annotations

from collections import Counter, defaultdict
from dataclasses import dataclass

import numpy as np

from irradia.scene.layout import LightmapLayout
from irradia.scene.types import F32, Scene


@dataclass(frozen=True)
class Binding:
    """How one primitive of one node reads the lightmap.

    Attributes:
        primitive: Index into ``Scene.primitives``.
        instances: Indices into ``Scene.instances``: one, or those of EXT_mesh_gpu_instancing.
        final: Whether page uv is written into the vertices, so that any loader finds it.
    """

    primitive: int
    instances: tuple[int, ...]
    final: bool

    @property
    def mesh_key(self) -> tuple[int, int | None]:
        """What the primitive's vertices depend on: nodes whose keys agree share a mesh."""
        return self.primitive, self.instances[0] if self.final else None


NodeBindings = dict[int, Binding]  # by index of the glTF primitive; those without lightmap are missing


def bind_nodes(
    scene: Scene, layout: LightmapLayout, node_of_instance: list[int], *, write_out: bool
) -> dict[int, NodeBindings]:
    """The bindings of each node that has any.

    Args:
        scene: As it was baked.
        layout: As it was baked.
        node_of_instance: The node that shows each instance.
        write_out: Whether every instance gets vertices of its own; each must have its own node.
    """
    lit = [i for i in range(len(scene.instances)) if _is_lit(scene, layout, i)]
    users = Counter(scene.instances[i].primitive for i in lit)
    grouped: dict[int, dict[int, list[int]]] = defaultdict(lambda: defaultdict(list))
    for index in lit:
        grouped[node_of_instance[index]][scene.instances[index].primitive].append(index)
    bound: dict[int, NodeBindings] = {}
    for node, primitives in grouped.items():
        bound[node] = {
            scene.primitives[p].primitive_index: Binding(p, tuple(members), write_out or users[p] == 1)
            for p, members in primitives.items()
        }
    return bound


def page_uv(layout: LightmapLayout, binding: Binding) -> F32 | None:
    """(V', 2) uv on the page for a final binding; None leaves the rectangle's own."""
    unwrap = layout.unwraps[binding.primitive]
    if not binding.final or unwrap is None:
        return None
    instance = binding.instances[0]
    return np.asarray(unwrap.uv * layout.scale[instance] + layout.offset[instance], np.float32)


def _is_lit(scene: Scene, layout: LightmapLayout, instance: int) -> bool:
    return layout.page[instance] >= 0 and layout.unwraps[scene.instances[instance].primitive] is not None
