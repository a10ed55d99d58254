"""Texels that reach into solids look at the room instead, and at one side of a wall only."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from irradia.bake.regions import NOWHERE, find_regions
from irradia.bake.setup import cover
from irradia.bake.texels import TexelSet
from irradia.core import silent_progress
from irradia.scene.builtin.builder import SceneBuilder
from irradia.scene.builtin.matte import matte
from irradia.scene.builtin.mesh import Mesh
from irradia.scene.builtin.shapes import box, floor
from irradia.scene.gltf.to_scene import document_to_scene
from irradia.scene.lightmap_uv import LayoutOptions, layout_lightmap
from irradia.scene.load import load_scene
from irradia.scene.types import Scene

pytestmark = pytest.mark.usefixtures("cpu_device")

FLOOR_M = 4.0
NEAR_M = 2e-4  # rays start a little above surfaces


@dataclass
class Stage:
    """Texels of a scene on the device."""

    texels: TexelSet
    instance: NDArray[np.uint32]
    world: Any
    subsamples: Any
    grid: Any

    def places(self) -> NDArray[np.float64]:
        """(N, S, 3) world positions of the sub-samples as they are now."""
        from irradia.transport.backend import dr, mi

        every = dr.arange(mi.UInt32, self.subsamples.n_texels)
        columns = [
            np.array(self.subsamples.point(self.world, every, dr.opaque(mi.UInt32, k)).position).T
            for k in range(self.subsamples.count)
        ]
        return np.stack(columns, axis=1).astype(np.float64)

    def clear(self) -> Any:
        from irradia.transport.footprints import clear_footprints

        return clear_footprints(self.world, self.subsamples, self.grid)


def stage(scene: Scene, resolution: int) -> Stage:
    from irradia.transport.subsamples import Subsamples
    from irradia.transport.texel_grid import TexelGrid
    from irradia.transport.world import World

    layout = layout_lightmap(scene, LayoutOptions(resolution=resolution), silent_progress())
    mesh, texels = cover(scene, layout)
    world = World(scene, mesh, (layout.width_px, layout.height_px))
    return Stage(
        texels,
        mesh.instance[texels.triangle],
        world,
        Subsamples(world, texels.pixel, texels.samples),
        TexelGrid(texels.pixel, texels.chart, layout.width_px, layout.height_px),
    )


def floor_with(*meshes: Mesh) -> Scene:
    """A floor of FLOOR_M with things on it."""
    scene = SceneBuilder("floor")
    grey = scene.material(matte("grey", (0.5, 0.5, 0.5)))
    scene.object("floor", (floor(FLOOR_M, FLOOR_M), grey))
    for number, mesh in enumerate(meshes):
        scene.object(f"thing {number}", (mesh, grey))
    return document_to_scene(scene.build())


CRATE = box((-1.03, -0.5, -0.97), (0.98, 1.5, 1.04))
WALL = box((-0.51, -0.5, -3.0), (-0.47, 1.5, 3.0))  # thinner than a texel, and longer than the floor


def within(points: NDArray[np.float64], low, high, margin: float = 0.0) -> NDArray[np.bool_]:
    """Whether points lie in a box made larger by a margin."""
    return ((points > np.asarray(low) - margin) & (points < np.asarray(high) + margin)).all(axis=-1)


def under_crate(places: NDArray[np.float64], margin: float) -> NDArray[np.bool_]:
    return within(places, (-1.03, -0.5, -0.97), (0.98, 1.5, 1.04), margin)


def test_hidden_share_is_the_part_that_lies_inside():
    on_stage = stage(floor_with(CRATE), 96)
    places = on_stage.places()
    found = on_stage.clear().hidden_share
    floor_texels = on_stage.instance == 0
    expected = under_crate(places, 0.0).mean(axis=1)
    assert found[floor_texels] == pytest.approx(expected[floor_texels], abs=1e-6)
    assert 0.0 < expected[floor_texels].mean() < 1.0
    assert ((expected > 0) & (expected < 1)).any()


def test_no_visible_texel_keeps_a_place_inside():
    on_stage = stage(floor_with(CRATE), 96)
    valid = on_stage.clear().valid & (on_stage.instance == 0)
    assert not under_crate(on_stage.places()[valid], -NEAR_M).any()


def test_texels_beside_visible_ones_are_moved_out_and_deeper_ones_are_not():
    on_stage = stage(floor_with(CRATE), 96)
    before = on_stage.places().mean(axis=1)
    footprints = on_stage.clear()
    moved = footprints.moved[on_stage.instance[footprints.moved[:, 0]] == 0]
    after = on_stage.places()[moved[:, 0]]
    texel_m = np.sqrt(FLOOR_M**2 / (on_stage.instance == 0).sum())
    depth = np.abs(before[moved[:, 0]][:, [0, 2]] - [-0.025, 0.035]).max(axis=1)
    assert len(moved) > 0
    assert (footprints.hidden_share[moved[:, 0]] == 1.0).all()
    assert depth.min() > 1.005 - 2.5 * texel_m
    assert np.linalg.norm(after - before[moved[:, 0], None], axis=-1).max() < 2.5 * texel_m
    unmoved = (on_stage.instance == 0) & ~footprints.valid
    assert unmoved.any()


def test_a_few_probes_find_what_a_look_from_everywhere_finds(monkeypatch):
    scene = load_scene("builtin:blocks")
    everywhere = stage(scene, 128).clear().hidden_share
    monkeypatch.setattr("irradia.transport.hidden._FEW_TEXELS", 0)
    assert np.array_equal(stage(scene, 128).clear().hidden_share, everywhere)
    assert 0.0 < everywhere.mean() < 1.0


@pytest.mark.parametrize("resolution", [96, 160, 288])
def test_nothing_inside_overlapping_solids_counts_as_visible(resolution):
    """Where three slabs overlap, creases see many fronts, although they lie inside."""
    scene = load_scene("builtin:leaks")
    number = next(i for i, instance in enumerate(scene.instances) if instance.name == "overlapping")
    on_stage = stage(scene, resolution)
    valid = on_stage.clear().valid & (on_stage.instance == number)
    places = on_stage.places()[valid] - scene.instances[number].world_from_object[:3, 3]
    corners = scene.primitives[scene.instances[number].primitive].positions.reshape(-1, 24, 3)
    assert len(corners) == 6
    for slab in corners.astype(np.float64):
        assert not within(places, slab.min(axis=0), slab.max(axis=0), -2 * NEAR_M).any()


def test_a_wall_thinner_than_a_texel_divides_the_floor():
    on_stage = stage(floor_with(WALL), 96)
    middle = on_stage.places().mean(axis=1)
    footprints = on_stage.clear()
    region = find_regions(
        on_stage.texels, footprints.hidden_share < 1.0, footprints.cut_off, footprints.moved
    )
    on_floor = (on_stage.instance == 0) & (region != NOWHERE)
    texel_m = np.sqrt(FLOOR_M**2 / (on_stage.instance == 0).sum())
    assert texel_m > 0.04
    left = on_floor & (middle[:, 0] < -0.49 - texel_m)
    right = on_floor & (middle[:, 0] > -0.49 + texel_m)
    assert left.any()
    assert right.any()
    assert not set(region[left]) & set(region[right])


def test_an_open_floor_stays_as_it_is():
    on_stage = stage(floor_with(), 64)
    before = on_stage.places()
    footprints = on_stage.clear()
    assert not footprints.hidden_share.any()
    assert len(footprints.moved) == 0
    assert np.array_equal(on_stage.places(), before)


def test_nested_shells_do_not_hide_what_sees_the_front_of_the_inner_one():
    """A room with fronts inward, in a house, on a stage: two solids lie round it, but it is a room."""
    room = box((-1.9, -0.9, -1.9), (1.9, 1.9, 1.9)).inside_out()
    scene = floor_with(CRATE, room, box((-3, -3, -3), (3, 3, 3)), box((-5, -5, -5), (5, 5, 5)))
    on_stage = stage(scene, 192)
    middle = on_stage.places().mean(axis=1)
    share = on_stage.clear().hidden_share
    free = (on_stage.instance == 0) & ~under_crate(middle, 0.2) & within(middle, (-1.7,) * 3, (1.7,) * 3)
    assert free.any()
    assert not share[free].any()
