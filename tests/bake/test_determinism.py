"""The same seed gives the same bytes, whatever the number of threads."""

from __future__ import annotations

import hashlib
import os
import subprocess
import sys

import pytest

_PROGRAM = """
import sys, hashlib
from irradia.transport import use_device
use_device("cpu", int(sys.argv[2]))
from irradia.bake.lightmap import BakeOptions, bake_lightmap
from irradia.cli.lighting import LightOptions, light_scene
from irradia.core import silent_progress
from irradia.scene.lightmap_uv import LayoutOptions, layout_lightmap
from irradia.scene.load import load_scene
scene = light_scene(load_scene("builtin:" + sys.argv[1]), LightOptions())
layout = layout_lightmap(scene, LayoutOptions(resolution=128, use_cache=False), silent_progress())
result = bake_lightmap(scene, layout, BakeOptions(samples=32, seed=int(sys.argv[3])))
print(hashlib.sha256(result.irradiance_over_pi.tobytes() + result.pages.tobytes()).hexdigest())
"""


def _digest(scene: str, threads: int, seed: int = 7) -> str:
    run = subprocess.run(
        [sys.executable, "-c", _PROGRAM, scene, str(threads), str(seed)],
        capture_output=True,
        text=True,
        env=os.environ.copy(),
        check=False,
    )
    assert run.returncode == 0, run.stderr
    return run.stdout.strip()


@pytest.mark.parametrize("scene", ["cornell", "blocks"])
def test_five_runs_on_one_and_two_threads_give_the_same_bytes(scene):
    digests = {_digest(scene, threads) for threads in (1, 2, 1, 2, 2)}
    assert len(digests) == 1
    assert all(len(d) == hashlib.sha256().digest_size * 2 for d in digests)


def test_another_seed_gives_other_bytes():
    assert _digest("cornell", 2, seed=7) != _digest("cornell", 2, seed=8)
