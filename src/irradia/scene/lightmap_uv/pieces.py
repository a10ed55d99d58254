"""What is placed on the pages: loose charts, or one rectangle for each instance of a primitive."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from irradia.scene.lightmap_uv.charts import triangle_areas
from irradia.scene.lightmap_uv.pack import INSET_PX, Islands, Placement, pack, rectangle
from irradia.scene.lightmap_uv.receivers import Receiver
from irradia.scene.types import F32, F64

# The free space between charts shrinks with the rectangle. Instances that are smaller than the median
# either get its rectangle all the same, or one of down to these shares of it, with charts farther apart.
_FLOORS = (1.0, 0.75, 0.5, 0.25)
_ALIKE = 0.01  # spread of sizes that counts as none


@dataclass(frozen=True)
class Piece:
    """One instance of a receiver.

    Attributes:
        receiver: Index into the list of receivers.
        slot: Which of the receiver's instances.
        metres_per_uv: See :class:`Receiver`; smaller where the piece had to be shrunk.
        uv_area: Area of the charts in uv units.
    """

    receiver: int
    slot: int
    metres_per_uv: float
    uv_area: float

    def texels(self, density: float) -> float:
        """Texels that its surface asks for, without borders."""
        return self.uv_area * (self.metres_per_uv * density) ** 2

    def shrunk(self, factor: float) -> Piece:
        """The same piece with fewer texels a metre."""
        return replace(self, metres_per_uv=self.metres_per_uv * factor)


@dataclass(frozen=True)
class Block:
    """A receiver's charts arranged for all its instances alike.

    Attributes:
        uv: (V', 2) as the unwrap will hold it.
        low, high: (2,) bounds of ``uv``.
        size_px: (2,) texels of its rectangle where a uv unit has ``texels_per_uv``.
        min_ratio: No instance gets a smaller share of that size, so that its charts stay apart.
    """

    uv: F32
    low: F64
    high: F64
    size_px: F64
    texels_per_uv: float
    min_ratio: float = 0.0

    def size_at(self, texels_per_uv: float) -> tuple[int, int]:
        """Whole texels of the rectangle at some other density."""
        ratio = texels_per_uv / self.texels_per_uv if self.texels_per_uv > 0 else 1.0
        size = np.ceil(self.size_px * max(ratio, self.min_ratio) - 0.01).astype(int)
        return max(int(size[0]), 1), max(int(size[1]), 1)


@dataclass(frozen=True)
class Page:
    """A packed page: for each piece its uv → page texel transform, per chart or one for all.

    Attributes:
        edge_px: The larger of width and height.
        placements: One per piece; of a block, with a single row.
    """

    edge_px: int
    placements: tuple[Placement, ...]


def make_pieces(receivers: Sequence[Receiver]) -> list[Piece]:
    """One piece for each instance that takes a lightmap."""
    pieces = []
    for number, receiver in enumerate(receivers):
        charts = receiver.charts
        area = float(triangle_areas(charts.uv, charts.indices)[charts.solid].sum())
        for slot, metres in enumerate(receiver.metres_per_uv):
            pieces.append(Piece(number, slot, float(metres), area))
    return pieces


def make_blocks(receivers: Sequence[Receiver], density: float, padding_px: int) -> dict[int, Block]:
    """Arranges the charts of each receiver that isn't loose; keyed by receiver."""
    blocks = {}
    for number, receiver in enumerate(receivers):
        if receiver.loose:
            continue
        reference = receiver.median_metres_per_uv * density
        fixed = receiver.from_file or receiver.charts.n_charts == 0
        arrange = _as_it_is if fixed else _arranged
        blocks[number] = arrange(receiver, reference, padding_px)
    return blocks


def pack_page(
    receivers: Sequence[Receiver],
    blocks: dict[int, Block],
    pieces: Sequence[Piece],
    density: float,
    padding_px: int,
) -> Page:
    """Packs some pieces at a density in texels per metre."""
    sizes = {
        i: blocks[p.receiver].size_at(p.metres_per_uv * density)
        for i, p in enumerate(pieces)
        if p.receiver in blocks
    }
    groups = [
        rectangle(*sizes[i]) if i in sizes else _islands(receivers[piece.receiver], piece, density)
        for i, piece in enumerate(pieces)
    ]
    width, height, placements = pack(groups, padding_px)
    for i, piece in enumerate(pieces):
        if i in sizes:
            placements[i] = _into_rectangle(blocks[piece.receiver], sizes[i], placements[i])
        else:
            factor = piece.metres_per_uv * density
            placements[i] = Placement(placements[i].scale * factor, placements[i].offset)
    return Page(max(width, height), tuple(placements))


def _islands(receiver: Receiver, piece: Piece, density: float) -> Islands:
    charts = receiver.charts
    return Islands(
        uv=(charts.uv * (piece.metres_per_uv * density)).astype(np.float32),
        indices=charts.indices[charts.solid],
        island=charts.chart[charts.solid],
    )


def _arranged(receiver: Receiver, texels_per_uv: float, padding_px: int) -> Block:
    """Our own charts, packed for the rectangle so that all instances together take least room."""
    ratios = receiver.metres_per_uv / receiver.median_metres_per_uv
    if np.ptp(ratios) < _ALIKE:
        return _arranged_down_to(receiver, texels_per_uv, padding_px, 1.0)
    trials = []
    for floor in np.maximum(_FLOORS, ratios.min()):
        # Scaled charts don't meet texel borders: one texel more keeps as many between them free.
        padding = int(np.ceil((padding_px + 1) / min(floor, 1.0) - 0.01))
        trials.append(_arranged_down_to(receiver, texels_per_uv, padding, floor))
    room = [np.prod(block.size_px) * (np.maximum(ratios, block.min_ratio) ** 2).sum() for block in trials]
    return trials[int(np.argmin(room))]


def _arranged_down_to(receiver: Receiver, texels_per_uv: float, padding_px: int, min_ratio: float) -> Block:
    charts = receiver.charts
    islands = Islands(
        uv=(charts.uv * texels_per_uv).astype(np.float32),
        indices=charts.indices[charts.solid],
        island=charts.chart[charts.solid],
    )
    width, height, (placement,) = pack([islands], padding_px)
    size = np.array([width, height], np.float64)
    px = placement.apply(charts.uv * np.float32(texels_per_uv), charts.island_of_vertex())
    return Block(
        uv=(px / size).astype(np.float32),
        low=np.zeros(2),
        high=np.ones(2),
        size_px=size,
        texels_per_uv=texels_per_uv,
        min_ratio=min_ratio,
    )


def _as_it_is(receiver: Receiver, texels_per_uv: float, _padding_px: int) -> Block:
    """The file's own uv, or a surface without area."""
    charts = receiver.charts
    used = charts.uv[np.unique(charts.indices)].astype(np.float64)
    low, high = used.min(axis=0), used.max(axis=0)
    size_px = np.maximum((high - low) * texels_per_uv, 1.0)
    margin = (high - low) * INSET_PX / size_px
    return Block(charts.uv, low - margin, high + margin, size_px, texels_per_uv)


def _into_rectangle(block: Block, size: tuple[int, int], placed: Placement) -> Placement:
    """Spans a block's bounds from border to border of its rectangle."""
    origin = np.rint(placed.offset[0])
    span = block.high - block.low
    scale = np.array(size) / np.where(span > 0, span, np.inf)
    start = origin + np.where(span > 0, 0.0, 0.5)  # what has no extent lies inside its texel
    return Placement(scale=scale[None], offset=(start - block.low * scale)[None])
