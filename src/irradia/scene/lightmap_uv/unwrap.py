"""Cuts a primitive into charts that lie flat, and keeps the answers by content."""

from __future__ import annotations

import hashlib
import zipfile
from pathlib import Path

import numpy as np

from irradia.core.cache import cache_dir
from irradia.core.files import write_atomic
from irradia.scene.lightmap_uv.blocks import block_charts
from irradia.scene.lightmap_uv.charts import Charts
from irradia.scene.lightmap_uv.projection import projected_charts
from irradia.scene.lightmap_uv.xatlas_charts import SETTINGS, xatlas_charts
from irradia.scene.types import F32, F64, U32, Primitive

_LARGE = 120_000  # triangles; xatlas takes about a minute for so many, and more than in proportion
_CACHED_FROM = 500  # triangles; smaller primitives unwrap faster than a file opens
_CACHE_VERSION = "unwrap-2"


def unwrap(primitive: Primitive, linear: F64, *, use_cache: bool = True) -> Charts:
    """Charts of a primitive as it stands in the world.

    Args:
        primitive: Triangles in object space.
        linear: (3, 3) world from object without the translation; uneven scales are unfolded as they are.
        use_cache: Whether to look in, and add to, the user's cache.
    """
    positions = np.ascontiguousarray(primitive.positions.astype(np.float64) @ linear.T)
    normals = np.ascontiguousarray(primitive.normals @ _cofactor(linear).T, np.float32)
    keep = use_cache and len(primitive.indices) >= _CACHED_FROM
    path = _cache_path(positions, normals, primitive.indices) if keep else None
    charts = _read(path) if path else None
    if charts is None:
        charts = _cut(positions, normals, primitive.indices)
        if path:
            _write(path, charts)
    return charts


def _cut(positions: F64, normals: F32, indices: U32) -> Charts:
    """Charts of a mesh: xatlas's, or, where that would take minutes, quicker ones."""
    if len(indices) < _LARGE:
        return xatlas_charts(positions, normals, indices)
    return projected_charts(positions, indices) or block_charts(positions, normals, indices)


def _cofactor(linear: F64) -> F64:
    """Takes normals along; finite where the inverse transpose is not."""
    a, b, c = linear
    return np.stack([np.cross(b, c), np.cross(c, a), np.cross(a, b)])


def _cache_path(positions: F64, normals: F32, indices: U32) -> Path:
    import xatlas

    digest = hashlib.sha256(f"{_CACHE_VERSION} {xatlas.__version__} {SETTINGS}".encode())
    for array in (positions, normals, indices):
        digest.update(f"{array.shape} {array.dtype}".encode())
        digest.update(np.ascontiguousarray(array).tobytes())
    return cache_dir() / "unwrap" / f"{digest.hexdigest()[:32]}.npz"


def _read(path: Path) -> Charts | None:
    """What the cache holds, or None where it holds nothing or something broken."""
    try:
        with path.open("rb") as stream, np.load(stream, allow_pickle=False) as stored:
            return Charts(**{name: stored[name] for name in Charts.__dataclass_fields__})
    except (OSError, KeyError, ValueError, EOFError, zipfile.BadZipFile):
        return None


def _write(path: Path, charts: Charts) -> None:
    """Adds to the cache; a folder that can't be written to only costs the next run's time."""
    try:
        with write_atomic(path) as stream:
            np.savez(stream, **{name: getattr(charts, name) for name in Charts.__dataclass_fields__})
    except OSError:
        return
