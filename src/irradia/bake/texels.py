"""The texel g-buffer: which texel sees which triangle, with sub-texel samples."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from irradia.scene.types import F32, U32

SUBSAMPLES = 8  # sub-texel samples a covered texel keeps


@dataclass(frozen=True)
class TexelSet:
    """The compact list of covered texels that everything after feeds on.

    Attributes:
        n_pages, height_px, width_px: Shape of the pages.
        pixel: (N,) flat index (page · height + y) · width + x, ascending.
        triangle: (N, SUBSAMPLES) triangle of the merged mesh under each sub-sample. Texels that
            are covered in part repeat the sub-samples they have; a sliver that no sub-sample hits
            is sampled at its point nearest to the texel's centre, so no touched texel is missed.
        barycentric: (N, SUBSAMPLES, 2) weights of the triangle's second and third vertex.
        coverage: (N,) share of the texel that charts cover, in (0, 1].
        chart: (N,) chart that owns the texel.
    """

    n_pages: int
    height_px: int
    width_px: int
    pixel: U32
    triangle: U32
    barycentric: F32
    coverage: F32
    chart: U32

    def to_pages(self, values: NDArray, fill: float = 0.0) -> NDArray:
        """Scatters (N, …) values to (pages, height, width, …)."""
        flat = np.full((self.n_pages * self.height_px * self.width_px, *values.shape[1:]), fill, values.dtype)
        flat[self.pixel] = values
        return flat.reshape(self.n_pages, self.height_px, self.width_px, *values.shape[1:])
