"""A scene made ready to be sampled: its light as asked for, its space, and what its surfaces shine with."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from irradia.bake.datasets.options import SampleOptions
from irradia.bake.setup import lights_in_mode
from irradia.core.progress import Progress, silent_progress
from irradia.formats.sample_rows import Quantity
from irradia.scene.layout import LightmapLayout
from irradia.scene.merge import MergedMesh, merge
from irradia.scene.types import F32, Scene

if TYPE_CHECKING:
    from irradia.transport.path import LightCache
    from irradia.transport.world import World

F64 = NDArray[np.float64]

_MARGIN = 1e-4  # of the longest side: what rounding may take a point out of the box


@dataclass(frozen=True)
class BakedPages:
    """A finished lightmap of all light.

    Attributes:
        layout: Where charts lie.
        pages: (P, H, W, 3) E/π, dilated; the first bounce of every light is in it.
    """

    layout: LightmapLayout
    pages: F32


@dataclass(frozen=True)
class Setting:
    """What places and their light are drawn from.

    Attributes:
        world: The scene, its lights in the part that the quantity gives them.
        mesh: Its merged mesh.
        cache: What surfaces shine with, or None where paths go on.
        surface_box: (2, 3) around all surfaces, metres.
        space_box: (2, 3) where people and objects may be: a room's inside, or an open scene and a
            little around it.
    """

    world: World
    mesh: MergedMesh
    cache: LightCache | None
    surface_box: F64
    space_box: F64


def set_up(
    scene: Scene, options: SampleOptions, lightmap: BakedPages | None, progress: Progress | None = None
) -> Setting:
    """Uploads the scene.

    Args:
        scene: With its lights, as it is.
        options: Which light is asked for.
        lightmap: Of all light; None traces whole paths.
        progress: Shows the stage "sampling set-up".
    """
    from irradia.bake.probes.bounds import probe_box
    from irradia.transport.render import DisplayCache
    from irradia.transport.world import World

    with (progress or silent_progress()).stage("sampling set-up"):
        layout = lightmap.layout if lightmap else None
        mesh = merge(scene, layout)
        page_size = (layout.width_px, layout.height_px) if layout else None
        world = World(in_quantity(scene, options.quantity), mesh, page_size, robust=not options.fast_rays)
        cache = DisplayCache(lightmap.pages) if lightmap else None
        corners = mesh.positions[np.unique(mesh.indices)].astype(np.float64)
        surfaces = np.stack([corners.min(axis=0), corners.max(axis=0)])
        return Setting(world, mesh, cache, _padded(surfaces), _padded(np.stack(probe_box(world, mesh))))


def in_quantity(scene: Scene, quantity: Quantity) -> Scene:
    """The scene whose lights' first bounce counts where the quantity says so.

    ``indirect`` is what ``irradia bake --mode indirect`` makes it; ``full`` is everything, also the first
    bounce of lights that an engine would draw.
    """
    return replace(
        scene, lights=lights_in_mode(scene.lights, "indirect" if quantity == "indirect" else "direct")
    )


def _padded(box: F64) -> F64:
    """Wide enough for points on its faces, also where it is flat."""
    margin = _MARGIN * max(float((box[1] - box[0]).max()), 1e-6)
    return box + np.array([[-margin], [margin]])
