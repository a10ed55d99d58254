"""The ``.bin`` of SH probes, version 2, that the Unity project Neural Irradiance Cache trains from.

Little-endian, no magic::

    0   u32      probe count N
    4   f32 × 3  AABB minimum
    16  f32 × 3  AABB maximum
    28  u32      version, 2
    32  N × 12   positions, f32 × 3
    …   N × 48   12 f32: L0_R, L1x_R, L1y_R, L1z_R, the same of G, of B

The size is 32 + 60 N. Note the order x, y, z of L1, where ours is y, z, x. Public documents leave open
whether coefficients are of radiance or of irradiance: the caller says, and radiance is the default.
"""

from __future__ import annotations

import math
import struct
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from irradia.core.errors import InputError
from irradia.core.files import write_atomic

VERSION = 2
HEADER_BYTES, PROBE_BYTES = 32, 60
Quantity = Literal["radiance", "irradiance"]

_HEADER = struct.Struct("<I6fI")
_FILE_FROM_OURS = [0, 3, 1, 2]  # L0, x, y, z of our L0, y, z, x
_OURS_FROM_FILE = [0, 2, 3, 1]
_IRRADIANCE_OF_RADIANCE = np.array([math.pi] + [2.0 * math.pi / 3.0] * 3)[:, None]


@dataclass(frozen=True)
class BinProbes:
    """What such a file holds.

    Attributes:
        positions: (N, 3) metres.
        coefficients: (N, 4, 3) of radiance in our order: L0, y, z, x.
        aabb: (2, 3) minimum and maximum, by which a field normalises positions.
    """

    positions: NDArray[np.float32]
    coefficients: NDArray[np.float32]
    aabb: NDArray[np.float32]


def write_probes_bin(
    path: Path | str,
    positions: NDArray[np.float32],
    coefficients: NDArray[np.float32],
    *,
    aabb: NDArray[np.float32] | None = None,
    quantity: Quantity = "radiance",
) -> None:
    """Writes probes, whole or not at all.

    Args:
        path: The ``.bin``.
        positions: (N, 3) metres.
        coefficients: (N, 4 or 9, 3) of radiance in our order; L2 has no place in the file.
        aabb: (2, 3); None takes the positions' own.
        quantity: What the stored coefficients shall be of.
    """
    with write_atomic(path) as stream:
        stream.write(encode_probes_bin(positions, coefficients, aabb=aabb, quantity=quantity))


def encode_probes_bin(
    positions: NDArray[np.float32],
    coefficients: NDArray[np.float32],
    *,
    aabb: NDArray[np.float32] | None = None,
    quantity: Quantity = "radiance",
) -> bytes:
    """The bytes of :func:`write_probes_bin`."""
    if len(positions) == 0 and aabb is None:
        aabb = np.zeros((2, 3), np.float32)
    low, high = (positions.min(axis=0), positions.max(axis=0)) if aabb is None else aabb
    header = encode_header(len(positions), np.array([low, high]), VERSION)
    return header + np.asarray(positions, "<f4").tobytes() + encode_coefficients(coefficients, quantity)


def encode_header(count: int, aabb: NDArray[np.float32], version: int) -> bytes:
    """The 32 bytes that both versions begin with.

    Raises:
        InputError: There are more points than the file can count.
    """
    if count >= 1 << 32:
        raise InputError(f"expected fewer than 2^32 points, found {count}", fix="Keep them as .samples.")
    return _HEADER.pack(count, *map(float, aabb.reshape(-1)), version)


def decode_header(data: bytes, where: str) -> tuple[int, NDArray[np.float32], int]:
    """Count, AABB (2, 3) and version, as they stand there.

    Raises:
        InputError: The file is shorter.
    """
    if len(data) < HEADER_BYTES:
        raise InputError(f"expected a header of {HEADER_BYTES} bytes, found {len(data)}", where=where)
    count, *corners, version = _HEADER.unpack_from(data)
    return count, np.array(corners, np.float32).reshape(2, 3), version


def encode_coefficients(coefficients: NDArray[np.float32], quantity: Quantity = "radiance") -> bytes:
    """The file's 48 bytes for each probe of (N, 4 or 9, 3) coefficients of radiance in our order."""
    series = np.asarray(coefficients, np.float64)[:, :4]
    if quantity == "irradiance":
        series = series * _IRRADIANCE_OF_RADIANCE
    return series[:, _FILE_FROM_OURS].transpose(0, 2, 1).astype("<f4").tobytes()


def read_probes_bin(path: Path | str, *, quantity: Quantity = "radiance") -> BinProbes:
    """Reads probes.

    Args:
        path: The ``.bin``.
        quantity: What the stored coefficients are of.

    Raises:
        InputError: The file is cut short, too long, of another version, or not what it says.
    """
    try:
        data = Path(path).read_bytes()
    except OSError as error:
        raise InputError(f"it can't be read: {error.strerror}", where=str(path)) from error
    return decode_probes_bin(data, str(path), quantity=quantity)


def decode_probes_bin(data: bytes, where: str = "probes", *, quantity: Quantity = "radiance") -> BinProbes:
    """See :func:`read_probes_bin`."""
    count, aabb, version = decode_header(data, where)
    if version != VERSION:
        raise InputError(
            f"expected version {VERSION} (SH probes), found {version}",
            where=where,
            fix="Version 1 holds irradiance at surface points, not probes.",
        )
    expected = HEADER_BYTES + PROBE_BYTES * count
    if len(data) != expected:
        raise InputError(f"expected {expected} bytes for {count} probes, found {len(data)}", where=where)
    positions = np.frombuffer(data, "<f4", 3 * count, HEADER_BYTES).reshape(-1, 3)
    stored = np.frombuffer(data, "<f4", 12 * count, HEADER_BYTES + 12 * count).reshape(-1, 3, 4)
    _check(aabb, positions, stored, where)
    series = stored.transpose(0, 2, 1)[:, _OURS_FROM_FILE].astype(np.float64)
    if quantity == "irradiance":
        series = series / _IRRADIANCE_OF_RADIANCE
    return BinProbes(positions.astype(np.float32), series.astype(np.float32), aabb)


def _check(
    aabb: NDArray[np.float32], positions: NDArray[np.float32], stored: NDArray[np.float32], where: str
) -> None:
    """Refuses numbers that can't be probes."""
    if not (np.isfinite(aabb).all() and np.all(aabb[0] <= aabb[1])):
        raise InputError(f"expected an AABB, found {aabb[0].tolist()} to {aabb[1].tolist()}", where=where)
    if not (np.isfinite(positions).all() and np.isfinite(stored).all()):
        raise InputError("expected finite positions and coefficients", where=where)
    slack = 1e-4 * np.maximum(aabb[1] - aabb[0], 1e-3)
    outside = np.any((positions < aabb[0] - slack) | (positions > aabb[1] + slack), axis=1)
    if outside.any():
        first = int(np.flatnonzero(outside)[0])
        raise InputError(f"expected every position in the AABB, but probe {first} is not", where=where)
