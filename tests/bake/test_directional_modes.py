"""What directional maps say of the light that they were made from."""

from __future__ import annotations

import numpy as np
import pytest

from irradia.bake.directional_modes import MODES, SurfaceFrame, sh_linear
from irradia.core.errors import InternalError

from .light_fields import AXES, BITANGENT, NORMAL, TANGENT, both, lamp, sky, some_fields

SURFACE = SurfaceFrame(NORMAL, TANGENT, BITANGENT)


def encoded(mode, field):
    """Its maps, and the plain map's value, for one texel."""
    plain = field.over_pi(NORMAL)[None]
    return MODES[mode].encode(plain, field.moments(MODES[mode].moments)[None], NORMAL[None]), plain


def decoded(mode, field, normal):
    maps, plain = encoded(mode, field)
    return MODES[mode].irradiance_over_pi(plain, maps, normal, SURFACE)[0]


def tilted(degrees, azimuth=0.7):
    angle = np.radians(degrees)
    local = np.array([np.sin(angle) * np.cos(azimuth), np.sin(angle) * np.sin(azimuth), np.cos(angle)])
    return local @ AXES


def all_directions(n=1000):
    z = 1.0 - (np.arange(n) + 0.5) * 2.0 / n
    phi = np.arange(n) * np.pi * (3.0 - np.sqrt(5.0))
    s = np.sqrt(1.0 - z * z)
    return np.stack([s * np.cos(phi), s * np.sin(phi), z], axis=1)


@pytest.mark.parametrize("mode", MODES)
def test_the_surfaces_own_normal_gets_the_plain_map(mode):
    for field in some_fields():
        np.testing.assert_allclose(decoded(mode, field, NORMAL), field.over_pi(NORMAL), rtol=1e-5)


@pytest.mark.parametrize("mode", MODES)
def test_no_normal_gets_negative_light(mode):
    for field in [*some_fields(), lamp((1.0, 0.0, 0.02)), sky()]:
        maps, plain = encoded(mode, field)
        for normal in all_directions():
            assert (MODES[mode].irradiance_over_pi(plain, maps, normal, SURFACE) >= 0.0).all()


@pytest.mark.parametrize("mode", MODES)
def test_no_noise_makes_light_negative_infinite_or_unlike_the_plain_map(mode):
    rng = np.random.default_rng(2)
    how = MODES[mode]
    k = {"sh": 4, "mono": 2, "rnm": 3}[how.moments]
    moments = rng.normal(size=(2000, k, 3)) * rng.exponential(size=(2000, 1, 1)) ** 4
    plain = rng.exponential(size=(2000, 3)) ** 4 * (rng.random((2000, 3)) > 0.2)
    moments[:200], plain[:100] = 0.0, 0.0
    normals = np.broadcast_to(NORMAL, (2000, 3))
    maps = how.encode(plain, moments, normals)
    for name in how.maps:
        assert maps[name].dtype == np.float32
        assert maps[name].min() >= 0.0
        assert np.isfinite(maps[name]).all()
        if name not in how.light_maps:
            assert maps[name].max() <= 1.0
    own = how.irradiance_over_pi(plain, maps, normals, SURFACE)
    # The last bit of 1/2 + r/2 counts against all light around.
    assert (np.abs(own - plain) <= 1e-4 * plain + 1e-6 * maps.get("sh_l0", 0.0)).all()
    for normal in all_directions(50):
        value = how.irradiance_over_pi(plain, maps, normal, SURFACE)
        assert np.isfinite(value).all()
        assert (value >= 0.0).all()


@pytest.mark.parametrize("mode", MODES)
def test_black_stays_black(mode):
    how = MODES[mode]
    k = {"sh": 4, "mono": 2, "rnm": 3}[how.moments]
    maps = how.encode(np.zeros((1, 3)), np.zeros((1, k, 3)), NORMAL[None])
    assert not how.irradiance_over_pi(np.zeros((1, 3)), maps, tilted(40), SURFACE).any()


