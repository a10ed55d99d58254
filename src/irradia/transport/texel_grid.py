"""Which texels of the compact list lie beside each other on their chart."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

PRECEDING = ((-1, 0), (-1, -1), (0, -1), (1, -1))
"""Steps (x, y) to the four of a texel's eight neighbours that stand before it in the list."""
AROUND = (*PRECEDING, *((-x, -y) for x, y in PRECEDING))


@dataclass(frozen=True)
class TexelGrid:
    """Positions of texels.

    Attributes:
        pixel: (N,) flat index (page · height + y) · width + x, ascending.
        chart: (N,) chart of each.
        width_px, height_px: Of a page.
    """

    pixel: NDArray[np.uint32]
    chart: NDArray[np.uint32]
    width_px: int
    height_px: int

    def neighbour(self, texel: NDArray[np.int64], step: tuple[int, int]) -> NDArray[np.int64]:
        """(K,) the texel of the same chart one step (x, y) away from each (K,), or −1."""
        pixel = self.pixel[texel].astype(np.int64)
        row, x = np.divmod(pixel, self.width_px)
        x, y = x + step[0], row % self.height_px + step[1]
        on_page = (x >= 0) & (x < self.width_px) & (y >= 0) & (y < self.height_px)
        # All in uint32, lest the search copies the list.
        wanted = np.where(on_page, pixel + step[0] + step[1] * self.width_px, 0).astype(np.uint32)
        found = np.minimum(np.searchsorted(self.pixel, wanted), len(self.pixel) - 1)
        there = on_page & (self.pixel[found] == wanted) & (self.chart[found] == self.chart[texel])
        return np.where(there, found, -1)

    def with_neighbours(self, texel: NDArray[np.int64]) -> NDArray[np.int64]:
        """The texels (K,) and all that touch them on their charts, ascending."""
        chosen = np.zeros(len(self.pixel), np.bool_)
        chosen[texel] = True
        for step in AROUND:
            beside = self.neighbour(texel, step)
            chosen[beside[beside >= 0]] = True
        return np.flatnonzero(chosen)
