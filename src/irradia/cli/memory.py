"""The most memory that this process has used."""

from __future__ import annotations

import sys


def peak_memory_bytes() -> int | None:
    """Highest resident size so far, or None where the system doesn't tell."""
    try:
        import resource
    except ImportError:  # Windows
        return None
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return peak if sys.platform == "darwin" else peak * 1024  # kibibytes on Linux
