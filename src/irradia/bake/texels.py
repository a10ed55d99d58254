"""The texel g-buffer: which texel sees which triangle, with sub-texel samples."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from irradia.scene.merge import MergedMesh
from irradia.scene.types import F32, F64, U32
from irradia.transport.subsample_set import SUBSAMPLES, SubsampleSet, weights_at

__all__ = ["SUBSAMPLES", "TexelSet"]


@dataclass(frozen=True)
class TexelSet:
    """The compact list of covered texels that everything after feeds on.

    Attributes:
        n_pages, height_px, width_px: Shape of the pages.
        pixel: (N,) flat index (page · height + y) · width + x, ascending.
        triangle: (N,) a triangle of each texel: the one under its first sub-sample.
        samples: SUBSAMPLES places on triangles for each texel. Texels that are covered in part repeat
            those they have; a sliver that no sub-sample hits is sampled at its point nearest to the
            texel's centre, so no touched texel is missed.
        coverage: (N,) share of the texel that charts cover, in (0, 1].
        chart: (N,) chart that owns the texel.
    """

    n_pages: int
    height_px: int
    width_px: int
    pixel: U32
    triangle: U32
    samples: SubsampleSet
    coverage: F32
    chart: U32

    def locate(self, mesh: MergedMesh) -> tuple[U32, F64]:
        """Triangles (N, SUBSAMPLES) of the mesh that was drawn, and the weights of their corners.

        For tests and measurements: the bake does the same on the device, texel by texel.

        Returns:
            Triangles (N, SUBSAMPLES) and barycentric weights (N, SUBSAMPLES, 3).
        """
        triangle, place = self.samples.unpack()
        in_page = self.pixel % (self.width_px * self.height_px)
        corner = np.stack([in_page % self.width_px, in_page // self.width_px], axis=-1)
        size = np.array([self.width_px, self.height_px], np.float64)
        corners = mesh.lightmap_uv[mesh.indices[triangle]].astype(np.float64) * size
        return triangle, weights_at(corner[:, None] + place, corners)

    def take(self, chosen: NDArray[np.integer]) -> TexelSet:
        """Some of the texels, by ascending place in the list."""
        return replace(
            self,
            pixel=self.pixel[chosen],
            triangle=self.triangle[chosen],
            samples=self.samples.take(chosen),
            coverage=self.coverage[chosen],
            chart=self.chart[chosen],
        )

    def without_samples(self) -> TexelSet:
        """The same list once its sub-samples are on the device: they are two thirds of it."""
        return replace(self, samples=SubsampleSet.none())

    def to_pages(self, values: NDArray, fill: float = 0.0) -> NDArray:
        """Scatters (N, …) values to (pages, height, width, …)."""
        flat = np.full((self.n_pages * self.height_px * self.width_px, *values.shape[1:]), fill, values.dtype)
        flat[self.pixel] = values
        return flat.reshape(self.n_pages, self.height_px, self.width_px, *values.shape[1:])
