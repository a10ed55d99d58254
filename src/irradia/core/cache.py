"""Where what can be made again is kept: one folder per user."""

from __future__ import annotations

import os
import sys
from pathlib import Path

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
