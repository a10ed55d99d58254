"""Whole bakes: placements, what they hold, and the same bytes on any number of threads."""

from __future__ import annotations

import os
import subprocess
import sys
from dataclasses import replace

import numpy as np
import pytest

from irradia.bake.probes.gather import bake_probes
from irradia.bake.probes.options import ProbeOptions
from irradia.core import InputError, silent_progress
from irradia.core.sh import fibonacci_sphere, irradiance
from irradia.formats.probes import EMPTY, FILLED, NO_PROBE, VALID, ProbeGrid, ProbeOctree
from irradia.scene.builtin.shapes import box, centred_box, floor
from irradia.scene.layout import LightmapLayout, Unwrap
from irradia.scene.types import Light

from .places import scene_of, thick_block

pytestmark = pytest.mark.usefixtures("cpu_device")

ROOM = centred_box((4, 3, 5)).inside_out()
LAMP = Light("point", (10.0, 8.0, 6.0), position=(0.5, 1.0, 0.3))


def test_grid_stands_half_a_spacing_inside_and_in_order():
    probes = bake_probes(scene_of(ROOM, lights=(LAMP,)), None, None, ProbeOptions.parse("grid:1", samples=16))
    assert isinstance(probes.structure, ProbeGrid)
    assert probes.structure.shape == (4, 3, 5)
    np.testing.assert_allclose(probes.positions[0], (-1.5, -1.0, -2.0), atol=1e-6)
    np.testing.assert_allclose(probes.positions[1] - probes.positions[0], (1, 0, 0), atol=1e-6)
    np.testing.assert_allclose(probes.positions[4] - probes.positions[0], (0, 1, 0), atol=1e-6)
    np.testing.assert_allclose(probes.positions[12] - probes.positions[0], (0, 0, 1), atol=1e-6)
    assert np.all(probes.state == VALID)
    assert probes.light == "full"


def test_no_probe_of_any_placement_has_negative_light():
    sun = Light("directional", (9.0, 9.0, 9.0), direction=(0.3, -0.9, 0.2))
    scene = scene_of(floor(6, 6), box((-1, 0, -1), (1, 1, 1)), lights=(sun, LAMP), sky=(0.1, 0.2, 0.3))
    for text in ("grid:0.8", "random:100", "auto"):
        options = replace(ProbeOptions.parse(text, samples=64), count=100)
        probes = bake_probes(scene, None, None, options)
        e = irradiance(probes.coefficients[:, None], fibonacci_sphere(1000))
        assert e.min() >= 0.0
        assert e.max() > 1.0


def test_grid_through_a_solid_is_filled_from_outside():
    options = ProbeOptions.parse("grid:0.25", samples=16)
    probes = bake_probes(thick_block(), None, None, options)
    inside = np.abs(probes.places).max(axis=1) < 1.0
    assert inside.any()
    assert np.all(probes.state[inside] != VALID)
    shallow = np.abs(probes.positions).max(axis=1) > 0.7
    assert np.all(probes.state[inside & shallow] == FILLED)
    lit = probes.state != EMPTY
    assert probes.coefficients[lit, 0].min() > 0.0


@pytest.mark.parametrize("text", ["random:300", "auto"])
def test_loose_and_octree_probes_are_never_in_solids(text):
    scene = scene_of(floor(6, 6), box((-1, 0, -1), (1, 2, 1)), sky=(1.0, 1.0, 1.0))
    probes = bake_probes(scene, None, None, replace(ProbeOptions.parse(text, samples=16), count=300))
    assert 0 < len(probes) <= 300
    assert np.all(probes.state == VALID)
    places = probes.places
    buried = (np.abs(places[:, [0, 2]]).max(axis=1) < 0.99) & (places[:, 1] > 0.0) & (places[:, 1] < 1.99)
    assert not buried.any()


def test_random_probes_are_as_many_as_asked_for_and_spread_evenly():
    probes = bake_probes(
        scene_of(ROOM, lights=(LAMP,)), None, None, ProbeOptions.parse("random:512", samples=1)
    )
    assert len(probes) == 512
    assert probes.structure is None
    octant = (probes.positions > 0) @ (1, 2, 4)
    assert np.bincount(octant, minlength=8).min() > 48


