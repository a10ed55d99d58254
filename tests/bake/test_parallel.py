"""Threads of Numba's parallel loops."""

from __future__ import annotations

import subprocess
import sys

AT_ONCE = """
from concurrent.futures import ThreadPoolExecutor
import numba, numpy as np
from irradia import transport
from irradia.bake.datasets.nearest import NearestSurface
from irradia.bake.parallel import kernel_threads
from irradia.scene.load import load_scene
from irradia.scene.merge import merge

surfaces = NearestSurface(merge(load_scene("builtin:furnace")))
points = np.random.default_rng(2).uniform(-1.0, 1.0, (4000, 3))
with ThreadPoolExecutor(4) as pool:
    found = list(pool.map(surfaces.distance_m, [points] * 8))
assert all(np.array_equal(each, found[0]) for each in found)
print(numba.threading_layer())
outside = numba.get_num_threads()
transport.use_device("cpu", 1)
with kernel_threads():
    print(numba.get_num_threads())
assert numba.get_num_threads() == outside
"""


def test_kernels_take_the_threads_asked_for_by_a_layer_that_is_pinned_and_guarded():
    """In a process of its own: the layer is chosen once, by whoever launches first."""
    done = subprocess.run([sys.executable, "-c", AT_ONCE], capture_output=True, text=True, check=True)
    assert done.stdout.split() == ["workqueue", "1"]
