"""Where what can be made again is kept: one folder per user."""

from __future__ import annotations

import contextlib
import hashlib
import json
import os
import sys
import zipfile
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from irradia.core.files import write_atomic

VARIABLE = "IRRADIA_CACHE"


def cache_dir() -> Path:
    """The user's cache folder; ``IRRADIA_CACHE`` overrides it. It need not exist yet."""
    override = os.environ.get(VARIABLE)
    if override:
        return Path(override)
    if sys.platform == "win32":
        base = Path(os.environ.get("LOCALAPPDATA", Path.home() / "AppData" / "Local"))
    elif sys.platform == "darwin":
        base = Path.home() / "Library" / "Caches"
    else:
        base = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache")
    return base / "irradia"


def cached_path(kind: str, key: Mapping[str, Any], suffix: str) -> Path:
    """Where something that is fully told by ``key`` is kept.

    Args:
        kind: What it is; a folder.
        key: All that decides its content: plain JSON values, versions included.
        suffix: Of the file, with its dot.
    """
    text = json.dumps(key, sort_keys=True, allow_nan=False)
    return cache_dir() / kind / f"{hashlib.sha256(text.encode()).hexdigest()[:32]}{suffix}"


def cached_arrays(
    kind: str, key: Mapping[str, Any], make: Callable[[], dict[str, NDArray]]
) -> dict[str, NDArray]:
    """Arrays from the cache, or made and kept there.

    A file that can't be read is made again, and a cache that can't be written does no harm.

    Args:
        kind: See :func:`cached_path`.
        key: Likewise.
        make: Called where nothing is kept.
    """
    path = cached_path(kind, key, ".npz")
    try:
        with path.open("rb") as stream, np.load(stream, allow_pickle=False) as stored:
            return {name: stored[name] for name in stored.files}
    except (OSError, ValueError, KeyError, EOFError, zipfile.BadZipFile):
        made: dict[str, Any] = {**make()}
    with contextlib.suppress(OSError), write_atomic(path) as stream:
        np.savez(stream, **made)
    return made
