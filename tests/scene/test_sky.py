"""The sky: photometric magnitudes of a clear day, and laws that any sky keeps."""

from functools import cache
from itertools import pairwise

import numpy as np
import pytest

from irradia.core.colour import LUMINANCE_WEIGHTS
from irradia.core.errors import InputError
from irradia.scene.environment import texel_directions, texel_solid_angles
from irradia.scene.sky import sky
from irradia.scene.types import Environment, Light

LUMINANCE = np.array(LUMINANCE_WEIGHTS)


@cache
def _sky(
    elevation_deg: float, azimuth_deg: float = 215.0, turbidity: float = 2.5
) -> tuple[Environment, Light]:
    return sky(elevation_deg, azimuth_deg, turbidity)


def _horizontal_illuminance(environment: Environment) -> np.ndarray:
    height, width, _ = environment.radiance.shape
    cosine = np.maximum(texel_directions(height, width)[..., 1], 0.0)
    return np.einsum("hw,hwc->c", cosine * texel_solid_angles(height, width), environment.radiance)


@pytest.mark.parametrize("turbidity", [2.0, 2.5, 3.0])
def test_clear_day_has_the_illuminance_of_one(turbidity: float) -> None:
    environment, sun = _sky(42.0, turbidity=turbidity)
    assert 8e4 < np.dot(sun.intensity, LUMINANCE) < 1.05e5
    assert 1e4 < _horizontal_illuminance(environment) @ LUMINANCE < 2.5e4


@pytest.mark.parametrize("elevation_deg", [0.0, 10.0, 90.0])
@pytest.mark.parametrize("turbidity", [1.0, 10.0])
def test_sky_is_finite_and_nowhere_black(elevation_deg: float, turbidity: float) -> None:
    environment, sun = _sky(elevation_deg, turbidity=turbidity)
    assert np.all(np.isfinite(environment.radiance))
    assert environment.radiance.min() > 0.0
    assert min(sun.intensity) >= 0.0


def test_air_takes_from_the_sun_what_it_scatters() -> None:
    """Sun and sky together stay below what arrives from outside, and lose less than 15 % of it."""
    environment, sun = _sky(60.0, turbidity=2.0)
    sine = np.sin(np.radians(60.0))
    down = np.dot(sun.intensity, LUMINANCE) * sine + _horizontal_illuminance(environment) @ LUMINANCE
    assert 0.85 * 1.333e5 * sine < down < 1.333e5 * sine


def test_sun_reddens_and_dims_toward_the_horizon() -> None:
    suns = [np.array(_sky(elevation)[1].intensity) for elevation in (60.0, 42.0, 20.0, 10.0, 5.0)]
    assert all(np.all(low < high) for high, low in pairwise(suns))
    blueness = [sun[2] / sun[0] for sun in suns]
    assert blueness == sorted(blueness, reverse=True)


def test_haze_moves_light_from_sun_to_sky() -> None:
    clear, hazy = _sky(42.0, turbidity=2.0), _sky(42.0, turbidity=6.0)
    assert np.dot(hazy[1].intensity, LUMINANCE) < np.dot(clear[1].intensity, LUMINANCE)
    assert _horizontal_illuminance(hazy[0]) @ LUMINANCE > _horizontal_illuminance(clear[0]) @ LUMINANCE


def test_zenith_is_blue_and_horizon_paler() -> None:
    radiance = _sky(42.0)[0].radiance
    zenith, horizon = radiance[0].mean(axis=0), radiance[radiance.shape[0] // 2 - 1].mean(axis=0)
    assert zenith[2] > 1.2 * zenith[1] > 1.2 * zenith[0]
    assert horizon[2] / horizon[0] < 0.7 * zenith[2] / zenith[0]
    assert horizon @ LUMINANCE > zenith @ LUMINANCE


def test_sky_is_brightest_around_the_sun() -> None:
    environment, sun = _sky(42.0)
    height, width, _ = environment.radiance.shape
    brightest = np.argmax(environment.radiance @ LUMINANCE)
    direction = texel_directions(height, width).reshape(-1, 3)[brightest]
    assert direction @ -np.array(sun.direction) > np.cos(np.radians(3.0))


def test_map_holds_no_disc() -> None:
    """Neighbouring texels differ by the haze's forward peak at most."""
    above = _sky(42.0)[0].radiance[:63] @ LUMINANCE
    for axis in (0, 1):
        ratio = np.roll(above, 1, axis)[1:] / above[1:]
        assert 0.7 < ratio.min() < ratio.max() < 1.4


def test_azimuth_turns_sky_and_sun_together() -> None:
    (west, sun_west), (east, sun_east) = _sky(30.0, -90.0), _sky(30.0, 90.0)
    np.testing.assert_allclose(
        east.radiance, np.roll(west.radiance, west.radiance.shape[1] // 2, 1), rtol=1e-5
    )
    np.testing.assert_allclose(sun_east.direction, np.array(sun_west.direction) * [-1, 1, -1], atol=1e-9)
    assert sun_east.direction[0] < 0.0  # a sun at +X sends light toward −X


def test_ground_is_grey_and_lit_by_sun_and_sky() -> None:
    environment, sun = _sky(42.0)
    arriving = _horizontal_illuminance(environment) + np.array(sun.intensity) * np.sin(np.radians(42.0))
    reflectance = environment.radiance[-1, 0] * np.pi / arriving
    np.testing.assert_allclose(reflectance, [0.3] * 3, rtol=1e-3)


def test_sun_has_its_angular_size() -> None:
    assert _sky(42.0)[1].angle_deg == pytest.approx(0.53)


@pytest.mark.parametrize(
    "options", [{"sun_elevation_deg": -5.0}, {"turbidity": 0.5}, {"sun_azimuth_deg": float("nan")}]
)
def test_value_out_of_range_is_an_input_error(options: dict[str, float]) -> None:
    with pytest.raises(InputError, match="must lie between"):
        sky(**options)
