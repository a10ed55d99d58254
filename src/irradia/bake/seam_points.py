"""Where the lightmap is cut although the surface goes on: points on edges that two chart borders share.

Points are spread over all chart borders, twice a texel, and each looks in space for other borders that
pass through it. So edges need not begin or end together: modular blocks of different sizes match along
the stretch where they touch.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from irradia.scene.layout import LightmapLayout
from irradia.scene.merge import MergedMesh
from irradia.scene.types import F32, F64, U32

_POINTS_PER_TEXEL = 2.0
_SHORTEST_PX = 1e-3  # borders that collapse to a point on the page have nothing to match
_TOLERANCE_TEXELS = 0.02  # how far apart in space two borders may run and still be one edge
_TOLERANCE_OF_SCENE = 1e-6  # rounding of coordinates


@dataclass(frozen=True)
class SeamPoints:
    """Points in space that lie on the borders of two charts, or on two borders of one.

    Attributes:
        page: (M, 2) page on either side.
        position_px: (M, 2, 2) where the point lies on it: side, then x and y in texels.
        chart: (M, 2) chart on either side.
        weight: (M,) length of border that the point stands for, in texels of its first side.
    """

    page: NDArray[np.int32]
    position_px: F32
    chart: U32
    weight: F32

    def __len__(self) -> int:
        return len(self.weight)


class Borders(NamedTuple):
    """Edges of charts; a tuple because kernels take it as it is.

    Attributes:
        ends: (E, 2, 3) world positions.
        normals: (E, 2, 3) interpolated normals there.
        inward: (E, 3) unit, in the triangle's plane, across the edge and into the chart.
        front: (E, 3) geometric normal of the triangle, unit.
        ends_px: (E, 2, 2) positions on the page, in texels.
        page, chart: (E,).
        lod: (E,) level of detail, as :attr:`MergedMesh.lod`; 0 without.
        length_m, length_px: (E,) in space, and on the page in texels.
        tolerance: (E,) how far in space another border may pass and still be the same edge.
    """

    ends: F64
    normals: F64
    inward: F64
    front: F64
    ends_px: F64
    page: NDArray[np.int32]
    chart: U32
    lod: U32
    length_m: F64
    length_px: F64
    tolerance: F64


def find_seam_points(mesh: MergedMesh, layout: LightmapLayout) -> SeamPoints:
    """Matches chart borders in space.

    Two borders match where they run along each other and the surface goes on from one to the other:
    interpolated normals agree, and the faces neither are folded sharply nor lie on the same side. Hard
    creases are no seams, nor are cuts whose two sides are one place on the page. Each pair is found from
    both sides.

    Args:
        mesh: The merged mesh.
        layout: For the size of the pages.
    """
    from irradia.bake.seam_search import match_borders

    borders = chart_borders(mesh, layout)
    if len(borders.page) == 0:
        return _none()
    cell, count = _point_counts(borders)
    edge = np.repeat(np.arange(len(count)), count)
    share = (np.arange(len(edge)) - np.repeat(np.cumsum(count) - count, count) + 0.5) / count[edge]
    point, other, other_share = match_borders(borders, edge, share, cell)
    own = edge[point]
    sides = np.stack([own, other], axis=1)
    position = _along(borders.ends_px[sides], np.stack([share[point], other_share], axis=1))
    return SeamPoints(
        page=borders.page[sides],
        position_px=position.astype(np.float32),
        chart=borders.chart[sides],
        weight=(borders.length_px / count)[own].astype(np.float32),
    )


def chart_borders(mesh: MergedMesh, layout: LightmapLayout) -> Borders:
    """Edges that only one triangle of a page has; vertices of one place on both surface and page are one."""
    drawn = np.flatnonzero(mesh.page >= 0)
    corner = mesh.indices[drawn].astype(np.int64)
    place = _weld(mesh, layout)[corner]
    following = np.roll(place, -1, axis=1)
    low, high = np.minimum(place, following), np.maximum(place, following)
    key = (low * len(mesh.positions) + high).ravel()
    _, first, uses = np.unique(key, return_index=True, return_counts=True)
    border = np.sort(first[(uses == 1) & (low != high).ravel()[first]])
    row, k = np.divmod(border, 3)
    vertices = np.stack([corner[row, k], corner[row, (k + 1) % 3]], axis=1)
    opposite = mesh.positions[corner[row, (k + 2) % 3]].astype(np.float64)

    ends = mesh.positions[vertices].astype(np.float64)
    ends_px = mesh.lightmap_uv[vertices].astype(np.float64) * (layout.width_px, layout.height_px)
    length_m, length_px = (np.linalg.norm(e[:, 1] - e[:, 0], axis=1) for e in (ends, ends_px))
    inward = _inward(ends, opposite)
    rounding = _TOLERANCE_OF_SCENE * np.abs(mesh.positions).max(initial=0.0)
    borders = Borders(
        ends=ends,
        normals=mesh.normals[vertices].astype(np.float64),
        inward=inward,
        front=np.cross(ends[:, 1] - ends[:, 0], inward) / np.maximum(length_m, 1e-30)[:, None],
        ends_px=ends_px,
        page=mesh.page[drawn][row],
        chart=mesh.chart[drawn][row],
        lod=np.zeros(len(row), np.uint32) if mesh.lod is None else mesh.lod[drawn][row],
        length_m=length_m,
        length_px=length_px,
        tolerance=np.maximum(_TOLERANCE_TEXELS * length_m / np.maximum(length_px, _SHORTEST_PX), rounding),
    )
    keep = (length_px > _SHORTEST_PX) & (length_m > 0) & inward.any(axis=1)
    return borders._replace(**{name: column[keep] for name, column in borders._asdict().items()})


def _weld(mesh: MergedMesh, layout: LightmapLayout) -> NDArray[np.int64]:
    """(V,) one number for all vertices of one world position and one place on a page."""
    page = np.zeros(len(mesh.positions), np.float32)
    page[mesh.indices] = mesh.page[:, None]
    # Steps of 2⁻¹⁴ texel, as the rasteriser's: vertices that it can't tell apart are one.
    uv = np.rint(mesh.lightmap_uv * (np.array([layout.width_px, layout.height_px]) * 2.0**14))
    columns = np.column_stack([mesh.positions + np.float32(0.0), uv.astype(np.float32), page])
    words = np.ascontiguousarray(columns, np.float32).view(np.uint32).astype(np.uint64)
    key = np.zeros(len(words), np.uint64)
    for column in words.T:  # Fowler, Noll and Vo's hash, word by word, with a final mix
        key = (key ^ column) * np.uint64(0x100000001B3)
        key ^= key >> np.uint64(29)
    _, number = np.unique(key, return_inverse=True)
    return number.reshape(-1)


def _inward(ends: F64, opposite: F64) -> F64:
    """Unit vectors from edges towards the third corner; 0 for triangles without area."""
    along = ends[:, 1] - ends[:, 0]
    along /= np.maximum(np.linalg.norm(along, axis=1, keepdims=True), 1e-30)
    across = opposite - ends[:, 0]
    across -= along * np.einsum("ij,ij->i", across, along)[:, None]
    length = np.linalg.norm(across, axis=1, keepdims=True)
    return np.where(length > 1e-12, across / np.maximum(length, 1e-30), 0.0)


def _point_counts(borders: Borders) -> tuple[float, NDArray[np.int64]]:
    """Edge of the search grid's cells, and how many points each border gets.

    Neighbouring points of one border lie at most a cell apart, so that a search finds every border that
    passes near by one of its points.
    """
    count = np.maximum(np.ceil(borders.length_px * _POINTS_PER_TEXEL), 1.0)
    spacing = borders.length_m / count
    order = np.argsort(spacing, kind="stable")
    middle = np.searchsorted(np.cumsum(count[order]), 0.5 * count.sum())
    cell = float(spacing[order[min(middle, len(order) - 1)]]) * 1.5
    return cell, np.maximum(count, np.ceil(borders.length_m / cell)).astype(np.int64)


def _along(ends: F64, share: F64) -> F64:
    """(M, 2, 2) points at shares (M, 2) of edges (M, side, end, 2)."""
    return ends[:, :, 0] + (ends[:, :, 1] - ends[:, :, 0]) * share[..., None]


def _none() -> SeamPoints:
    return SeamPoints(
        np.zeros((0, 2), np.int32),
        np.zeros((0, 2, 2), np.float32),
        np.zeros((0, 2), np.uint32),
        np.zeros(0, np.float32),
    )
