"""Threads of Numba's parallel loops: as many as ``--threads`` says, on every machine by the same means."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from threading import Lock
from typing import Any

_LAYER = "workqueue"  # comes with Numba everywhere; others depend on what else is installed
_busy = Lock()  # which it needs: two launches at once would end the process


@contextmanager
def kernel_threads() -> Iterator[None]:
    """While the block runs, kernels with ``prange`` take as many threads as were asked for."""
    import numba
    from numba.core import config

    from irradia.core.device import available_threads
    from irradia.transport import requested_device

    numba_settings: Any = config  # its names come from the environment, so that no checker knows them
    n_threads = min(requested_device().threads or available_threads(), numba_settings.NUMBA_NUM_THREADS)
    with _busy:
        numba_settings.THREADING_LAYER = _LAYER  # counts until the first launch
        before = numba.get_num_threads()
        numba.set_num_threads(n_threads)
        try:
            yield
        finally:
            numba.set_num_threads(before)
