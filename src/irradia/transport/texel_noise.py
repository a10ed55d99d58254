"""How noisy each texel still is, from the spread of its rounds."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from irradia.transport.backend import dr, mi
from irradia.transport.texel_sums import TexelSums

_OFFSETS = [(x, y) for y in (-1, 0, 1) for x in (-1, 0, 1)]


class NoiseMeter:
    """Squared deviations of round means from the whole, accumulated as rounds end.

    The rounds of a texel are few, so its own spread is itself noisy, and a texel that has been lucky
    would look converged. The spread is therefore pooled over the 3 × 3 neighbours of the same chart.

    Args:
        pixel: (N,) flat pixel of each texel.
        chart: (N,) chart of each texel.
        shape: (pages, height, width).
    """

    def __init__(
        self, pixel: NDArray[np.uint32], chart: NDArray[np.uint32], shape: tuple[int, int, int]
    ) -> None:
        self._pixel = mi.UInt32(pixel)
        self._size = int(np.prod(shape))
        self._width = shape[2]
        self._chart, self._places = chart, pixel
        self._owner: mi.UInt32 | None = None  # made when it is first asked for: it takes as much as a page
        self.deviations = dr.zeros(mi.Float, len(pixel))
        self.rounds = dr.zeros(mi.Float, len(pixel))

    def fold(self, total: TexelSums, part: TexelSums) -> TexelSums:
        """Adds a round to the total and takes note of how far it lies from it (Chan et al. 1979)."""
        before, now = mi.Float(total.rays), mi.Float(part.rays)
        gap = mi.luminance(part.mean()) - mi.luminance(total.mean())
        spread = dr.square(gap) * before * now / dr.maximum(before + now, 1.0)
        self.deviations = self.deviations + spread
        self.rounds = self.rounds + dr.select(part.rays > 0, 1.0, 0.0)
        result = total.plus(part)
        dr.eval(self.deviations, self.rounds, result.gathered, result.arrived, result.rays, result.samples)
        return result

    def standard_error(self, total: TexelSums) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
        """(N,) standard error and mean of each texel's luminance, pooled; the one read-back."""
        freedom = dr.maximum(self.rounds - 1.0, 0.0)
        pages = dr.zeros(mi.Float, 4 * self._size)
        rows = mi.Vector4f(self.deviations, freedom, mi.luminance(total.mean()), 0.0)
        dr.scatter(pages, rows, self._pixel)
        dr.eval(pages)
        if self._owner is None:
            self._owner = self._owners()
        owner = dr.gather(mi.UInt32, self._owner, self._pixel)
        pooled, count = mi.Vector3f(0.0), mi.Float(0.0)
        for x, y in _OFFSETS:
            near = mi.Int32(self._pixel) + (y * self._width + x)
            inside = (near >= 0) & (near < self._size)
            inside &= dr.gather(mi.UInt32, self._owner, mi.UInt32(near), inside) == owner
            value = dr.gather(mi.Vector4f, pages, mi.UInt32(near), inside)
            pooled += dr.select(inside, mi.Vector3f(value.x, value.y, value.z), 0.0)
            count += dr.select(inside, 1.0, 0.0)
        variance = pooled.x / dr.maximum(pooled.y, 1.0)
        error = dr.sqrt(variance / dr.maximum(mi.Float(total.rays), 1.0))
        both = np.array(mi.Point2f(error, pooled.z / count))
        return both[0], both[1]

    def release(self) -> None:
        """Gives its memory back."""
        self._owner = None
        self.deviations, self.rounds = mi.Float(), mi.Float()

    def _owners(self) -> mi.UInt32:
        """The chart of every pixel."""
        owner = np.full(self._size, 0xFFFFFFFF, np.uint32)
        owner[self._places] = self._chart
        return mi.UInt32(owner)

    @property
    def knows(self) -> bool:
        """Whether any texel has had two rounds."""
        return float(dr.max(self.rounds)[0]) >= 2.0 if len(self.rounds) else False

    def relative_error(self, total: TexelSums) -> NDArray[np.float32]:
        """(N,) standard error over mean, each mean raised by 1 % of the map's median."""
        error, mean = self.standard_error(total)
        floor = 0.01 * float(np.median(mean)) if len(mean) else 0.0
        return error / np.maximum(mean + np.float32(floor), np.float32(1e-30))

    def to_arrays(self) -> dict[str, NDArray]:
        """What a saved bake needs of it."""
        return {"deviations": np.array(self.deviations), "rounds": np.array(self.rounds)}

    def restore(self, arrays: dict[str, NDArray]) -> None:
        """Goes on from :meth:`to_arrays`."""
        self.deviations, self.rounds = mi.Float(arrays["deviations"]), mi.Float(arrays["rounds"])
