"""What this machine can do at most: multiply-adds in registers, and bytes to and from memory."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from irradia.field.backends.numba_compile import kernel, take
from irradia.field.backends.numba_team import Team
from irradia.field.backends.numba_vector import fma, load8, splat8, store8
from irradia.field.backends.numba_vector_type import LANES

_CHAINS = 12  # independent sums: enough to hide an addition's latency, few enough for 16 registers
_TURNS = 1 << 22
_FLOATS = 1 << 24  # of each array: 64 MiB, more than caches hold
_PIECE = 1 << 16
_REPEATS = 5


@dataclass(frozen=True)
class Limits:
    """The best of a few runs on all threads.

    Attributes:
        flops: Per second; a multiply-add counts as two.
        bytes_per_s: Read and written by a triad; what a cache fetches before it is overwritten isn't counted.
    """

    flops: float
    bytes_per_s: float


def measure_limits(threads: int) -> Limits:
    """Takes about two seconds."""
    team = Team(threads)
    chains = np.zeros((threads, _CHAINS + 1, 16), np.float32)
    flops = 2.0 * LANES * _CHAINS * _TURNS * threads / _best(lambda: team.run(_multiply_adds, chains))
    a, b, c = (np.full(_FLOATS, value, np.float32) for value in (0.0, 1.0, 2.0))
    touched = 3.0 * a.nbytes / _best(lambda: team.run(_triad, a, b, c))
    return Limits(flops, touched)


def _best(run: Callable[[], None]) -> float:
    run()  # compiles
    seconds = []
    for _ in range(_REPEATS):
        begin = time.perf_counter()
        run()
        seconds.append(time.perf_counter() - begin)
    return min(seconds)


@kernel
def _multiply_adds(_thread, next_task, chains):
    """Chains x ← x · a + b, read from memory and written back so that the compiler can't leave one out."""
    while True:
        task = take(next_task)
        if task >= len(chains):
            break
        x = chains[task]
        a, b = load8(x, (12, 0)), splat8(1.0)
        x0, x1, x2, x3 = load8(x, (0, 0)), load8(x, (1, 0)), load8(x, (2, 0)), load8(x, (3, 0))
        x4, x5, x6, x7 = load8(x, (4, 0)), load8(x, (5, 0)), load8(x, (6, 0)), load8(x, (7, 0))
        x8, x9, y0, y1 = load8(x, (8, 0)), load8(x, (9, 0)), load8(x, (10, 0)), load8(x, (11, 0))
        for _ in range(_TURNS):
            x0, x1, x2, x3 = fma(x0, a, b), fma(x1, a, b), fma(x2, a, b), fma(x3, a, b)
            x4, x5, x6, x7 = fma(x4, a, b), fma(x5, a, b), fma(x6, a, b), fma(x7, a, b)
            x8, x9, y0, y1 = fma(x8, a, b), fma(x9, a, b), fma(y0, a, b), fma(y1, a, b)
        for i, end in enumerate((x0, x1, x2, x3, x4, x5, x6, x7, x8, x9, y0, y1)):
            store8(x, (i, 0), end)


@kernel
def _triad(_thread, next_task, a, b, c):
    """A ← b + 0.5 c."""
    start = take(next_task) * _PIECE
    while start < len(a):
        for i in range(start, start + _PIECE, LANES):
            store8(a, i, fma(load8(c, i), splat8(0.5), load8(b, i)))
        start = take(next_task) * _PIECE
