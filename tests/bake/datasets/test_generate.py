"""Datasets hold the light of the scene: by paper, by the bake, and the same whatever launches there are."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from irradia.bake.datasets import BakedPages, SampleOptions, sample_info, sample_rows, set_up
from irradia.bake.datasets.nearest import NearestSurface
from irradia.bake.lightmap import LightmapResult
from irradia.core.sh import irradiance
from irradia.formats.sample_rows import check_rows
from irradia.scene.builtin.shapes import floor, quad
from irradia.scene.layout import LightmapLayout
from irradia.scene.merge import MergedMesh
from irradia.scene.types import Light, Scene

from ..lit_scenes import bake, laid_out, lit
from ..probes.places import scene_of

pytestmark = pytest.mark.usefixtures("cpu_device")

LAMP = Light("point", (8.0, 4.0, 2.0), position=(0.3, 1.0, -0.1))


def sampled(scene: Scene, lightmap: BakedPages | None = None, **choices: object) -> np.ndarray:
    """All rows of a dataset; they are what its file would take."""
    options = SampleOptions(**{"integrator": "cached" if lightmap else "path", **choices})  # type: ignore[arg-type]
    setting = set_up(scene, options, lightmap)
    rows = np.concatenate(list(sample_rows(setting, options)))
    check_rows(rows, sample_info(setting, options, {}), "test")
    return rows


def baked(scene: Scene, resolution: int, samples: int) -> tuple[LightmapResult, BakedPages]:
    result = bake(scene, resolution, samples)
    return result, BakedPages(laid_out(scene, resolution), result.pages)


def corner() -> Scene:
    """A floor, a wall and a lamp."""
    return scene_of(
        floor(4.0, 4.0), quad((-2.0, 0.0, -2.0), (4.0, 0.0, 0.0), (0.0, 3.0, 0.0)), lights=(LAMP,)
    )


def lightmap_at(
    mesh: MergedMesh, layout: LightmapLayout, pages: np.ndarray, places: np.ndarray
) -> np.ndarray:
    """(N, 3) E/π that a finished map shows at places (N, 3) on surfaces, filtered bilinearly."""
    triangle = NearestSurface(mesh).triangle(places)
    a, b, c = np.moveaxis(mesh.positions[mesh.indices[triangle]].astype(np.float64), 1, 0)
    edges = np.stack([b - a, c - a], axis=-1)
    weights = np.einsum("nij,nj->ni", np.linalg.pinv(edges), places - a)
    uv = mesh.lightmap_uv[mesh.indices[triangle]].astype(np.float64)
    uv = uv[:, 0] + np.einsum("ni,nik->nk", weights, uv[:, 1:] - uv[:, :1])
    x, y = (uv * (layout.width_px, layout.height_px) - 0.5).T
    x0, y0 = np.floor(x).astype(int), np.floor(y).astype(int)
    found = np.zeros((len(places), 3))
    for dx, dy in ((0, 0), (1, 0), (0, 1), (1, 1)):
        weight = np.abs(1 - dx - (x - x0)) * np.abs(1 - dy - (y - y0))
        found += weight[:, None] * pages[mesh.page[triangle], y0 + dy, x0 + dx]
    return found


@pytest.mark.parametrize("name", ["cornell", "rooms"])
def test_surface_samples_agree_with_the_lightmap_at_the_same_places(name):
    scene = lit(name)
    result, lightmap = baked(scene, 256, 64)
    setting = set_up(scene, SampleOptions(), lightmap)
    rows = sampled(scene, lightmap, count=8192, samples=64)
    expected = math.pi * lightmap_at(setting.mesh, lightmap.layout, result.pages, rows[:, :3])
    np.testing.assert_allclose(rows[:, 6:9].mean(axis=0), expected.mean(axis=0), rtol=0.01)
    assert np.corrcoef(rows[:, 7], expected[:, 1])[0, 1] > 0.99


@pytest.mark.parametrize("placement", ["surface", "volume"])
@pytest.mark.parametrize("cached", [False, True])
def test_furnace_holds_pi_over_one_minus_its_reflectance_everywhere(placement, cached):
    scene = lit("furnace")
    lightmap = baked(scene, 64, 128)[1] if cached else None
    rows = sampled(scene, lightmap, placement=placement, count=2000, samples=256)
    np.testing.assert_allclose(rows[:, 6:9].mean(axis=0), math.pi / 0.5, rtol=3e-3)


@pytest.mark.parametrize("placement", ["sh-random", "sh-grid"])
def test_furnace_holds_nothing_but_l0(placement):
    rows = sampled(lit("furnace"), placement=placement, count=500, samples=256, order=2)
    series = rows[:, 3:-1].reshape(-1, 9, 3).mean(axis=0)
    np.testing.assert_allclose(series[0], math.sqrt(4 * math.pi) / 0.5, rtol=5e-3)
    assert np.abs(series[1:]).max() < 0.05


def test_indirect_and_direct_light_make_up_the_full():
    """The same random numbers: each sample's direct light is that of the lamp over black surfaces."""
    options = {"count": 600, "samples": 32}
    full = sampled(corner(), quantity="full", **options)
    indirect = sampled(corner(), quantity="indirect", **options)
    black = tuple(replace(m, base_color=(0.0, 0.0, 0.0, 1.0)) for m in corner().materials)
    direct = sampled(replace(corner(), materials=black), **options)
    np.testing.assert_allclose(full[:, 6:9], indirect[:, 6:9] + direct[:, 6:9], rtol=1e-4, atol=1e-5)
    assert indirect[:, 6:9].mean() > 0.02 * direct[:, 6:9].mean() > 0.0


