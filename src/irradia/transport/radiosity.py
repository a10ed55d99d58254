"""Light that leaves the texels of the map, as rays of the next epoch read it.

A texel holds one value, but something may stand on it: then rays meet parts of it on either side of a
wall, and the value is that of one side alone. Where the other side, or this one, is all but black, it is the
inside of something closed, and must not be lit by what it has in common with the outside. So such a texel
has a second value, and a ray reads the one that suits the place where it started: from where all is black
the darker one, from elsewhere the brighter.

The darker one for all rays, told by the light of single texels, cost light: 0.3 % of the whole in a
furnished hall, and more the fewer samples an epoch had, since then many texels are black by chance.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from irradia.transport.backend import dr, mi
from irradia.transport.footprints import Footprints
from irradia.transport.geometry import Hit
from irradia.transport.world import TriangleRecord, World

_ALL_BUT_BLACK = 1e-4  # of the brighter side's light; an open scene in the sun has shadows of 1e-3
_NOBODY = 0xFFFFFFFF
_PER_STEP = 1 << 20  # texels: NumPy makes wider copies of what it counts


class Darkness:
    """No light leaves any surface: what rays meet is sources alone."""

    everywhere = True

    def read_from(self, texel: mi.UInt32) -> Darkness:
        """See :meth:`RadiosityCache.read_from`."""
        return self

    def outgoing(self, world: World, hit: Hit, record: TriangleRecord, active: mi.Bool) -> mi.Color3f:
        """See :class:`LightCache`."""
        return mi.Color3f(0.0)


class RadiosityCache:
    """Radiance leaving each texel of the map, ρ · E/π, read by the nearest texel.

    Args:
        rows: Four numbers a row. Row by pixel: the light of a texel, and bit by bit the number of the row
            for its other side, or 0. Rows of other sides stand behind those of all pixels: their light, and
            who sees them: receivers around which there is at most so much light or, of a number below 0,
            more than its opposite.
        width_px: Of a page.
        around: Mean light of each region; None where no texel has another side.
        region: (N,) region of each texel.
        reader: Mean light around each lane's receiver.
    """

    # No dataclass: Dr.Jit would take its arrays for loop state.

    def __init__(
        self,
        rows: mi.Float,
        width_px: int,
        around: mi.Float | None = None,
        region: mi.UInt32 | None = None,
        reader: mi.Float | None = None,
    ) -> None:
        self._rows, self._width_px = rows, width_px
        self._around, self._region, self._reader = around, region, reader

    everywhere = False

    def read_from(self, texel: mi.UInt32) -> RadiosityCache:
        """The same for rays that start on texels, one a lane."""
        if self._around is None or self._region is None:
            return self
        reader = dr.gather(mi.Float, self._around, dr.gather(mi.UInt32, self._region, texel))
        return RadiosityCache(self._rows, self._width_px, reader=reader)

    def outgoing(self, world: World, hit: Hit, record: TriangleRecord, active: mi.Bool) -> mi.Color3f:
        """See :class:`LightCache`."""
        pixel = record.page_start + mi.UInt32(record.pixel.y) * self._width_px + mi.UInt32(record.pixel.x)
        value = dr.gather(mi.Vector4f, self._rows, pixel, active)
        if self._reader is not None:
            row = dr.reinterpret_array(mi.UInt32, value.w)
            divided = active & (row != 0)
            other = dr.gather(mi.Vector4f, self._rows, row, divided)
            sees_other = dr.select(other.w < 0.0, self._reader > -other.w, self._reader <= other.w)
            value = dr.select(divided & sees_other, other, value)
        return mi.Color3f(value.x, value.y, value.z)


TexelCache = Darkness | RadiosityCache


class OtherSides:
    """Texels that rays may meet on two sides of something.

    Args:
        footprints: What of each texel looks at the scene.
        region: (N,) parts of charts with nothing between their texels, each numbered by its first texel.

    Attributes:
        count: How many texels.
        region: (N,) the same regions by consecutive numbers.
    """

    def __init__(self, footprints: Footprints, region: NDArray[np.uint32]) -> None:
        itself = np.arange(len(footprints.behind), dtype=np.uint32)
        moved, behind = footprints.moved[:, 0], footprints.behind.copy()
        two_sided = behind != itself
        two_sided[moved] = True
        behind[moved] = _NOBODY  # they lie inside something: nobody knows what their other side is like
        self.count = int(two_sided.sum())
        self._number = mi.UInt32(np.where(two_sided, np.cumsum(two_sided, dtype=np.uint32), np.uint32(0)))
        self._behind = mi.UInt32(behind[two_sided])
        self._host_region = _numbered(region)
        self.region = mi.UInt32(self._host_region)

    def around(self, light: mi.Color3f) -> mi.Float:
        """Mean light of each region, brightest channel: one texel may be black by chance."""
        brightest, region = np.array(dr.max(light)), self._host_region
        total = np.zeros(int(region.max()) + 1)
        size = np.zeros(len(total), np.int64)
        for start in range(0, len(brightest), _PER_STEP):
            part = slice(start, start + _PER_STEP)
            total += np.bincount(region[part], brightest[part], len(total))
            size += np.bincount(region[part], minlength=len(total))
        return mi.Float((total / np.maximum(size, 1)).astype(np.float32))

    def write(
        self, rows: mi.Float, n_pixels: int, light: mi.Color3f, around: mi.Float, factor: mi.Color3f
    ) -> mi.UInt32:
        """Adds the rows of other sides.

        Args:
            rows: Of a :class:`RadiosityCache`; changed in place.
            n_pixels: How many rows there are before them.
            light: (N,) E/π.
            around: From :meth:`around`.
            factor: (N,) what the light is multiplied by.

        Returns:
            (N,) the row of each texel's other side; 0 where neither side is dark, or there is no other.
        """
        exists = self._number != 0
        behind = dr.gather(mi.UInt32, self._behind, self._number - 1, exists)
        known = exists & (behind != _NOBODY)
        there = dr.gather(mi.Color3f, light, behind, known)
        around_there = dr.gather(mi.Float, around, dr.gather(mi.UInt32, self.region, behind, known), known)
        around_here = dr.gather(mi.Float, around, self.region, known)
        below_here, below_there = (_ALL_BUT_BLACK * dr.max(x) for x in (light, there))
        dark_there = exists & (around_there <= below_here)
        dark_here = known & ~dark_there & (around_here <= below_there)

        outgoing = there * factor
        seen_by = dr.select(dark_here, -below_there, below_here)
        row = self._number + dr.opaque(mi.UInt32, n_pixels - 1)
        dr.scatter(rows, mi.Vector4f(outgoing.x, outgoing.y, outgoing.z, seen_by), row, exists)
        return dr.select(dark_there | dark_here, row, 0)


def _numbered(region: NDArray[np.uint32]) -> NDArray[np.uint32]:
    """Regions by consecutive numbers; texels in none have the last."""
    begins = region == np.arange(len(region), dtype=np.uint32)
    number = np.cumsum(begins, dtype=np.uint32) - np.uint32(1)
    in_one = region < len(region)
    return np.where(in_one, number[np.where(in_one, region, 0)], np.uint32(begins.sum()))
