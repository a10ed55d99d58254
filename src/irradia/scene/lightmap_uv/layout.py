"""Lightmap uv for a scene, from charts to pages."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from irradia.core.progress import Progress
from irradia.scene.layout import LightmapLayout, Unwrap
from irradia.scene.lightmap_uv.charts import triangle_areas
from irradia.scene.lightmap_uv.density import Plan, make_plan
from irradia.scene.lightmap_uv.options import LayoutOptions
from irradia.scene.lightmap_uv.pack import Placement
from irradia.scene.lightmap_uv.pieces import Piece
from irradia.scene.lightmap_uv.receivers import Receiver, find_receivers
from irradia.scene.lightmap_uv.shared import shared_layout, shares_one_page
from irradia.scene.types import Scene


def layout_lightmap(scene: Scene, options: LayoutOptions, progress: Progress) -> LightmapLayout:
    """Gives every instance that takes a lightmap its place on a page.

    The file's TEXCOORD_1 is kept where it lies in the unit square without overlap; everything else is
    unwrapped. Charts of a primitive that stands in one place are packed one by one; a primitive with
    several instances, or with uv of its own, has one rectangle for each; where all have uv of their
    own that don't overlap, that is the page. The same scene and options give the same bytes.

    Args:
        scene: Unlit materials and a lightmap scale of 0 take no lightmap.
        options: Density or resolution.
        progress: Shows the stages "unwrap" and "pack".

    Raises:
        InputError: The charts don't fit the resolution, or the density asks for too many texels.
    """
    receivers, notes = find_receivers(scene, progress, use_cache=options.use_cache)
    if not receivers:
        return _empty(scene, ("nothing in the scene takes a lightmap",))
    if shares_one_page(receivers):
        return shared_layout(scene, receivers, options, notes)
    with progress.stage("pack"):
        plan = make_plan(receivers, options)
    return _assemble(scene, receivers, plan, notes)


def _assemble(scene: Scene, receivers: Sequence[Receiver], plan: Plan, notes: list[str]) -> LightmapLayout:
    """Turns a plan in texels into unwraps and transforms in page uv."""
    unwraps: dict[int, Unwrap] = {}
    page_of = np.full(len(scene.instances), -1, np.int32)
    scale = np.ones((len(scene.instances), 2), np.float32)
    offset = np.zeros((len(scene.instances), 2), np.float32)
    reached: list[float] = []
    for page, piece, placement in _placements(plan):
        receiver = receivers[piece.receiver]
        instance = receiver.instances[piece.slot]
        page_of[instance] = page
        if receiver.loose:
            unwraps[receiver.primitive] = _loose_unwrap(receiver, placement, plan.edge_px)
        else:
            block = plan.blocks[piece.receiver]
            unwraps.setdefault(receiver.primitive, _unwrap(receiver, block.uv))
            scale[instance] = placement.scale[0] / plan.edge_px
            offset[instance] = placement.offset[0] / plan.edge_px
        if receiver.areas_m2[piece.slot] > 0:
            texels = _texels(unwraps[receiver.primitive], scale[instance] * plan.edge_px)
            reached.append(np.sqrt(texels / receiver.areas_m2[piece.slot]))
    median = float(np.median(reached)) if reached else 0.0
    return LightmapLayout(
        n_pages=len(plan.pages),
        width_px=plan.edge_px,
        height_px=plan.edge_px,
        unwraps=tuple(unwraps.get(p) for p in range(len(scene.primitives))),
        page=page_of,
        scale=scale,
        offset=offset,
        texels_per_metre=median,
        notes=(_choice(plan, median), *notes, *_remarks(scene, receivers, plan)),
    )


def _placements(plan: Plan) -> Iterator[tuple[int, Piece, Placement]]:
    """Page number, piece and place of everything."""
    for page, (pieces, packed) in enumerate(zip(plan.pieces, plan.pages, strict=True)):
        for piece, placement in zip(pieces, packed.placements, strict=True):
            yield page, piece, placement


def _loose_unwrap(receiver: Receiver, placement: Placement, edge_px: int) -> Unwrap:
    """Page uv itself, so that the instance's scale is 1 and its offset 0."""
    charts = receiver.charts
    px = placement.apply(charts.uv, charts.island_of_vertex())
    return _unwrap(receiver, np.clip(px / edge_px, 0.0, 1.0).astype(np.float32))


def _unwrap(receiver: Receiver, uv: np.ndarray) -> Unwrap:
    charts = receiver.charts
    return Unwrap(charts.vertex_source, charts.indices, uv, charts.chart)


def _texels(unwrap: Unwrap, scale_px: np.ndarray) -> float:
    """Area on the page of an instance's charts."""
    return float(triangle_areas(unwrap.uv, unwrap.indices).sum() * np.prod(scale_px, dtype=np.float64))


def _choice(plan: Plan, texels_per_metre: float) -> str:
    pages = "1 page" if len(plan.pages) == 1 else f"{len(plan.pages)} pages"
    return f"lightmap: {pages} of {plan.edge_px} × {plan.edge_px} texels, {texels_per_metre:.3g} per metre"


def _remarks(scene: Scene, receivers: Sequence[Receiver], plan: Plan) -> list[str]:
    remarks = []
    if plan.n_shrunk:
        remarks.append(f"{plan.n_shrunk} objects larger than a page have fewer texels per metre")
    tiny = [
        receivers[piece.receiver].instances[piece.slot]
        for _, piece, _ in _placements(plan)
        if piece.texels(plan.density) < 1.0
    ]
    if tiny:
        first = scene.instances[tiny[0]].name or f"instance {tiny[0]}"
        others = f" and {len(tiny) - 1} more" if len(tiny) > 1 else ""
        remarks.append(f"smaller than one texel: {first}{others}")
    return remarks


def _empty(scene: Scene, notes: tuple[str, ...]) -> LightmapLayout:
    n = len(scene.instances)
    return LightmapLayout(
        n_pages=0,
        width_px=0,
        height_px=0,
        unwraps=(None,) * len(scene.primitives),
        page=np.full(n, -1, np.int32),
        scale=np.ones((n, 2), np.float32),
        offset=np.zeros((n, 2), np.float32),
        texels_per_metre=0.0,
        notes=notes,
    )
