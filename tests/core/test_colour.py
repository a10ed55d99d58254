"""Colour: the sRGB curve, exposure, and pictures for people."""

from __future__ import annotations

import numpy as np
import pytest

from irradia.core.colour import (
    automatic_exposure_ev,
    linear_from_srgb,
    picture_srgb8,
    preview_srgb8,
    srgb_from_linear,
)


def test_srgb_curve_inverts():
    values = np.linspace(0, 1, 1001, dtype=np.float32)
    np.testing.assert_allclose(linear_from_srgb(srgb_from_linear(values)), values, atol=1e-6)


def test_exposure_brings_the_geometric_mean_to_middle_grey():
    image = np.full((4, 4, 3), 7.0)
    assert 7.0 * 2.0 ** automatic_exposure_ev(image) == pytest.approx(0.18, rel=1e-3)


def test_pictures_differ_from_previews_in_highlights_alone():
    grey = np.repeat(np.linspace(0, 4, 401)[:, None], 3, axis=1)
    picture, preview = picture_srgb8(grey, 0.0), preview_srgb8(grey, 0.0)
    dark = grey[:, 0] <= 0.5
    assert (picture[dark] == preview[dark]).all()
    assert (np.diff(picture[:, 0].astype(int)) >= 0).all()
    assert picture[np.isclose(grey[:, 0], 1.0)].max() < 255
    assert picture[-1].min() >= 254


def test_negative_light_shows_black():
    assert not picture_srgb8(np.full((1, 1, 3), -2.0), 3.0).any()
