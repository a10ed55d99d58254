"""A probe grid for three.js: what its ``LightProbeGrid`` keeps in its texture, as one JSON file.

three.js (r187) has no file for it, but a fixed layout: an RGBA half-float 3D texture of nx × ny ×
7 (nz + 2) texels. Seven sub-volumes stand one behind another along z, each with its first and last
slice repeated as padding. Together they hold 27 numbers, nine SH coefficients of radiance times RGB,
one after another::

    volume  0           1           2           3           4           5           6
    rgba    c0 c0 c0 c1 c1 c1 c2 c2 c2 c3 c3 c3 c4 c4 c4 c5 c5 c5 c6 c6 c6 c7 c7 c7 c8 c8 c8 0

Order and constants of its SH are ours. Its box holds one cell per probe with the probe in the middle,
so it is half a spacing larger on each side than the outermost probes; width, height and depth below
are the box's, ``position`` its centre. The texture's numbers are ours times nothing: it wants radiance
coefficients and makes E of them, as three.js' lit materials do.

The JSON: {"version": 1, "type": "LightProbeGrid", "width", "height", "depth", "resolution": [x, y, z],
"position": [x, y, z], "light": "full" or "indirect", "texture": {"width", "height", "depth",
"format": "rgba16f", "data": base64 of little-endian halfs, x fastest}}.
"""

from __future__ import annotations

import base64
import binascii
import json
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from irradia.core.errors import InputError
from irradia.core.files import write_text_atomic
from irradia.formats.probes import ProbeGrid, ProbeLight, ProbeSet

VERSION = 1
N_VOLUMES, PADDING = 7, 1
_HALF_MAX = 65504.0
_MAX_PROBES = 1 << 22


@dataclass(frozen=True)
class ThreeGrid:
    """What such a file holds.

    Attributes:
        grid: Where the probes stand.
        coefficients: (N, 9, 3) of radiance, rounded to half.
        light: What is in them.
    """

    grid: ProbeGrid
    coefficients: NDArray[np.float32]
    light: ProbeLight


def pack_atlas(coefficients: NDArray[np.float32], shape: tuple[int, int, int]) -> NDArray[np.float16]:
    """(7 (nz + 2), ny, nx, 4) texels of probes (N, 9, 3) in a grid's order."""
    nx, ny, nz = shape
    numbers = np.zeros((nz, ny, nx, 4 * N_VOLUMES), np.float32)
    numbers[..., :27] = coefficients.reshape(nz, ny, nx, 27)
    volumes = np.clip(numbers, -_HALF_MAX, _HALF_MAX).reshape(nz, ny, nx, N_VOLUMES, 4)
    stacked = volumes.transpose(3, 0, 1, 2, 4)
    padded = np.pad(stacked, ((0, 0), (PADDING, PADDING), (0, 0), (0, 0), (0, 0)), mode="edge")
    return padded.reshape(-1, ny, nx, 4).astype(np.float16)


def unpack_atlas(texels: NDArray[np.float16]) -> NDArray[np.float32]:
    """(N, 9, 3) of :func:`pack_atlas`."""
    depth, ny, nx, _ = texels.shape
    volumes = texels.reshape(N_VOLUMES, depth // N_VOLUMES, ny, nx, 4)[:, PADDING:-PADDING]
    numbers = volumes.transpose(1, 2, 3, 0, 4).reshape(-1, 4 * N_VOLUMES)[:, :27]
    return numbers.astype(np.float32).reshape(-1, 9, 3)


def write_three_grid(path: Path | str, probes: ProbeSet) -> None:
    """Writes the probes of a grid.

    Raises:
        InputError: They don't stand in a grid, which is all that LightProbeGrid knows.
    """
    grid = probes.structure
    if not isinstance(grid, ProbeGrid):
        raise InputError("expected probes in a grid", where=str(path), fix="Bake with --probes grid:SPACING.")
    atlas = pack_atlas(probes.coefficients, grid.shape)
    shape = np.array(grid.shape)
    width, height, depth = (float(v) for v in shape * grid.spacing)
    document = {
        "version": VERSION,
        "type": "LightProbeGrid",
        "width": width,
        "height": height,
        "depth": depth,
        "resolution": list(grid.shape),
        "position": (grid.origin + 0.5 * (shape - 1) * grid.spacing).astype(float).tolist(),
        "light": probes.light,
        "texture": {
            "width": atlas.shape[2],
            "height": atlas.shape[1],
            "depth": atlas.shape[0],
            "format": "rgba16f",
            "data": base64.b64encode(atlas.astype("<f2").tobytes()).decode("ascii"),
        },
    }
    write_text_atomic(path, json.dumps(document))


def read_three_grid(path: Path | str) -> ThreeGrid:
    """Reads what :func:`write_three_grid` wrote.

    Raises:
        InputError: It is damaged or no such file.
    """
    where = str(path)
    try:
        document = json.loads(Path(path).read_text(encoding="utf-8"))
        if document["type"] != "LightProbeGrid" or document["version"] != VERSION:
            raise InputError(f"expected a LightProbeGrid of version {VERSION}", where=where)
        nx, ny, nz = (int(v) for v in document["resolution"])
        size = np.array([document[key] for key in ("width", "height", "depth")], np.float64)
        position = np.array(document["position"], np.float64)
        light = document["light"]
        data = base64.b64decode(document["texture"]["data"], validate=True)
    except (OSError, ValueError, KeyError, TypeError, binascii.Error) as error:
        raise InputError(f"it can't be read as a LightProbeGrid: {error!r}", where=where) from error
    if min(nx, ny, nz) < 1 or nx * ny * nz > _MAX_PROBES or light not in ("full", "indirect"):
        raise InputError(
            f"expected a grid with full or indirect light, found {nx} × {ny} × {nz}", where=where
        )
    expected = 8 * nx * ny * N_VOLUMES * (nz + 2 * PADDING)
    if len(data) != expected or position.shape != (3,):
        raise InputError(f"expected {expected} bytes of texels, found {len(data)}", where=where)
    texels = np.frombuffer(data, "<f2").reshape(-1, ny, nx, 4)
    spacing = size / (nx, ny, nz)
    origin = position - 0.5 * size + 0.5 * spacing
    grid = ProbeGrid(origin.astype(np.float32), spacing.astype(np.float32), (nx, ny, nz))
    return ThreeGrid(grid, unpack_atlas(texels), light)
