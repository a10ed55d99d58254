"""Two sides and debug views in the viewer."""

from __future__ import annotations

import itertools

import numpy as np
import pytest

from .viewer_tours import Found, pixels, steps_apart

MAGENTA = (255.0, 0.0, 255.0)  # of a view that a source lacks
OF_SURFACES = {"light", "irradiance", "albedo", "normal", "depth", "uv"}
OF_FIELDS = {"raw", "hidden", "unclamped", "position"}
EXACT = 1.5  # in 255ths
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


def test_a_pass_over_the_screen_shows_what_materials_show(views):
    inline = pixels(views["pictures"]["light"])
    assert steps_apart(pixels(views["pictures"]["pass full"]), inline) <= 3
    assert np.abs(pixels(views["pictures"]["pass half"]) - inline).mean() < 8


def test_views_are_no_reason_to_complain(views):
    assert views["complaints"] == []