@pytest.mark.parametrize("mode", MODES)
def test_light_is_linear_in_its_strength(mode):
    field = both(lamp((0.5, 0.2, 0.6)), sky())
    stronger = type(field)(field.directions, 8.0 * field.light)
    np.testing.assert_allclose(
        decoded(mode, stronger, tilted(30)), 8.0 * decoded(mode, field, tilted(30)), rtol=1e-5
    )


@pytest.mark.parametrize("mode", ["sh", "mono-sh"])
def test_spherical_harmonics_decode_a_lamp_exactly(mode):
    field = lamp((0.4, -0.3, 0.7))
    for normal in all_directions(200):
        if normal @ NORMAL > 0.2:
            np.testing.assert_allclose(decoded(mode, field, normal), field.over_pi(normal), atol=2e-3)


@pytest.mark.parametrize("mode", ["sh", "mono-sh", "dominant"])
def test_an_even_sky_is_decoded_exactly(mode):
    for degrees in (0, 20, 50, 90):
        normal = tilted(degrees)
        truth = sky().over_pi(NORMAL) * 0.5 * (1.0 + np.cos(np.radians(degrees)))
        np.testing.assert_allclose(decoded(mode, sky(), normal), truth, rtol=1e-3)


def test_radiosity_normal_mapping_is_exact_for_a_lamp_above_its_horizons():
    field = lamp((0.1, -0.05, 1.0))
    for degrees in (0, 15, 30):
        np.testing.assert_allclose(
            decoded("rnm", field, tilted(degrees)), field.over_pi(tilted(degrees)), rtol=1e-5
        )


def mean_square_error(decode, degrees):
    """Relative to the plain map, over fields and azimuths."""
    errors = []
    for field in some_fields():
        for azimuth in np.arange(8) * np.pi / 4:
            normal = tilted(degrees, azimuth)
            scale = field.over_pi(NORMAL).mean()
            errors.append(((decode(field, normal) - field.over_pi(normal)) / scale) ** 2)
    return np.mean(errors)


@pytest.mark.parametrize("degrees", [15, 30, 45])
def test_each_mode_is_nearer_to_the_truth_than_the_plain_map(degrees):
    plain = mean_square_error(lambda field, _: field.over_pi(NORMAL), degrees)
    error = {
        mode: mean_square_error(lambda field, n, mode=mode: decoded(mode, field, n), degrees)
        for mode in MODES
    }
    assert error["dominant"] < 0.8 * plain
    assert error["rnm"] < 0.8 * plain
    assert error["mono-sh"] < 0.2 * plain
    assert error["sh"] < 0.05 * plain


@pytest.mark.parametrize("degrees", [15, 30, 45])
def test_our_decoder_is_far_nearer_than_linear_spherical_harmonics(degrees):
    ours = mean_square_error(lambda field, n: decoded("sh", field, n), degrees)
    linear = mean_square_error(lambda field, n: sh_linear(encoded("sh", field)[0], n)[0], degrees)
    assert ours < linear / 4.0


def test_spherical_harmonics_hold_the_coefficients_that_they_claim():
    field = both(lamp((0.3, 0.2, 0.9)), sky())
    maps, _ = encoded("sh", field)
    x = field.directions[:, 0]
    l00 = 0.282095 * field.light.sum(axis=0)
    l11 = 0.488603 * (x @ field.light)
    np.testing.assert_allclose(maps["sh_l0"][0] / 0.282095, l00, rtol=1e-5)
    np.testing.assert_allclose(maps["sh_l0"][0] * (2 * maps["sh_x"][0] - 1) * 3 / 0.488603, l11, rtol=1e-4)


def test_tangent_space_asks_for_tangents():
    maps, plain = encoded("rnm", sky())
    with pytest.raises(InternalError, match="tangents"):
        MODES["rnm"].irradiance_over_pi(plain, maps, NORMAL, SurfaceFrame(NORMAL))


def test_encoding_keeps_the_mean_light():
    field = both(lamp((0.3, 0.2, 0.9)), sky())
    np.testing.assert_allclose(encoded("sh", field)[0]["sh_l0"][0], field.moments("sh")[0], rtol=1e-6)
