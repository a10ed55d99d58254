"""How noisy each texel still is, from the spread of its rounds."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from irradia.transport.backend import dr, mi
from irradia.transport.texel_sums import TexelSums

_NONE = 0xFFFFFFFF
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
        self._pixel, self._chart = mi.UInt32(pixel), mi.UInt32(chart)
        self._size = int(np.prod(shape))
        self._width = shape[2]
        self._texel_at: mi.UInt32 | None = None  # made when it is first asked for: it is as large as a page
        self.deviations = dr.zeros(mi.Float, len(pixel))
        self.rounds = dr.zeros(mi.Float, len(pixel))

    def fold(self, total: TexelSums, part: TexelSums) -> None:
        """Adds a round to the total and takes note of how far it lies from it (Chan et al. 1979).

        Args:
            total: Complete rounds, added to in place.
            part: The round; nothing is left of it.
        """
        before, now = mi.Float(total.rays), mi.Float(part.rays)
        gap = mi.luminance(part.mean()) - mi.luminance(total.mean())
        spread = dr.square(gap) * before * now / dr.maximum(before + now, 1.0)
        self.deviations = self.deviations + spread
        self.rounds = self.rounds + dr.select(part.rays > 0, 1.0, 0.0)
        dr.eval(self.deviations, self.rounds)
        total.absorb(part)

    def standard_error(self, total: TexelSums) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
        """(N,) standard error and mean of each texel's luminance, pooled; the one read-back."""
        freedom, luminance = dr.maximum(self.rounds - 1.0, 0.0), mi.luminance(total.mean())
        dr.eval(freedom, luminance)
        if self._texel_at is None:
            self._texel_at = self._texel_of_pixels()
        pooled, count = mi.Vector3f(0.0), mi.Float(0.0)
        for x, y in _OFFSETS:
            near = mi.Int32(self._pixel) + (y * self._width + x)
            inside = (near >= 0) & (near < self._size)
            texel = dr.gather(mi.UInt32, self._texel_at, mi.UInt32(near), inside)
            inside &= texel != _NONE
            inside &= dr.gather(mi.UInt32, self._chart, texel, inside) == self._chart
            for row, column in enumerate((self.deviations, freedom, luminance)):
                pooled[row] += dr.gather(mi.Float, column, texel, inside)
            count += dr.select(inside, 1.0, 0.0)
        variance = pooled.x / dr.maximum(pooled.y, 1.0)
        error = dr.sqrt(variance / dr.maximum(mi.Float(total.rays), 1.0))
        mean = pooled.z / count
        dr.eval(error, mean)
        return np.array(error), np.array(mean)

    def release(self) -> None:
        """Gives its memory back."""
        self._texel_at = None
        self.deviations, self.rounds = mi.Float(), mi.Float()

    def _texel_of_pixels(self) -> mi.UInt32:
        """Which texel lies at every pixel, or _NONE."""
        texel_at = dr.full(mi.UInt32, _NONE, self._size)
        dr.scatter(texel_at, dr.arange(mi.UInt32, len(self._pixel)), self._pixel)
        dr.eval(texel_at)
        return texel_at

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
