"""Threads that run a kernel together.

Kernels are compiled with ``nogil``, and each thread of a team calls the same kernel once. They share a
counter of tasks: a thread takes the next task until none are left. So a slow thread holds up nobody, and as
tasks write to memory of their own, the result doesn't depend on who took which.

This is instead of Numba's ``parallel=True``: its default threading layer ends the process when two threads
of a program use it at once, and its ``prange`` deals tasks out beforehand and takes seconds more to compile.
"""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from threading import Lock
from typing import Any

import numpy as np

from irradia.core.device import available_threads
from irradia.core.errors import InputError


class Team:
    """A fixed number of threads, the caller among them; callers wait for each other.

    Attributes:
        n_threads: How many run each kernel.

    Raises:
        InputError: On a number below 1.
    """

    def __init__(self, n_threads: int | None = None) -> None:
        if n_threads is not None and n_threads < 1:
            raise InputError(f"expected at least 1 thread, found {n_threads}", where="--threads")
        self.n_threads = n_threads or available_threads()
        self._helpers = ThreadPoolExecutor(max(self.n_threads - 1, 1), thread_name_prefix="irradia-field")
        self._next_task = np.zeros(1, np.int64)
        self._busy = Lock()

    def run(self, kernel: Callable[..., None], *arguments: Any) -> None:
        """Calls ``kernel(thread, next_task, *arguments)`` on every thread and waits for all.

        Args:
            kernel: Compiled by :func:`irradia.field.backends.numba_compile.kernel`; takes its tasks by
                ``take(next_task)``, and may use scratch memory that belongs to number ``thread``.
            arguments: Arrays, numbers and named tuples of them.
        """
        with self._busy:
            self._next_task[0] = 0
            others = range(1, self.n_threads)
            running = [self._helpers.submit(kernel, i, self._next_task, *arguments) for i in others]
            try:
                kernel(0, self._next_task, *arguments)
            finally:
                for call in running:
                    if not call.cancel():  # one that hasn't begun would find no task left
                        call.result()
