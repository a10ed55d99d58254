"""Light probes, and ``probes.npz``: all that Irradia knows of them, for tools in Python.

An .npz is a zip of arrays. Ours holds::

    version        ()            1
    positions      (N, 3)    f4  where each probe stands in its lattice, metres
    offsets        (N, 3)    f4  from there to where its light was gathered
    coefficients   (N, 9, 3) f4  SH of incoming radiance, windowed so that E ≥ 0; linear Rec.709
    validity       (N,)      f4  share of directions in which no back face was seen
    state          (N,)      u1  0 valid, 1 filled from its neighbours, 2 empty
    sky            (N, 4)    f4  SH to L1 of the sky's visibility; 3.5449, 0, 0, 0 is all of it
    distance       (N, S, S, 2) f4  octahedral map: mean and standard deviation of how far it sees
    reach          (N,)      f4  distances are cut off there, metres
    light          ()        str ``full`` or ``indirect``
    provenance     ()        str JSON
    grid_*                       of a grid: origin (3,), spacing (3,), shape (3,)
    octree_*                     of an octree: origin (3,), size (), cells (C, 4), corners (C, 8)

Order and signs of SH are in docs/conventions.md, the use of each array in docs/probes.md.
"""

from __future__ import annotations

import io
import json
import math
import zipfile
import zlib
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from irradia.core.errors import InputError
from irradia.core.files import write_atomic

VERSION = 1
VALID, FILLED, EMPTY = 0, 1, 2
NO_PROBE = 0xFFFFFFFF
MAX_BYTES = 1 << 32  # of all arrays together: more is damage, or an attack

ProbeLight = Literal["full", "indirect"]
F32 = NDArray[np.float32]


@dataclass(frozen=True)
class ProbeGrid:
    """A lattice; probe x + nx · (y + ny · z) stands at ``origin + spacing · (x, y, z)``.

    Attributes:
        origin: (3,) of probe 0, metres.
        spacing: (3,) metres.
        shape: (nx, ny, nz).
    """

    origin: F32
    spacing: F32
    shape: tuple[int, int, int]


@dataclass(frozen=True)
class ProbeOctree:
    """Leaves of an octree, with a probe at each corner that isn't inside something solid.

    Attributes:
        origin: (3,) corner of smallest coordinates, metres.
        size_m: Edge of a cell of level 0; a level further it is half of that.
        cells: (C, 4) place x, y, z in cells of its own level, and the level.
        corners: (C, 8) probe or NO_PROBE; bit 0 of the column is +x, bit 1 +y, bit 2 +z.
    """

    origin: F32
    size_m: float
    cells: NDArray[np.int32]
    corners: NDArray[np.uint32]


@dataclass(frozen=True)
class ProbeSet:
    """Light probes of a scene.

    Attributes:
        positions, offsets: (N, 3) metres.
        coefficients: (N, 9, 3) of radiance, windowed.
        validity: (N,) in [0, 1].
        state: (N,) VALID, FILLED or EMPTY.
        sky: (N, 4).
        distance: (N, S, S, 2) metres; row 0 is v = 0.
        reach: (N,) metres.
        light: ``indirect`` leaves out the first bounce of mixed and realtime lights.
        structure: What interpolation goes by; None for loose probes.
        provenance: Anything that JSON holds.
    """

    positions: F32
    offsets: F32
    coefficients: F32
    validity: F32
    state: NDArray[np.uint8]
    sky: F32
    distance: F32
    reach: F32
    light: ProbeLight = "full"
    structure: ProbeGrid | ProbeOctree | None = None
    provenance: Mapping[str, Any] = field(default_factory=dict)

    def __len__(self) -> int:
        return len(self.positions)

    @property
    def places(self) -> F32:
        """(N, 3) where light was gathered."""
        return self.positions + self.offsets


def write_probes(path: Path | str, probes: ProbeSet) -> None:
    """Writes ``probes.npz``, whole or not at all; the same probes give the same bytes."""
    with write_atomic(path) as stream:
        np.savez_compressed(stream, **_arrays(probes))


def read_probes(path: Path | str) -> ProbeSet:
    """Reads ``probes.npz``.

    Raises:
        InputError: It is damaged, of another version, or its arrays don't fit together.
    """
    where = str(path)
    arrays = _load(path)
    version = int(_take(arrays, "version", (), "iu", where))
    if version != VERSION:
        raise InputError(f"expected probes of version {VERSION}, found {version}", where=where)
    n = len(_take(arrays, "positions", (None, 3), "f", where))
    size = _take(arrays, "distance", (n, None, None, 2), "f", where).shape[1]
    light = str(_take(arrays, "light", (), "U", where))
    if light not in ("full", "indirect"):
        raise InputError(f"expected light to be full or indirect, found '{light}'", where=where)
    state = _take(arrays, "state", (n,), "u", where).astype(np.uint8)
    if state.size and state.max() > EMPTY:
        raise InputError(f"expected a state of 0 to {EMPTY}, found {state.max()}", where=where)
    return ProbeSet(
        positions=_take(arrays, "positions", (n, 3), "f", where),
        offsets=_take(arrays, "offsets", (n, 3), "f", where),
        coefficients=_take(arrays, "coefficients", (n, 9, 3), "f", where),
        validity=_take(arrays, "validity", (n,), "f", where),
        state=state,
        sky=_take(arrays, "sky", (n, 4), "f", where),
        distance=_take(arrays, "distance", (n, size, size, 2), "f", where),
        reach=_take(arrays, "reach", (n,), "f", where),
        light="full" if light == "full" else "indirect",
        structure=_structure(arrays, n, where),
        provenance=_provenance(arrays, where),
    )


