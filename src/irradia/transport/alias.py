"""Picking in proportion to weights."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from irradia.transport.backend import dr, mi


class AliasTable:
    """Picks an index in proportion to its weight in constant time (Vose 1991)."""

    def __init__(self, weights: NDArray[np.float64]) -> None:
        share = weights / weights.sum()
        threshold, alias = _vose(share * len(share))
        table = np.empty((len(share), 2), np.float32)
        table[:, 0] = threshold
        table[:, 1] = alias.astype(np.uint32).view(np.float32)
        self._table = mi.Float(table.ravel())
        self.size = len(share)

    def sample(self, u: mi.Float, active: mi.Bool) -> tuple[mi.UInt32, mi.Float]:
        """An index, and what is left of ``u`` as a fresh number."""
        scaled = u * self.size
        index = dr.minimum(mi.UInt32(scaled), self.size - 1)
        rest = dr.clip(scaled - mi.Float(index), 0.0, 1.0 - 2.0**-24)
        row = dr.gather(mi.Point2f, self._table, index, active)
        keep = rest < row.x
        fresh = dr.select(
            keep, rest / dr.maximum(row.x, 1e-20), (rest - row.x) / dr.maximum(1.0 - row.x, 1e-20)
        )
        other = dr.reinterpret_array(mi.UInt32, row.y)
        return dr.select(keep, index, other), dr.clip(fresh, 0.0, 1.0 - 2.0**-24)


def _vose(scaled: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Thresholds and aliases of weights whose mean is 1."""
    n = len(scaled)
    threshold, alias = np.ones(n), np.arange(n)
    remaining = scaled.copy()
    small, large = list(np.flatnonzero(scaled < 1.0)), list(np.flatnonzero(scaled >= 1.0))
    while small and large:
        low, high = small.pop(), large[-1]
        threshold[low], alias[low] = remaining[low], high
        remaining[high] -= 1.0 - remaining[low]
        if remaining[high] < 1.0:
            small.append(large.pop())
    return threshold, alias
