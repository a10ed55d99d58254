"""Files whose objects already share one page: their uv is the page's, and stays where it is.

Artists lay out several objects on one sheet, and a scene that Irradia baked comes back like that.
A rectangle for each object would then be mostly empty.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from irradia.scene.layout import LightmapLayout, Unwrap
from irradia.scene.lightmap_uv.charts import triangle_areas
from irradia.scene.lightmap_uv.options import LayoutOptions
from irradia.scene.lightmap_uv.receivers import Receiver
from irradia.scene.lightmap_uv.validate import MAX_OVERLAP_SHARE, overlap_share
from irradia.scene.types import Scene

_MULTIPLE_PX = 4  # of page edges: block compression


def shares_one_page(receivers: Sequence[Receiver]) -> bool:
    """Whether several primitives, each standing once, have uv of their own that don't overlap."""
    if len(receivers) < 2 or not all(r.from_file and len(r.instances) == 1 for r in receivers):
        return False
    first = np.cumsum([0, *(len(r.charts.uv) for r in receivers[:-1])])
    uv = np.concatenate([r.charts.uv for r in receivers])
    indices = np.concatenate([r.charts.indices + n for r, n in zip(receivers, first, strict=True)])
    return overlap_share(uv, indices.astype(np.uint32)) <= MAX_OVERLAP_SHARE


def shared_layout(
    scene: Scene, receivers: Sequence[Receiver], options: LayoutOptions, notes: Sequence[str]
) -> LightmapLayout:
    """One page on which every uv means what it says."""
    edge = _edge_px(receivers, options)
    unwraps = {
        r.primitive: Unwrap(r.charts.vertex_source, r.charts.indices, r.charts.uv, r.charts.chart)
        for r in receivers
    }
    page = np.full(len(scene.instances), -1, np.int32)
    page[[r.instances[0] for r in receivers]] = 0
    density = edge / _metres_per_uv(receivers)
    choice = f"lightmap: 1 page of {edge} × {edge} texels, {density:.3g} per metre, as the file lays it out"
    return LightmapLayout(
        n_pages=1,
        width_px=edge,
        height_px=edge,
        unwraps=tuple(unwraps.get(p) for p in range(len(scene.primitives))),
        page=page,
        scale=np.ones((len(scene.instances), 2), np.float32),
        offset=np.zeros((len(scene.instances), 2), np.float32),
        texels_per_metre=density,
        notes=(choice, *notes),
    )


def _metres_per_uv(receivers: Sequence[Receiver]) -> float:
    """Median over objects."""
    spans = [r.median_metres_per_uv for r in receivers if r.median_metres_per_uv > 0]
    return float(np.median(spans)) if spans else 1.0


def _edge_px(receivers: Sequence[Receiver], options: LayoutOptions) -> int:
    """As asked, or so that the surfaces cover about the texels that a page of our own would give."""
    if options.resolution is not None:
        return options.resolution
    if options.texels_per_metre is not None:
        wanted = options.texels_per_metre * _metres_per_uv(receivers)
    else:
        fill = sum(triangle_areas(r.charts.uv, r.charts.indices).sum() for r in receivers)
        wanted = np.sqrt(0.6 * options.default_texels / max(fill, 1e-6))
    edge = int(np.ceil(min(wanted, options.max_page_px) / _MULTIPLE_PX)) * _MULTIPLE_PX
    return max(edge, _MULTIPLE_PX)
