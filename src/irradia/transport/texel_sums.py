"""What texels have gathered so far: running sums on the device, and how many samples are in them."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from irradia.transport.backend import dr, mi


@dataclass(frozen=True)
class Lanes:
    """Which texels a pass serves, and by how many lanes each.

    Where most texels are served, every texel has a lane, and those that are not draw no samples: that
    spares the sums a scatter, and costs less than it.

    Attributes:
        texel: Numbers of the texels that have lanes, ascending.
        n_texels: How many are served.
        per_texel: Lanes a texel; more than one fills the device where texels are few.
        served: 1 or 0 for each texel, where all have lanes; else None, and all listed are served.
    """

    texel: mi.UInt32
    n_texels: int
    per_texel: int = 1
    served: mi.UInt32 | None = None

    def read(self, values: mi.UInt32) -> mi.UInt32:
        """What each lane finds in an array with one number a texel."""
        if self.served is not None:
            return values
        lane = dr.arange(mi.UInt32, self.n_texels * self.per_texel)
        texel = dr.gather(mi.UInt32, self.texel, lane // dr.opaque(mi.UInt32, self.per_texel))
        return dr.gather(mi.UInt32, values, texel)

    def part(self) -> mi.UInt32:
        """Which of its texel's lanes each is."""
        if self.served is not None:
            return mi.UInt32(0)
        lane = dr.arange(mi.UInt32, self.n_texels * self.per_texel)
        return lane % dr.opaque(mi.UInt32, self.per_texel)

    def count(self, n: int) -> mi.UInt32:
        """Samples that each lane draws where every texel is given ``n``."""
        each = dr.opaque(mi.UInt32, n // self.per_texel)
        return each if self.served is None else each * self.served


@dataclass
class TexelSums:
    """Running sums of two estimators, gather rays and next-event samples, whose means add up.

    Both hold the same channels: E/π first, then whatever else the bake keeps of each sample, such as
    the first bounce of lights that are lit live, or directional moments.

    Attributes:
        gathered: By channel, (N) sums over rays.
        arrived: By channel, (N) sums over next-event samples.
        rays, samples: (N,) how many of each.
    """

    gathered: list[mi.Color3f]
    arrived: list[mi.Color3f]
    rays: mi.UInt32
    samples: mi.UInt32

    @staticmethod
    def empty(n_texels: int, n_channels: int) -> TexelSums:
        """No samples yet."""
        zeros = [dr.zeros(mi.Color3f, n_texels) for _ in range(2 * n_channels)]
        counts = [dr.zeros(mi.UInt32, n_texels) for _ in range(2)]
        return TexelSums(zeros[:n_channels], zeros[n_channels:], counts[0], counts[1])

    def mean(self, channel: int = 0) -> mi.Color3f:
        """A channel's estimate; 0 where there are no samples."""
        gathered = self.gathered[channel] / dr.maximum(mi.Float(self.rays), 1.0)
        arrived = self.arrived[channel] / dr.maximum(mi.Float(self.samples), 1.0)
        return gathered + arrived

    def plus(self, other: TexelSums) -> TexelSums:
        """Both together."""
        gathered = [a + b for a, b in zip(self.gathered, other.gathered, strict=True)]
        arrived = [a + b for a, b in zip(self.arrived, other.arrived, strict=True)]
        return TexelSums(gathered, arrived, self.rays + other.rays, self.samples + other.samples)

    def absorb(self, other: TexelSums) -> None:
        """Adds the other's, column by column, and leaves it without: a map of sums need not stand thrice."""
        for mine, more in ((self.gathered, other.gathered), (self.arrived, other.arrived)):
            for old, new in zip(mine, more, strict=True):
                for row in range(3):
                    old[row] = old[row] + new[row]
                    dr.eval(old[row])
                    new[row] = mi.Float()
        self.rays, self.samples = self.rays + other.rays, self.samples + other.samples
        dr.eval(self.rays, self.samples)
        other.rays, other.samples = mi.UInt32(), mi.UInt32()

    def where(self, mask: mi.Bool, other: TexelSums) -> TexelSums:
        """These sums where the mask holds, the other's elsewhere."""
        gathered = [dr.select(mask, a, b) for a, b in zip(self.gathered, other.gathered, strict=True)]
        arrived = [dr.select(mask, a, b) for a, b in zip(self.arrived, other.arrived, strict=True)]
        rays = dr.select(mask, self.rays, other.rays)
        return TexelSums(gathered, arrived, rays, dr.select(mask, self.samples, other.samples))

    def without_rays(self) -> TexelSums:
        """The next-event samples alone."""
        empty = TexelSums.empty(len(self.rays), len(self.gathered))
        return TexelSums(empty.gathered, [mi.Color3f(c) for c in self.arrived], empty.rays, self.samples)

    def counting_from(self, rays: int, samples: int) -> TexelSums:
        """The same sums, counted as if so many samples came before them."""
        return TexelSums(
            self.gathered,
            self.arrived,
            self.rays + dr.opaque(mi.UInt32, rays),
            self.samples + dr.opaque(mi.UInt32, samples),
        )

    def add(
        self, lanes: Lanes, gathered: list[mi.Color3f], arrived: list[mi.Color3f], n_rays: int, n_direct: int
    ) -> TexelSums:
        """Adds what the lanes of a pass brought, each texel's lanes in order, and evaluates.

        Args:
            lanes: Whom the pass served.
            gathered: By channel, sums over rays of each lane.
            arrived: The same of next-event samples.
            n_rays: Rays that each texel has been given.
            n_direct: Next-event samples likewise.
        """
        if lanes.per_texel > 1:
            summed = _sum_lanes([*gathered, *arrived], lanes)
            gathered, arrived = summed[: len(gathered)], summed[len(gathered) :]
        if lanes.served is not None:
            result = self.plus(TexelSums(gathered, arrived, lanes.count(n_rays), lanes.count(n_direct)))
        else:
            counts = dr.opaque(mi.UInt32, n_rays), dr.opaque(mi.UInt32, n_direct)
            result = TexelSums(
                [_add_at(old, new, lanes.texel) for old, new in zip(self.gathered, gathered, strict=True)],
                [_add_at(old, new, lanes.texel) for old, new in zip(self.arrived, arrived, strict=True)],
                _count_at(self.rays, counts[0], lanes.texel),
                _count_at(self.samples, counts[1], lanes.texel),
            )
        dr.eval(result.gathered, result.arrived, result.rays, result.samples)
        return result

    def to_arrays(self) -> dict[str, NDArray]:
        """Everything as host arrays: (C, 3, N) sums and (N,) counts."""
        return dict(self.each_array())

    def each_array(self) -> Iterator[tuple[str, NDArray]]:
        """The same one after the other, for those who need not hold them all."""
        yield "gathered", _to_host(self.gathered)
        yield "arrived", _to_host(self.arrived)
        yield "rays", np.array(self.rays)
        yield "samples", np.array(self.samples)

    @staticmethod
    def from_arrays(arrays: dict[str, NDArray]) -> TexelSums:
        """What :meth:`to_arrays` gave, back on the device, bit for bit."""
        gathered = [mi.Color3f(*[mi.Float(row) for row in colour]) for colour in arrays["gathered"]]
        arrived = [mi.Color3f(*[mi.Float(row) for row in colour]) for colour in arrays["arrived"]]
        return TexelSums(gathered, arrived, mi.UInt32(arrays["rays"]), mi.UInt32(arrays["samples"]))


def _to_host(colours: list[mi.Color3f]) -> NDArray[np.float32]:
    """(C, 3, N), column by column, so that no second copy of them all is made."""
    result = np.empty((len(colours), 3, len(colours[0].x)), np.float32)
    for channel, colour in enumerate(colours):
        for row in range(3):
            result[channel, row] = _read(colour[row])
    return result


def _read(column: mi.Float) -> NDArray[np.float32] | float:
    """A column, or the one number that a constant stands for: read as a whole it would take memory."""
    return column[0] if column.state == dr.VarState.Literal else np.array(column)


def _sum_lanes(colours: list[mi.Color3f], lanes: Lanes) -> list[mi.Color3f]:
    """Adds each texel's lanes in order; all columns as one array, so that it takes one launch."""
    columns = [column for colour in colours for column in colour]
    n_lanes = lanes.n_texels * lanes.per_texel
    lane = dr.arange(mi.UInt32, n_lanes)
    buffer = dr.zeros(mi.Float, n_lanes * len(columns))
    for number, column in enumerate(columns):  # opaque: a size in the code would compile it anew
        dr.scatter(buffer, column, lane + dr.opaque(mi.UInt32, number * n_lanes))
    sums = dr.block_reduce(dr.ReduceOp.Add, buffer, lanes.per_texel, mode="evaluated")
    row = dr.arange(mi.UInt32, lanes.n_texels)
    starts = [dr.opaque(mi.UInt32, number * lanes.n_texels) for number in range(len(columns))]
    read = [dr.gather(mi.Float, sums, row + start) for start in starts]
    return [mi.Color3f(*read[i : i + 3]) for i in range(0, len(read), 3)]


def _add_at(old: mi.Color3f, new: mi.Color3f, texel: mi.UInt32) -> mi.Color3f:
    result = mi.Color3f(old)
    for row, value in zip((0, 1, 2), new, strict=True):
        column = mi.Float(old[row])
        dr.scatter(column, dr.gather(mi.Float, old[row], texel) + value, texel)
        result[row] = column
    return result


def _count_at(old: mi.UInt32, n: mi.UInt32, texel: mi.UInt32) -> mi.UInt32:
    column = mi.UInt32(old)
    dr.scatter(column, dr.gather(mi.UInt32, old, texel) + n, texel)
    return column
