"""Two sides and debug views in the viewer."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from numpy.typing import NDArray

from irradia.core.colour import linear_from_srgb
from irradia.scene.load import load_scene

from .made_light import bounds, made_grid
from .viewer_files import SCENE
from .viewer_tours import Found, pixels, steps_apart

MAGENTA = (255.0, 0.0, 255.0)  # of a view that a source lacks
OF_SURFACES = {"light", "irradiance", "albedo", "normal", "depth", "uv"}
OF_FIELDS = {"raw", "hidden", "unclamped", "position"}
EXACT = 1.5  # in 255ths
STATES = np.array([(0.18, 0.62, 0.3), (0.85, 0.5, 0.08), (0.7, 0.08, 0.06)])  # valid, filled, empty
PROBES = ("off", "irradiance", "direction", "dc", "validity")


@pytest.fixture(scope="module")
def sides(tour) -> Found:
    return tour("sides")


@pytest.fixture(scope="module")
def views(tour) -> Found:
    return tour("views")


def test_a_split_shows_one_source_on_each_side(sides):
    left, right, split = (pixels(sides["pictures"][name]) for name in ("lightmap", "field", "split"))
    at = split.shape[1] // 4
    assert steps_apart(left, right) > 20
    assert steps_apart(split[:, : at - 1], left[:, : at - 1]) <= EXACT
    assert steps_apart(split[:, at + 1 :], right[:, at + 1 :]) <= EXACT


def test_the_split_follows_the_pointer(sides):
    assert sides["split"] == pytest.approx(0.75, abs=0.01)


def test_a_difference_is_multiplied_by_its_gain(sides):
    left, right, found = (pixels(sides["pictures"][name]) for name in ("lightmap", "field", "difference"))
    expected = np.clip(4 * np.abs(left - right), 0, 255)
    assert steps_apart(found, expected) <= 4 * 2  # each side is rounded before ours is


def test_psnr_is_that_of_the_pictures(sides):
    left, right = (pixels(sides["pictures"][name]) / 255 for name in ("lightmap", "field"))
    inside = (left != left[0, 0]).any(axis=2) | (right != right[0, 0]).any(axis=2)
    expected = -10 * np.log10(np.square(left - right)[inside].mean())
    assert sides["numbers"]["psnrDb"] == pytest.approx(expected, abs=0.1)


def test_flip_is_that_of_its_authors(sides):
    from flip_evaluator import evaluate

    left, right = (pixels(sides["pictures"][name]).astype(np.float32) / 255 for name in ("lightmap", "field"))
    backdrop = left[0, 0]
    inside = (left != backdrop).any(axis=2) | (right != backdrop).any(axis=2)
    black = [np.where(inside[..., None], side, 0.0).astype(np.float32) for side in (left, right)]
    error, _, _ = evaluate(black[1], black[0], "LDR", applyMagma=False, parameters={"ppd": 67.0})
    expected = error.squeeze()[inside].mean()
    assert sides["numbers"]["flip"] == pytest.approx(expected, abs=0.005)


def test_numbers_of_both_are_shown(sides):
    assert len(sides["shown"]) == 1
    assert f"PSNR {sides['numbers']['psnrDb']:.1f} dB" in sides["shown"][0]
    assert f"FLIP {sides['numbers']['flip']:.4f}" in sides["shown"][0]


def test_what_is_only_put_into_a_scene_counts_for_nothing(sides):
    plain, guests = (pixels(sides["pictures"][name]) for name in ("difference", "guests"))
    assert (np.abs(plain - guests).max(axis=2) > 8).mean() > 0.005, "they are in the picture"
    assert sides["withGuests"] == pytest.approx(sides["numbers"])


def test_a_source_does_not_differ_from_itself(sides):
    assert sides["same"]["flip"] < 1e-6
    assert sides["same"]["psnrDb"] is None  # infinity in JSON
    assert pixels(sides["pictures"]["noError"])[70, 128].max() <= 12
    assert pixels(sides["pictures"]["error"])[70, 128].max() > 30


def test_the_grid_of_three_js_lights_the_scene(sides):
    inside = pixels(sides["pictures"]["three-probes"])[50:90, 108:148]
    assert inside.mean() > 20


def test_comparing_is_no_reason_to_complain(sides):
    assert sides["complaints"] == []


def test_a_field_has_all_views_but_validity(views):
    assert set(views["possible"]["field"]) == OF_SURFACES | OF_FIELDS
    assert "validity" in views["possible"]["probes"]


def test_a_field_within_its_limits_is_the_same_without_them(views):
    one, other = (pixels(views["pictures"][name]) for name in ("irradiance", "unclamped"))
    assert steps_apart(one, other) <= EXACT


def test_no_two_other_views_are_alike(views):
    pictures = {name: pixels(picture) for name, picture in views["pictures"].items() if "pass" not in name}
    del pictures["unclamped"]
    for one, other in itertools.combinations(pictures, 2):
        assert np.abs(pictures[one] - pictures[other]).max() > 20, f"{one} is {other}"


def test_no_view_is_missing(views):
    for name, picture in views["pictures"].items():
        is_magenta = (pixels(picture) == MAGENTA).all(axis=2)
        assert is_magenta.mean() < 0.05, name


def test_probes_stand_in_the_picture(views):
    without = pixels(views["pictures"]["probes off"])
    for mode in PROBES[1:]:
        changed = np.abs(pixels(views["pictures"][f"probes {mode}"]) - without).max(axis=2) > 8
        assert 0.002 < changed.mean() < 0.6, mode


def test_spheres_have_the_colours_of_their_states(views):
    shown = of_spheres(views, "validity")
    hues = shown / shown.max(axis=1, keepdims=True)
    apart = np.abs(hues[:, None] - STATES / STATES.max(axis=1, keepdims=True)).max(axis=2)
    assert np.percentile(apart.min(axis=1), 90) < 0.05
    assert len(set(apart.argmin(axis=1))) == len(STATES), "some of each"


def test_spheres_have_the_mean_light_of_their_probes(views):
    shown = of_spheres(views, "dc")
    means = made_grid(*bounds(load_scene(f"builtin:{SCENE}"))).coefficients[:, 0] * 0.282095
    expected = np.clip(means * 2 ** views["ev"], 0, 1)
    apart = np.abs(shown[:, None] - expected).max(axis=2).min(axis=1)
    assert np.percentile(apart, 85) < 0.02, "but at edges, where two meet"


def test_spheres_are_lit_as_a_surface_there_would_be(views):
    mean, irradiance = (of_spheres(views, mode) for mode in ("dc", "irradiance"))
    assert np.abs(irradiance - mean).mean() > 0.05 * mean.mean()
    assert np.median(irradiance / np.maximum(mean, 1e-3)) == pytest.approx(1, abs=0.15)


def test_spheres_have_a_spot_where_most_light_comes_from(views):
    mean, spots = (of_spheres(views, mode) for mode in ("dc", "direction"))
    share = (spots / np.maximum(mean, 1e-3))[mean.max(axis=1) < 0.95]
    assert np.median(share) == pytest.approx(0.25, abs=0.03)
    assert (share > 1.2).any()


def of_spheres(views: Found, mode: str) -> NDArray:
    """(n, 3) linear values of the pixels that a sphere covers, but for those at its edge."""
    off, states = (pixels(views["pictures"][f"probes {name}"]) for name in ("off", "validity"))
    covered = np.abs(states - off).max(axis=2) > 20
    inner = covered.copy()
    for axis, step in itertools.product((0, 1), (-1, 1)):
        inner &= np.roll(covered, step, axis)
    assert inner.sum() > 20
    return linear_from_srgb(pixels(views["pictures"][f"probes {mode}"])[inner] / 255)


def test_a_pass_over_the_screen_shows_what_materials_show(views):
    inline = pixels(views["pictures"]["light"])
    assert steps_apart(pixels(views["pictures"]["pass full"]), inline) <= 3
    assert np.abs(pixels(views["pictures"]["pass half"]) - inline).mean() < 0.3


def test_surfaces_as_baked_scatter_what_three_js_own_mirror(views):
    baked, materials, again = (pixels(views["surfaces"][name]) for name in ("baked", "materials", "again"))
    assert steps_apart(again, baked) <= EXACT
    changed = np.abs(baked - materials).max(axis=2) > 0.5
    assert 0.003 < changed.mean() < 0.02, "the sphere: walls have no specular part"
    assert 0.7 < (baked - materials)[changed].mean() < 10


def test_views_are_no_reason_to_complain(views):
    assert views["complaints"] == []
