"""What surfaces shine with while a scene is sampled: a lightmap of all light."""

from __future__ import annotations

from irradia.bake.datasets.setting import BakedPages, in_quantity
from irradia.bake.lightmap import bake_lightmap
from irradia.bake.options import BakeOptions
from irradia.core.progress import Progress
from irradia.scene.lightmap_uv import LayoutOptions, layout_lightmap
from irradia.scene.types import Scene


def bake_all_light(
    scene: Scene, layout: LayoutOptions, progress: Progress, *, seed: int = 0, fast_rays: bool = False
) -> BakedPages:
    """Bakes a lightmap that holds the first bounce of every light, also of those that are lit live.

    Raises:
        InputError: Nothing in the scene takes a lightmap.
    """
    where = layout_lightmap(scene, layout, progress)
    options = BakeOptions(seed=seed, fast_rays=fast_rays)
    return BakedPages(where, bake_lightmap(in_quantity(scene, "full"), where, options, progress).pages)