def test_full_light_has_also_the_direct_light_of_lamps_that_are_lit_live():
    live = replace(corner(), lights=(replace(LAMP, mode="realtime"),))
    options = {"count": 100, "samples": 16}
    np.testing.assert_array_equal(sampled(live, **options), sampled(corner(), **options))
    np.testing.assert_array_equal(
        sampled(live, quantity="indirect", **options), sampled(corner(), quantity="indirect", **options)
    )


def test_order_two_goes_on_where_order_one_ends_and_both_give_the_irradiance():
    first = sampled(corner(), placement="sh-random", count=50, samples=64)
    second = sampled(corner(), placement="sh-random", count=50, samples=64, order=2)
    np.testing.assert_array_equal(first[:, :15], second[:, :15])
    assert np.all(second[:, -1] >= first[:, -1])
    assert np.all(irradiance(second[:, 3:-1].reshape(-1, 9, 3), (0.0, 0.0, 1.0)).mean(axis=1) > -0.5)


def test_validation_is_another_and_better_dataset():
    options = SampleOptions("sh-grid", integrator="path", spacing_m=1.0, samples=4)
    for_validation = options.for_validation(300)
    assert (for_validation.placement, for_validation.samples) == ("sh-random", 64)
    options = SampleOptions(integrator="path", count=300, samples=4)
    setting = set_up(corner(), options, None)
    train, judge = (
        np.concatenate(list(sample_rows(setting, o, n)))
        for o, n in ((options, "train"), (options.for_validation(300), "validation"))
    )
    assert not np.isin(train[:, 0], judge[:, 0]).any()
    assert judge[:, -1].mean() < 0.2 * train[:, -1].mean()


def test_launches_are_of_one_size_and_the_kernels_few():
    """Millions of rays each, and nothing is compiled anew from the second on."""
    from irradia.transport.backend import dr

    options = SampleOptions(integrator="path", count=5 * (1 << 10), samples=1024)
    rows = sample_rows(set_up(corner(), options, None), options)
    next(rows), next(rows)
    with dr.scoped_set_flag(dr.JitFlag.KernelHistory, True):
        dr.kernel_history_clear()
        assert [len(block) for block in rows] == [1 << 10] * 3
        kernels = [entry for entry in dr.kernel_history() if entry["type"] == dr.KernelType.JIT]
    assert len(kernels) <= 3 * 6
    assert all(entry["cache_hit"] for entry in kernels)
