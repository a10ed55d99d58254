"""Datasets of the Unity project Neural Irradiance Cache, as the same samples that our own files hold.

Version 2 is SH probes: :mod:`irradia.formats.probes_bin`. What version 1 looks like no public document
says. Ours, little-endian::

    0   u32      count N
    4   f32 × 3  AABB minimum
    16  f32 × 3  AABB maximum
    28  u32      version, 1
    32  N × 12   positions, f32 × 3, metres
    …   N × 12   unit normals, f32 × 3
    …   N × 12   irradiance E, f32 × 3

The size is 32 + 36 N. The reader also tries rows of position, normal and irradiance: the layout whose
positions lie in the AABB and whose normals have length 1 is the right one, and the samples' provenance
names it.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import IO, Literal

import numpy as np
from numpy.typing import NDArray

from irradia.core.errors import InputError
from irradia.core.files import write_atomic
from irradia.formats import probes_bin
from irradia.formats.probes_bin import HEADER_BYTES
from irradia.formats.sample_rows import F32, Quantity, SampleInfo, check_rows
from irradia.formats.samples import SampleFile

VERSION = 1
SAMPLE_BYTES = 36
BLOCK_ROWS = 1 << 18  # written at a time
Layout = Literal["planar", "interleaved"]


@dataclass(frozen=True)
class BinOptions:
    """What such files don't say of themselves.

    Attributes:
        coefficients: What the SH coefficients of version 2 are of.
        quantity: What light it is.
    """

    coefficients: probes_bin.Quantity = "radiance"
    quantity: Quantity = "full"


def read_samples_bin(path: Path | str, options: BinOptions | None = None) -> SampleFile:
    """Reads a dataset of either version into memory; variances are 0, for the file has none.

    Raises:
        InputError: It is cut short, too long, of another version, or not what it says.
    """
    options = options or BinOptions()
    try:
        data = Path(path).read_bytes()
    except OSError as error:
        raise InputError(f"it can't be read: {error.strerror}", where=str(path)) from error
    count, aabb, version = probes_bin.decode_header(data, str(path))
    if version == probes_bin.VERSION:
        return _from_probes(Path(path), data, options)
    if version != VERSION:
        raise InputError(
            f"expected version {VERSION} (irradiance) or {probes_bin.VERSION} (SH), found {version}",
            where=str(path),
            fix="Give a dataset that `irradia sample` or the Unity project wrote.",
        )
    expected = HEADER_BYTES + SAMPLE_BYTES * count
    if len(data) != expected or count == 0:
        raise InputError(f"expected {expected} bytes for {count} samples, found {len(data)}", where=str(path))
    return _from_irradiance(Path(path), data, aabb, options)


def write_samples_bin(
    path: Path | str, samples: SampleFile, *, coefficients: probes_bin.Quantity = "radiance"
) -> None:
    """Writes SH samples as version 2, others as version 1, whole or not at all; memory stays small.

    Args:
        path: The ``.bin``.
        samples: Of any file; variances and L2 have no place in it.
        coefficients: What the stored coefficients of SH shall be of.
    """
    is_sh = samples.info.kind == "sh"
    version = probes_bin.VERSION if is_sh else VERSION
    with write_atomic(path) as stream:
        stream.write(probes_bin.encode_header(len(samples), samples.aabb, version))
        _write_columns(stream, samples.positions)
        if is_sh:
            for block in _blocks(samples.values):
                series = block.reshape(len(block), -1, 3)
                stream.write(probes_bin.encode_coefficients(series, coefficients))
            return
        if samples.normals is not None:
            _write_columns(stream, samples.normals)
        _write_columns(stream, samples.values)


def _from_probes(path: Path, data: bytes, options: BinOptions) -> SampleFile:
    probes = probes_bin.decode_probes_bin(data, str(path), quantity=options.coefficients)
    if len(probes.positions) == 0:
        raise InputError("expected probes, found none", where=str(path))
    info = SampleInfo(
        kind="sh",
        aabb=_box(probes.aabb),
        quantity=options.quantity,
        n_coefficients=4,
        provenance={"format": "bin", "version": probes_bin.VERSION, "coefficients": options.coefficients},
    )
    rows = np.zeros((len(probes.positions), info.n_columns), np.float32)
    rows[:, :3] = probes.positions
    rows[:, 3:-1] = probes.coefficients.reshape(len(rows), -1)
    return SampleFile(path, info, rows)


def _from_irradiance(path: Path, data: bytes, aabb: NDArray[np.float32], options: BinOptions) -> SampleFile:
    """The first layout whose rows are samples; the error is the first one's where none is."""
    if not (np.isfinite(aabb).all() and np.all(aabb[0] <= aabb[1])):
        raise InputError(f"expected an AABB, found {aabb.tolist()}", where=str(path))
    numbers = np.frombuffer(data, "<f4", offset=HEADER_BYTES)
    complaints: list[str] = []
    for layout, columns in _layouts(numbers):
        info = SampleInfo(
            kind="surface",
            aabb=_box(aabb),
            quantity=options.quantity,
            provenance={"format": "bin", "version": VERSION, "layout": layout},
        )
        rows = np.zeros((len(columns), info.n_columns), np.float32)
        rows[:, :9] = columns
        try:
            check_rows(rows, info, str(path))
        except InputError as error:
            complaints.append(f"{layout}: {error.message}")
        else:
            return SampleFile(path, info, rows)
    raise InputError("; ".join(complaints), where=str(path), fix="Its layout is neither of those known.")


def _layouts(numbers: F32) -> Iterator[tuple[Layout, F32]]:
    yield "planar", numbers.reshape(3, -1, 3).transpose(1, 0, 2).reshape(-1, 9)
    yield "interleaved", numbers.reshape(-1, 9)


def _box(aabb: F32) -> tuple[tuple[float, float, float], tuple[float, float, float]]:
    (x0, y0, z0), (x1, y1, z1) = aabb.tolist()
    return (x0, y0, z0), (x1, y1, z1)


def _blocks(rows: F32) -> Iterator[F32]:
    for first in range(0, len(rows), BLOCK_ROWS):
        yield rows[first : first + BLOCK_ROWS]


def _write_columns(stream: IO[bytes], columns: F32) -> None:
    for block in _blocks(columns):
        stream.write(np.ascontiguousarray(block, "<f4").data)
