"""Filters that turn decoded integers into vectors, quaternions, floats and colours."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from irradia.scene.types import F32, U8


@dataclass(frozen=True)
class Filter:
    """A filter and the strides that it takes.

    Attributes:
        apply: (count, stride) bytes to as many bytes.
        strides: Allowed strides; empty for every multiple of 4.
    """

    apply: Callable[[U8], NDArray]
    strides: tuple[int, ...] = ()

    def takes(self, stride: int) -> bool:
        """Whether elements may have ``stride`` bytes."""
        return not self.strides or stride in self.strides


def octahedral(data: U8) -> NDArray:
    """Unit vectors from octahedral coordinates; the third component says what 1 is."""
    integers = data.view("<i1" if data.shape[1] == 4 else "<i2")
    one = np.maximum(integers[:, 2:3].astype(np.float32), 1.0)
    xy = integers[:, :2] / one
    z = 1.0 - np.abs(xy).sum(axis=1, keepdims=True)
    xy = xy - np.copysign(np.minimum(z, 0.0), xy)
    vectors = np.column_stack([xy, z])
    vectors /= np.linalg.norm(vectors, axis=1, keepdims=True)
    limit = np.iinfo(integers.dtype).max
    return np.column_stack([_round(vectors * limit), integers[:, 3]]).astype(integers.dtype)


def quaternion(data: U8) -> NDArray:
    """Unit quaternions from their three smaller components and the place of the largest."""
    integers = data.view("<i2")
    one = (integers[:, 3:4] | 3).astype(np.float32)
    smaller = integers[:, :3] / one * np.float32(np.sqrt(0.5))
    largest = np.sqrt(np.maximum(1.0 - (smaller**2).sum(axis=1), 0.0))
    place = integers[:, 3] & 3
    out = np.empty((len(integers), 4))
    rows = np.arange(len(integers))
    out[rows, place] = largest
    for k in range(3):
        out[rows, (place + k + 1) % 4] = smaller[:, k]
    return _round(out * 32767.0).astype("<i2")


def exponential(data: U8) -> F32:
    """Floats from an exponent in the top 8 bits and a mantissa of 24."""
    integers = data.view("<i4")
    return np.ldexp((integers << 8 >> 8).astype(np.float32), integers >> 24).astype("<f4")


def color(data: U8) -> NDArray:
    """RGBA from luma, two chroma channels and alpha; alpha's top bit says how many bits there are."""
    unsigned = data.view("<u1" if data.shape[1] == 4 else "<u2")
    signed = unsigned.view("<i1" if data.shape[1] == 4 else "<i2").astype(np.int64)
    coded_alpha = unsigned[:, 3].astype(np.int64)
    _, n_bits = np.frexp(coded_alpha.astype(np.float64))  # position of the highest bit
    full = (1 << n_bits.astype(np.int64)) - 1
    luma, orange, green = unsigned[:, 0].astype(np.int64), signed[:, 1], signed[:, 2]
    alpha = coded_alpha & (full >> 1)
    alpha = alpha << 1 | (alpha & 1)
    rgba = np.column_stack([luma + orange - green, luma + green, luma - orange - green, alpha])
    limit = np.iinfo(unsigned.dtype).max
    scaled = rgba * (limit / np.maximum(full, 1))[:, None]
    return np.clip(_round(scaled), 0, limit).astype(unsigned.dtype)


def _round(values: NDArray) -> NDArray:
    """To the nearest integer, halves away from 0."""
    return np.trunc(values + np.copysign(0.5, values))


FILTERS: dict[str, Filter] = {
    "NONE": Filter(lambda data: data),
    "OCTAHEDRAL": Filter(octahedral, (4, 8)),
    "QUATERNION": Filter(quaternion, (8,)),
    "EXPONENTIAL": Filter(exponential),
    "COLOR": Filter(color, (4, 8)),
}
