"""Bands of rows, worked on side by side: NumPy, zlib and our kernels let other threads run meanwhile."""

from __future__ import annotations

import os
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from typing import TypeVar

T = TypeVar("T")
_MAX_THREADS = 16  # each holds a band's temporaries


def map_bands(work: Callable[[slice], T], n_rows: int, band_rows: int) -> list[T]:
    """Calls ``work`` with slices of up to ``band_rows`` rows that cover all; returns what it gave, in order.

    What bands hold depends on ``band_rows`` alone, so results are the same on any number of cores.
    """
    bands = [slice(start, min(start + band_rows, n_rows)) for start in range(0, n_rows, band_rows)]
    n_threads = min(os.cpu_count() or 1, _MAX_THREADS, len(bands))
    if n_threads <= 1:
        return [work(band) for band in bands]
    with ThreadPoolExecutor(n_threads) as pool:
        return list(pool.map(work, bands))
