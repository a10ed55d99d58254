"""What fields are measured against: grids of SH probes as engines store them."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from irradia.core.errors import InputError
from irradia.core.sh import light_on

F32 = NDArray[np.float32]
_POINTS_AT_ONCE = 1 << 15  # keeps what is gathered in cache
HALF_BYTES = 2


@dataclass(frozen=True)
class ShGrid:
    """Probes on a lattice, read trilinearly, without a thought of what stands between.

    Attributes:
        origin: (3,) of the first probe, metres.
        spacing: (3,) metres.
        coefficients: (nz, ny, nx, k, 3) half floats, k = 4 or 9 in the project's order.
        scale: A power of two; times the coefficients it is radiance.
    """

    origin: F32
    spacing: F32
    coefficients: NDArray[np.float16]
    scale: float = 1.0

    @staticmethod
    def of(origin: F32, spacing: F32, shape: tuple[int, int, int], coefficients: F32, order: int) -> ShGrid:
        """Rounds probes x + nx · (y + ny · z), (N, 9, 3), to halves of SH of an order, 1 or 2."""
        nx, ny, nz = shape
        kept = coefficients[:, : n_coefficients(order)]
        scale = _half_scale(kept)
        halves = (kept / np.float32(scale)).astype(np.float16)
        return ShGrid(origin, spacing, halves.reshape(nz, ny, nx, -1, 3), scale)

    @property
    def n_bytes(self) -> int:
        """Of the coefficients."""
        return self.coefficients.nbytes

    def irradiance(self, positions: F32, normals: F32) -> F32:
        """E, (N, 3) W·m⁻², at positions (N, 3) in metres and unit normals (N, 3); never negative.

        Places outside the lattice take the light of its border.
        """
        result = np.empty((len(positions), 3), np.float32)
        for first in range(0, len(positions), _POINTS_AT_ONCE):
            part = slice(first, first + _POINTS_AT_ONCE)
            result[part] = self._some(positions[part], normals[part])
        return result

    def _some(self, positions: F32, normals: F32) -> F32:
        nz, ny, nx, k = self.coefficients.shape[:4]
        last = np.array([nx - 1, ny - 1, nz - 1], np.float32)
        place = np.clip((positions - self.origin) / self.spacing, 0.0, last)
        low = np.minimum(place.astype(np.int64), np.maximum(last.astype(np.int64) - 1, 0))
        fraction = (place - low).astype(np.float32)
        table = self.coefficients.reshape(-1, k * 3)
        series = np.zeros((len(positions), k * 3), np.float32)
        for corner in range(8):
            step = np.array([corner & 1, corner >> 1 & 1, corner >> 2])
            x, y, z = np.minimum(low + step, last.astype(np.int64)).T
            weight = np.prod(np.where(step, fraction, 1.0 - fraction), axis=1, dtype=np.float32)
            series += weight[:, None] * table[x + nx * (y + ny * z)].astype(np.float32)
        light = light_on(series.reshape(-1, k, 3), normals) * self.scale
        return light.astype(np.float32)


def _half_scale(values: F32) -> float:
    """The power of two by which values become those that halves hold best: up to 2¹⁵."""
    largest = float(np.abs(values).max(initial=0.0))
    return math.ldexp(1.0, math.frexp(largest)[1] - 15) if largest > 0.0 else 1.0


def n_coefficients(order: int) -> int:
    """Of SH of an order."""
    return (order + 1) ** 2


def probe_bytes(order: int) -> int:
    """Of one probe in halves: 24 for order 1, 54 for order 2."""
    return n_coefficients(order) * 3 * HALF_BYTES


def spacing_for(extent: NDArray, n_probes: int) -> float:
    """The spacing, the same along all axes, at which a lattice over a box has at most ``n_probes``.

    Args:
        extent: (3,) of the box, metres.
        n_probes: At least 1.

    Raises:
        InputError: Not even one probe is allowed.
    """
    if n_probes < 1:
        raise InputError("expected room for one probe at least", fix="Compare with a larger field.")
    low, high = 1e-6 * float(np.max(extent)), 4.0 * float(np.max(extent))
    for _ in range(60):
        middle = float(np.sqrt(low * high))
        fits = np.prod(np.maximum(np.round(np.asarray(extent) / middle), 1.0)) <= n_probes
        low, high = (low, middle) if fits else (middle, high)
    return high
