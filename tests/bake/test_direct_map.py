"""The direct map is what indirect light leaves out of a lightmap: no more and no less."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from irradia.scene.types import Light, Material

from .lit_scenes import bake, lit
from .quads import quad, quad_scene

pytestmark = pytest.mark.usefixtures("cpu_device")

_FLOOR = quad((-5, 0, -5), (0, 0, 10), (10, 0, 0))
_LID = quad((0, 1, -20), (20, 0, 0), (0, 0, 40))  # over the half x > 0, its front below
_DOWN = Light("directional", (2.0, 1.0, 0.5), direction=(0.0, -1.0, 0.0))
_SUN = Light("directional", (3.0, 2.0, 1.0), direction=(0.36, -0.48, 0.8))
_LAMP = Light("point", (0.3, 0.2, 0.1), position=(0.27, 0.4, 0.2))
_RING = tuple(
    replace(_LAMP, position=(0.1 * k - 0.5, 0.4, 0.1), intensity=(0.03 * (k + 1), 0.05, 0.02))
    for k in range(11)
)


def _cornell(*lights: Light):
    """The box with its own lamp, an emissive surface, and lights that are not."""
    return replace(lit("cornell"), lights=lights)


def _covered(result):
    return result.coverage > 0.0


@pytest.mark.parametrize(
    "lights",
    [(_SUN,), (replace(_SUN, angle_deg=8.0), _LAMP), (replace(_LAMP, radius_m=0.05),), _RING],
    ids=["sharp sun", "soft sun and lamp", "sphere", "eleven lamps"],
)
def test_direct_map_and_indirect_light_are_all_light(lights):
    scene = _cornell(*lights)
    full = bake(scene, 48, 256, direct_map=True)
    indirect = bake(scene, 48, 256, mode="indirect")
    there = _covered(full)
    assert full.direct is not None
    together, all_light = full.direct[there] + indirect.pages[there], full.pages[there]
    assert full.direct[there].mean() > 0.05 * all_light.mean()
    np.testing.assert_allclose(together.mean(axis=0), all_light.mean(axis=0), rtol=0.01)
    assert np.abs(together - all_light).mean() < 0.05 * all_light.mean()


def test_of_sharp_lights_it_has_no_noise():
    scene = _cornell(_SUN, _LAMP)
    first, second = (bake(scene, 32, 8, direct_map=True, seed=seed, seams=False) for seed in (1, 2))
    assert first.direct is not None
    np.testing.assert_array_equal(first.direct, second.direct)


def test_shadows_are_in_it():
    result = bake(quad_scene(_FLOOR, _LID, lights=(_DOWN,), mapped=1), 64, 8, direct_map=True)
    assert result.direct is not None
    values = result.direct[_covered(result)]
    lit_texels = np.isclose(values, np.array(_DOWN.intensity) / np.pi, rtol=1e-5).all(axis=1)
    dark = (values == 0.0).all(axis=1)
    assert 0.45 < lit_texels.mean() < 0.51
    assert 0.45 < dark.mean() < 0.51
    assert (lit_texels | dark).mean() > 0.97


def test_light_that_comes_through_a_leaf_is_in_it():
    leaf = Material(base_color=(0.5, 0.5, 0.5, 1.0), metallic=0.0, specular=0.0, diffuse_transmission=0.5)
    below = replace(_DOWN, direction=(0.0, 1.0, 0.0))
    result = bake(quad_scene(_FLOOR, materials=(leaf,), lights=(below,)), 32, 64, direct_map=True)
    assert result.direct is not None
    there = _covered(result)
    assert result.direct[there].mean() > 0.1
    np.testing.assert_allclose(result.direct[there].mean(), result.pages[there].mean(), rtol=0.02)


@pytest.mark.parametrize("mode", ["mixed", "realtime", "off"])
def test_lights_that_are_not_baked_have_no_part(mode):
    live = replace(_LAMP, mode=mode)
    with_both = bake(_cornell(_SUN, live), 32, 8, direct_map=True)
    alone = bake(_cornell(_SUN), 32, 8, direct_map=True)
    assert with_both.direct is not None
    assert alone.direct is not None
    there = _covered(alone)
    np.testing.assert_array_equal(with_both.direct[there], alone.direct[there])
    assert bake(_cornell(live), 32, 8, direct_map=True).direct is None


def test_without_punctual_lights_there_is_none():
    assert bake(_cornell(), 32, 8, direct_map=True).direct is None