def test_octree_is_finer_where_light_changes_and_has_whole_cells():
    """A lamp in one corner of an empty hall: cells are small around it, and share their corners."""
    lamp = Light("point", (3.0, 3.0, 3.0), position=(-3.0, 0.0, -3.0))
    scene = scene_of(centred_box((10, 6, 10)).inside_out(), lights=(lamp,))
    probes = bake_probes(scene, None, None, replace(ProbeOptions.parse("auto", samples=16), count=1000))
    tree = probes.structure
    assert isinstance(tree, ProbeOctree)
    size = tree.size_m * 0.5 ** tree.cells[:, 3]
    low = tree.origin + tree.cells[:, :3] * size[:, None]
    corner = np.array([(i & 1, i >> 1 & 1, i >> 2 & 1) for i in range(8)])
    for cell in range(0, len(size), 7):
        known = tree.corners[cell] != NO_PROBE
        expected = low[cell] + corner[known] * size[cell]
        np.testing.assert_allclose(probes.positions[tree.corners[cell][known]], expected, atol=1e-4)
    middle = low + 0.5 * size[:, None]
    free = np.all(np.abs(middle) < (4.0, 2.0, 4.0), axis=1)
    near = np.linalg.norm(middle - lamp.position, axis=1) < 1.5
    assert size[near].mean() < 0.7 * size[free & ~near].mean()
    points = np.random.default_rng(9).uniform((-4, -2, -4), (4, 2, 4), (500, 1, 3))
    holds = np.all((points >= low) & (points < low + size[:, None]), axis=2)
    np.testing.assert_array_equal(holds.sum(axis=1), 1)


def test_lightmap_stands_in_for_paths():
    """Walls whose map says 1/π · E = 2 and that reflect half shine with 1."""
    scene = scene_of(ROOM, reflectance=0.5)
    primitive = scene.primitives[0]
    n = len(primitive.positions)
    unwrap = Unwrap(
        np.arange(n, dtype=np.uint32),
        primitive.indices,
        np.full((n, 2), 0.5, np.float32),
        np.zeros(len(primitive.indices), np.uint32),
    )
    one, zero = np.ones((1, 2), np.float32), np.zeros((1, 2), np.float32)
    layout = LightmapLayout(1, 8, 8, (unwrap,), np.zeros(1, np.int32), one, zero, 1.0)
    pages = np.full((1, 8, 8, 3), 2.0, np.float32)
    probes = bake_probes(scene, layout, pages, ProbeOptions.parse("grid:1", samples=512))
    np.testing.assert_allclose(probes.coefficients[:, 0], np.sqrt(4 * np.pi), rtol=1e-3)


def test_live_lights_make_it_indirect_light():
    scene = scene_of(ROOM, lights=(replace(LAMP, mode="mixed"),))
    assert bake_probes(scene, None, None, ProbeOptions.parse("grid:2", samples=1)).light == "indirect"


def test_too_fine_a_grid_is_refused_with_a_spacing_that_would_do():
    with pytest.raises(InputError, match="at least") as caught:
        bake_probes(scene_of(ROOM), None, None, ProbeOptions.parse("grid:0.001"))
    assert caught.value.fix
    spacing = float(caught.value.fix.split()[-2])
    bake_probes(scene_of(ROOM), None, None, ProbeOptions.parse(f"grid:{10 * spacing}", samples=1))


def test_stages_are_shown():
    progress = silent_progress()
    bake_probes(scene_of(ROOM), None, None, ProbeOptions.parse("auto", samples=1), progress)
    assert {"probe places", "probe sight", "probe light"} <= set(progress.seconds)


_PROGRAM = """
import sys, hashlib
from irradia.transport import use_device
use_device("cpu", int(sys.argv[1]))
from irradia.bake.probes import ProbeOptions, bake_probes
from irradia.scene.load import load_scene
options = ProbeOptions("auto", count=60, samples=100, seed=int(sys.argv[2]))
probes = bake_probes(load_scene("builtin:cornell"), None, None, options)
print(hashlib.sha256(probes.coefficients.tobytes() + probes.distance.tobytes()).hexdigest())
"""


def _digest(threads: int, seed: int) -> str:
    command = [sys.executable, "-c", _PROGRAM, str(threads), str(seed)]
    run = subprocess.run(command, capture_output=True, text=True, env=os.environ.copy(), check=False)
    assert run.returncode == 0, run.stderr
    return run.stdout.strip()


def test_same_seed_same_bytes_on_one_and_two_threads():
    digests = {_digest(threads, 7) for threads in (1, 2, 2)}
    assert len(digests) == 1
    assert _digest(2, 8) not in digests


def test_scene_that_is_solid_all_over_is_refused():
    rock = scene_of(centred_box((40, 40, 40)), lights=(LAMP,))
    with pytest.raises(InputError, match="free space"):
        bake_probes(rock, None, None, ProbeOptions("grid", spacing_m=22.0, samples=1))
