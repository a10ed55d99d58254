"""How many texels a metre gets: as many as fit one page, or as asked, over as many pages as that needs."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from irradia.core.errors import InputError
from irradia.scene.lightmap_uv.options import MAX_TOTAL_TEXELS, LayoutOptions
from irradia.scene.lightmap_uv.pieces import Block, Page, Piece, make_blocks, make_pieces, pack_page
from irradia.scene.lightmap_uv.receivers import Receiver

_TYPICAL_FILL = 0.6  # share of a page that surfaces cover once borders and gaps are paid for
_MIN_TRIALS, _MAX_TRIALS = 8, 40  # of packing a page; few charts pack fast, and by luck
_CHARTS_PACKED = 20_000  # over all trials together, where the limits above allow
_STEP_UP = 1.01  # a higher density may fit where a lower one did not: packing is not monotonic
_MULTIPLE_PX = 4  # of page edges: block compression


@dataclass(frozen=True)
class Plan:
    """All pages at the density that was settled on.

    Attributes:
        pieces, pages: By page; ``pages[i].placements`` go with ``pieces[i]``.
        edge_px: Of every page.
        n_shrunk: Pieces that alone were larger than a page.
    """

    density: float
    edge_px: int
    blocks: dict[int, Block]
    pieces: tuple[tuple[Piece, ...], ...]
    pages: tuple[Page, ...]
    n_shrunk: int = 0


def make_plan(receivers: Sequence[Receiver], options: LayoutOptions) -> Plan:
    """Settles density and pages.

    Raises:
        InputError: The charts don't fit the resolution, or the density asks for too many texels.
    """
    pieces = make_pieces(receivers)
    if options.resolution is not None:
        plan = _fill_page(receivers, pieces, options.resolution, options.padding_px)
        if plan is None:
            raise InputError(
                f"{_count_charts(receivers)} charts don't fit a page of {options.resolution} texels",
                where="--resolution",
                fix="Choose a larger page.",
            )
        return plan
    if options.texels_per_metre is not None:
        return _spread(receivers, pieces, options.texels_per_metre, options)
    edge = int(np.sqrt(options.default_texels))
    plan = _fill_page(receivers, pieces, edge, options.padding_px)
    # With very many charts the borders would eat the page: then it grows instead.
    wanted = _TYPICAL_FILL * options.default_texels
    density = np.sqrt(wanted / max(_texels(pieces, 1.0), 1e-30))
    if plan is not None and (plan.density > 0.5 * density or edge >= options.max_page_px):
        return plan
    return _spread(receivers, pieces, 0.5 * density, options)


def _texels(pieces: Sequence[Piece], density: float) -> float:
    return float(sum(piece.texels(density) for piece in pieces))


def _count_charts(receivers: Sequence[Receiver]) -> int:
    return sum(max(r.charts.n_charts, 1) * len(r.instances) for r in receivers)


def _fill_page(receivers: Sequence[Receiver], pieces: list[Piece], edge: int, padding_px: int) -> Plan | None:
    """The highest density found at which everything fits one page, or None."""
    n_trials = int(np.clip(_CHARTS_PACKED // _count_charts(receivers), _MIN_TRIALS, _MAX_TRIALS))
    density = edge * np.sqrt(_TYPICAL_FILL / max(_texels(pieces, 1.0), 1e-30))
    best: Plan | None = None
    steps_up = 0
    for _ in range(n_trials):
        blocks = make_blocks(receivers, density, padding_px)
        page = pack_page(receivers, blocks, pieces, density, padding_px)
        if page.edge_px <= edge and (best is None or density > best.density):
            best = Plan(density, edge, blocks, (tuple(pieces),), (page,))
            steps_up = 0
        density *= edge / (page.edge_px + 0.5)
        if best is not None and density < best.density * _STEP_UP:
            steps_up += 1
            density = best.density * _STEP_UP**steps_up
    return best


def _spread(
    receivers: Sequence[Receiver], pieces: list[Piece], density: float, options: LayoutOptions
) -> Plan:
    """As many pages as the density needs, each as small as all allow."""
    texels = _texels(pieces, density)
    if texels > MAX_TOTAL_TEXELS:
        raise InputError(
            f"{density:g} texels per metre would take {texels:.3g} texels; {MAX_TOTAL_TEXELS:,} is the most",
            where="--texels-per-metre",
            fix="Choose a lower density, or give large objects a smaller lightmapScale.",
        )
    blocks = make_blocks(receivers, density, options.padding_px)
    limit = options.max_page_px
    shares = [pieces]
    shrunk = 0
    while True:
        pages = [pack_page(receivers, blocks, share, density, options.padding_px) for share in shares]
        full = [i for i, page in enumerate(pages) if page.edge_px > limit]
        if not full:
            break
        for i in full:
            if len(shares[i]) == 1:
                shares[i] = [shares[i][0].shrunk(0.98 * limit / pages[i].edge_px)]
                shrunk += 1
        if any(len(shares[i]) > 1 for i in full):
            shares = _divide(shares, density, len(shares) + 1, limit)
    edge = max(page.edge_px for page in pages)
    edge = -(-edge // _MULTIPLE_PX) * _MULTIPLE_PX
    return Plan(density, edge, blocks, tuple(map(tuple, shares)), tuple(pages), shrunk)


def _divide(shares: list[list[Piece]], density: float, at_least: int, limit: int) -> list[list[Piece]]:
    """Deals all pieces, largest first, to the emptiest of a few pages."""
    pieces = sorted(
        (p for share in shares for p in share), key=lambda p: (-p.texels(density), p.receiver, p.slot)
    )
    needed = int(np.ceil(_texels(pieces, density) / (_TYPICAL_FILL * limit * limit)))
    dealt: list[list[Piece]] = [[] for _ in range(min(max(at_least, needed), len(pieces)))]
    load = np.zeros(len(dealt))
    for piece in pieces:
        target = int(load.argmin())
        dealt[target].append(piece)
        load[target] += piece.texels(density) + 16.0  # a piece has borders, however small
    return dealt
