"""How fast a field answers on this machine."""

from __future__ import annotations

import time

import numpy as np

from irradia.core.rng import Seed
from irradia.field.backend import Evaluator

N_QUERIES = 1 << 18
_REPEATS = 5


def queries_per_second(
    evaluator: Evaluator, *, directional: bool, n_queries: int = N_QUERIES, repeats: int = _REPEATS
) -> float:
    """Median over repeats, after one run that isn't timed.

    Args:
        evaluator: The field's network.
        directional: Whether it takes normals.
        n_queries: At random places, so that no cache helps more than in use.
        repeats: How often to take the time.
    """
    rng = Seed(0).child("speed").numpy()
    x = rng.random((n_queries, 3), np.float32)
    normal = rng.standard_normal((n_queries, 3), np.float32)
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    given = normal if directional else None
    evaluator(x, given)
    seconds = []
    for _ in range(repeats):
        start = time.perf_counter()
        evaluator(x, given)
        seconds.append(time.perf_counter() - start)
    return n_queries / float(np.median(seconds))