def check_structure(structure: ProbeGrid | ProbeOctree | None, n: int, where: str) -> None:
    """Refuses a structure that doesn't belong to ``n`` probes.

    Raises:
        InputError: With what doesn't fit.
    """
    if isinstance(structure, ProbeGrid):
        nx, ny, nz = structure.shape
        if min(structure.shape) < 1 or nx * ny * nz != n:
            raise InputError(f"expected a grid of {n} probes, found {nx} × {ny} × {nz}", where=where)
        if not (np.all(np.isfinite(structure.origin)) and np.all(structure.spacing > 0.0)):
            raise InputError("expected a grid's spacing to be above 0", where=where)
    if isinstance(structure, ProbeOctree):
        known = structure.corners[structure.corners != NO_PROBE]
        if known.size and int(known.max()) >= n:
            raise InputError(f"expected corners below {n}, found {int(known.max())}", where=where)
        levels = structure.cells[:, 3]
        if levels.size and (int(levels.min()) < 0 or int(levels.max()) >= 16):
            raise InputError("expected an octree's levels to be 0 to 15", where=where)
        if not (np.isfinite(structure.size_m) and structure.size_m > 0.0):
            raise InputError("expected an octree's cells to have a size", where=where)


def _arrays(probes: ProbeSet) -> dict[str, Any]:
    arrays: dict[str, Any] = {
        "version": np.array(VERSION, np.int32),
        "light": np.array(probes.light),
        "provenance": np.array(json.dumps(dict(probes.provenance), sort_keys=True)),
        "state": probes.state,
    }
    for name in ("positions", "offsets", "coefficients", "validity", "sky", "distance", "reach"):
        arrays[name] = np.asarray(getattr(probes, name), "<f4")
    match probes.structure:
        case ProbeGrid(origin, spacing, shape):
            arrays |= {
                "grid_origin": origin,
                "grid_spacing": spacing,
                "grid_shape": np.array(shape, np.int32),
            }
        case ProbeOctree(origin, size_m, cells, corners):
            arrays |= {"octree_origin": origin, "octree_size": np.float32(size_m)}
            arrays |= {"octree_cells": cells, "octree_corners": corners}
    return arrays


def _structure(arrays: Mapping[str, NDArray], n: int, where: str) -> ProbeGrid | ProbeOctree | None:
    structure = None
    if "grid_shape" in arrays:
        shape = _take(arrays, "grid_shape", (3,), "iu", where)
        origin = _take(arrays, "grid_origin", (3,), "f", where)
        spacing = _take(arrays, "grid_spacing", (3,), "f", where)
        structure = ProbeGrid(origin, spacing, (int(shape[0]), int(shape[1]), int(shape[2])))
    elif "octree_cells" in arrays:
        cells = _take(arrays, "octree_cells", (None, 4), "iu", where).astype(np.int32)
        structure = ProbeOctree(
            _take(arrays, "octree_origin", (3,), "f", where),
            float(_take(arrays, "octree_size", (), "f", where)),
            cells,
            _take(arrays, "octree_corners", (len(cells), 8), "u", where).astype(np.uint32),
        )
    check_structure(structure, n, where)
    return structure


def _load(path: Path | str) -> dict[str, NDArray]:
    """The file's arrays, after a look at how large they say they are."""
    where = str(path)
    try:
        with zipfile.ZipFile(path) as archive:
            entries = archive.infolist()
            claimed = sum(entry.file_size for entry in entries)
            if claimed > MAX_BYTES:
                raise InputError(f"expected at most {MAX_BYTES} bytes, found {claimed}", where=where)
            return {entry.filename.removesuffix(".npy"): _load_array(archive, entry) for entry in entries}
    except (OSError, ValueError, EOFError, zlib.error, zipfile.BadZipFile, NotImplementedError) as error:
        raise InputError(f"it can't be read as probes: {error}", where=where) from error


def _load_array(archive: zipfile.ZipFile, entry: zipfile.ZipInfo) -> NDArray:
    """One array, never larger than the bytes that hold it."""
    data = archive.read(entry)
    stream = io.BytesIO(data)
    if np.lib.format.read_magic(stream) != (1, 0):
        raise ValueError(f"{entry.filename} is no array of a kind that is written here")
    shape, _, dtype = np.lib.format.read_array_header_1_0(stream)
    if math.prod(shape) * dtype.itemsize != len(data) - stream.tell():
        raise ValueError(f"{entry.filename} has another size than its header says")
    stream.seek(0)
    return np.lib.format.read_array(stream, allow_pickle=False)


def _take(
    arrays: Mapping[str, NDArray], name: str, shape: tuple[int | None, ...], kinds: str, where: str
) -> NDArray[Any]:
    """An array of the expected shape (None fits any) and kind; floats are made float32, and finite."""
    if name not in arrays:
        raise InputError(f"expected an array '{name}'", where=where, fix="Bake the probes again.")
    found = arrays[name]
    fits = len(found.shape) == len(shape) and all(
        wanted in (None, size) for wanted, size in zip(shape, found.shape, strict=True)
    )
    if not fits or found.dtype.kind not in kinds:
        expected = ", ".join("any" if wanted is None else str(wanted) for wanted in shape)
        raise InputError(
            f"expected '{name}' of shape ({expected}), found {found.dtype} {found.shape}", where=where
        )
    if found.dtype.kind == "f":
        found = found.astype(np.float32)
        if not np.isfinite(found).all():
            raise InputError(f"expected '{name}' to be finite", where=where)
    return found


def _provenance(arrays: Mapping[str, NDArray], where: str) -> dict[str, Any]:
    try:
        return dict(json.loads(str(_take(arrays, "provenance", (), "U", where))))
    except (ValueError, TypeError) as error:
        raise InputError(f"its provenance is no JSON object: {error}", where=where) from error
