"""Shadow masks: a live light times its mask is the baked light."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from irradia.bake.finish import Finisher, FinishOptions
from irradia.bake.shadow_mask import (
    ShadowMaskOptions,
    ShadowMaskPlan,
    bake_shadow_mask,
    finish_shadow_mask,
    plan_shadow_mask,
)
from irradia.core import silent_progress
from irradia.core.errors import InputError
from irradia.scene.types import Light, Material

from .lit_scenes import bake, lit
from .quads import Traced, quad, quad_scene

pytestmark = pytest.mark.usefixtures("cpu_device")

_FLOOR = quad((-5, 0, -5), (0, 0, 10), (10, 0, 0))
_LID = quad((0, 1, -20), (20, 0, 0), (0, 0, 40))  # over the half x > 0, its front below
_DOWN = Light("directional", (2.0, 1.0, 0.5), direction=(0.0, -1.0, 0.0), mode="mixed")


def _mask(scene, resolution=64, **options):
    traced = Traced(scene, resolution)
    plan = plan_shadow_mask(traced.mesh, scene.lights)
    chosen = ShadowMaskOptions(**options)
    mask = bake_shadow_mask(traced.world, traced.subsamples, traced.texels, scene.lights, plan, chosen)
    return traced, plan, mask


def _pages(mask, traced, valid):
    texels, options = traced.texels, FinishOptions(denoise=False, seams=False)
    finisher = Finisher(texels, valid, options, silent_progress())
    grey = np.ones((texels.n_pages, texels.height_px, texels.width_px, 3), np.float32)
    return finish_shadow_mask(mask, texels, valid, grey, finisher)


def test_a_sharp_shadow_is_black_inside_and_white_outside():
    traced, plan, mask = _mask(quad_scene(_FLOOR, _LID, lights=(_DOWN,), mapped=1))
    x = traced.places[..., 0]
    assert plan.channels == (0,)
    assert mask.lit[:, 0].all()
    assert (mask.visibility[x.max(axis=1) < -1e-3, 0] == 1.0).all()
    assert (mask.visibility[x.min(axis=1) > 1e-3, 0] == 0.0).all()
    edge = (x.min(axis=1) < -1e-3) & (x.max(axis=1) > 1e-3)
    np.testing.assert_allclose(mask.visibility[edge, 0], (x[edge] < 0).mean(axis=1), atol=1e-6)


def test_a_suns_penumbra_is_the_part_of_its_disc_beyond_the_edge():
    sun = replace(_DOWN, angle_deg=20.0)
    traced, _, mask = _mask(quad_scene(_FLOOR, _LID, lights=(sun,), mapped=1), samples=512)
    from_edge = traced.places[..., 0] / np.tan(np.radians(10.0))
    height = np.clip(from_edge, -1.0, 1.0)
    beyond = 1.0 - (np.arccos(height) - height * np.sqrt(1.0 - height**2)) / np.pi
    np.testing.assert_allclose(mask.visibility[:, 0], 1.0 - beyond.mean(axis=1), atol=0.03)
    assert np.abs(mask.visibility[:, 0] - (1.0 - beyond.mean(axis=1))).mean() < 2e-3


def test_tinted_glass_passes_the_luminance_of_what_it_passes():
    glass = Material(base_color=(0.2, 0.6, 0.9, 1.0), metallic=0.0, transmission=1.0, specular=0.0)
    pane = replace(_LID, material=1)
    scene = quad_scene(_FLOOR, pane, materials=(Material(), glass), lights=(_DOWN,), mapped=1)
    traced, _, mask = _mask(scene)
    weights = np.array([0.2126, 0.7152, 0.0722]) * _DOWN.intensity
    expected = weights @ np.array([0.2, 0.6, 0.9]) / weights.sum()
    under = traced.places[..., 0].min(axis=1) > 1e-3
    np.testing.assert_allclose(mask.visibility[under, 0], expected, rtol=1e-4)


@pytest.mark.parametrize(
    "light",
    [
        Light("point", (0.3, 0.2, 0.1), position=(0.27, 0.4, 0.2)),
        Light("spot", (0.3, 0.2, 0.1), position=(0.1, 0.5, 0.3), direction=(0.6, -0.8, 0.0)),
        Light("directional", (3.0, 2.0, 1.0), direction=(0.36, -0.48, 0.8), angle_deg=8.0),
        Light("point", (0.3, 0.2, 0.1), position=(0.27, 0.4, 0.2), range_m=0.45),
    ],
    ids=["point", "spot", "sun", "range"],
)
def test_a_live_light_times_its_mask_is_the_baked_light(light):
    from irradia.transport.light_visibility import LightVisibility
    from irradia.transport.punctual import PunctualLights

    light = replace(light, mode="mixed")
    scene = replace(lit("cornell"), lights=(light,))
    traced, _, mask = _mask(scene, samples=256)
    kernel = LightVisibility(
        traced.world, traced.subsamples, traced.texels.pixel, PunctualLights((light,)), seed=99
    )
    share = kernel.add(kernel.nothing(), 0, 256)
    live, baked = (np.array(v) / 256 for v in (share.offered, share.arrived))
    assert baked.max() > 0.0
    difference = np.abs(live * mask.visibility[:, 0] - baked)
    assert difference.max() < 0.1 * live.max()
    assert difference.mean() < 2e-3 * live.max()
    assert (live * mask.visibility[:, 0]).mean() == pytest.approx(baked.mean(), rel=5e-3)


def test_lights_of_one_channel_do_not_touch_each_other():
    left = Light("point", (1, 1, 1), position=(-3.0, 0.5, 0.0), range_m=1.5, mode="mixed")
    right = replace(left, position=(3.0, 0.5, 0.0), intensity=(50.0, 50.0, 50.0))
    lid = quad((2.5, 0.2, -1), (1, 0, 0), (0, 0, 2))
    both = quad_scene(_FLOOR, lid, lights=(left, right), mapped=1)
    traced, plan, mask = _mask(both)
    assert plan.channels == (0, 0)
    near_left = np.linalg.norm(traced.places - np.array(left.position), axis=2).max(axis=1) < 1.4
    assert (mask.visibility[near_left, 0] == 1.0).all()
    under = (np.abs(traced.places - (3.0, 0.0, 0.0)).max(axis=1) < (0.4, 1.0, 0.4)).all(axis=1)
    assert (mask.visibility[under, 0] == 0.0).all()
    far = np.linalg.norm(traced.places[:, 0] * (1, 0, 0), axis=1) < 1.0
    assert not mask.lit[far].any()


def test_overlapping_lights_keep_to_their_channels():
    slanted = replace(_DOWN, direction=(np.sqrt(0.5), -np.sqrt(0.5), 0.0))
    traced, plan, mask = _mask(quad_scene(_FLOOR, _LID, lights=(_DOWN, slanted), mapped=1))
    assert sorted(plan.channels) == [0, 1]
    x = traced.places[..., 0]
    for channel, edge in zip(plan.channels, (0.0, 1.0), strict=True):
        assert (mask.visibility[x.max(axis=1) < edge - 1e-3, channel] == 1.0).all()
        assert (mask.visibility[x.min(axis=1) > edge + 1e-3, channel] == 0.0).all()


def test_of_a_lamp_on_the_horizon_only_the_upper_half_counts():
    """A wall hides all of its right side: half of what the floor could get."""
    lamp = Light("point", (1, 1, 1), position=(0.0, 0.0, 3.0), radius_m=1.0, mode="mixed")
    wall = quad((0, 0, 0), (20, 0, 0), (0, 20, 0))
    traced, _, mask = _mask(quad_scene(_FLOOR, wall, lights=(lamp,), mapped=1), samples=256)
    middle = np.abs(traced.places - (0.0, 0.0, -3.0)).max(axis=(1, 2)) < 0.4
    assert mask.visibility[middle, 0].mean() == pytest.approx(0.5, abs=0.02)


def test_channels_without_a_light_are_white():
    traced, _, mask = _mask(quad_scene(_FLOOR, _LID, lights=(_DOWN,), mapped=1))
    valid = np.ones(len(mask.lit), bool)
    pages = _pages(mask, traced, valid)
    assert pages.shape == (1, 64, 64, 4)
    assert (pages[..., 1:] == 1.0).all()
    np.testing.assert_array_equal(pages.reshape(-1, 4)[traced.texels.pixel, 0], mask.visibility[:, 0])


def test_where_no_light_shines_the_shadow_beside_it_goes_on():
    """The spot lights a disc in the middle; the floor around it continues its light and shadow."""
    spot = Light(
        "spot", (1, 1, 1), position=(0, 3, 0), direction=(0, -1, 0), inner_cone_rad=0.5, outer_cone_rad=0.6
    )
    scene = quad_scene(_FLOOR, _LID, lights=(replace(spot, mode="mixed"),), mapped=1)
    traced, _, mask = _mask(scene)
    pages = _pages(mask, traced, np.ones(len(mask.lit), bool))
    filled = pages.reshape(-1, 4)[traced.texels.pixel, 0]
    x, z = traced.places[..., 0].mean(axis=1), traced.places[..., 2].mean(axis=1)
    beside = (np.hypot(x, z) > 2.5) & ~mask.lit[:, 0] & (np.abs(z) < 1.0)
    assert (filled[beside & (x < -2)] == 1.0).all()
    assert (filled[beside & (x > 2)] == 0.0).all()


def test_hidden_texels_take_their_charts_shadow():
    traced, _, mask = _mask(quad_scene(_FLOOR, _LID, lights=(_DOWN,), mapped=1))
    x = traced.places[..., 0].mean(axis=1)
    valid = np.abs(x + 3.0) > 0.4
    wrong = replace(mask, visibility=np.where(valid[:, None], mask.visibility, np.float32(0.0)))
    pages = _pages(wrong, traced, valid)
    assert (pages.reshape(-1, 4)[traced.texels.pixel[~valid], 0] == 1.0).all()


def test_only_mixed_lights_are_planned_and_those_too_many_are_named():
    scene = quad_scene(_FLOOR)
    mesh = Traced(scene, 64).mesh
    lamps = [
        Light("point", (k, k, k), position=(0.1 * k, 1.0, 0.0), mode="mixed", name=f"lamp {k}")
        for k in range(1, 7)
    ]
    modes = ("baked", "realtime", "off")
    lights = (*(replace(lamps[5], mode=m) for m in modes), *lamps)
    plan = plan_shadow_mask(mesh, lights)
    assert plan.channels[:3] == (None, None, None)
    assert plan.fallback == (3, 4)
    assert [light.mode for light in plan.lights(lights)[3:]] == ["baked"] * 2 + ["mixed"] * 4
    (note,) = plan.notes(lights)
    assert note.endswith("lamp 1, lamp 2")
    assert plan.needed
    told = plan.to_json(lights, ["shadow_mask.png"])
    assert told["files"] == ["shadow_mask.png"]
    assert told["baked_instead"] == [{"light": 3, "name": "lamp 1"}, {"light": 4, "name": "lamp 2"}]
    assert [entry["light"] for entry in told["lights"]] == [5, 6, 7, 8]
    assert sorted(entry["channel"] for entry in told["lights"]) == [0, 1, 2, 3]
    assert not plan_shadow_mask(mesh, lights[:3]).needed
    assert ShadowMaskPlan((None, None)).notes(lights) == ()


def test_the_same_seed_gives_the_same_bytes_and_another_other_ones():
    sun = replace(_DOWN, angle_deg=20.0)
    scene = quad_scene(_FLOOR, _LID, lights=(sun,), mapped=1)
    first, second, other = (_mask(scene, samples=32, seed=s)[2].visibility for s in (4, 4, 5))
    assert first.tobytes() == second.tobytes()
    assert first.tobytes() != other.tobytes()


def test_no_samples_are_bad_input():
    with pytest.raises(InputError, match="samples"):
        ShadowMaskOptions(samples=0)


def test_a_bake_of_a_mixed_light_holds_its_mask_and_not_its_direct_light():
    black = Material(base_color=(0.0, 0.0, 0.0, 1.0), metallic=0.0, specular=0.0)
    sun = replace(_DOWN, intensity=(np.pi, np.pi, np.pi), angle_deg=20.0)
    scene = quad_scene(_FLOOR, _LID, materials=(black,), lights=(sun,), mapped=1)
    mixed = bake(scene, 64, 64, seams=False)
    baked = bake(replace(scene, lights=(replace(sun, mode="baked"),)), 64, 1024, seams=False)
    assert mixed.shadow_channels == (0,)
    assert mixed.shadows is not None
    assert mixed.pages.max() == 0.0
    assert baked.shadows is None
    inside = baked.coverage > 0.0
    difference = mixed.shadows[inside, 0] - baked.pages[inside, 0]
    assert np.abs(difference).mean() < 5e-3
    assert difference.mean() == pytest.approx(0.0, abs=1e-3)
