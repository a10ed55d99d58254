"""Sun and sky: the light of a scene that brings none, in photometric units (lux, cd/m²).

The sky is an environment map without the sun's disc, which would be a few texels of noise; the
sun is a directional light of its real size, sampled exactly.
"""

from __future__ import annotations

import math

import numpy as np

from irradia.core.errors import InputError
from irradia.scene.atmosphere import OBSERVER_HEIGHT_M, Atmosphere
from irradia.scene.environment import texel_directions, texel_solid_angles
from irradia.scene.spectrum import linear_rgb_from_sunlight_share
from irradia.scene.types import F32, F64, Environment, Light, Rgb

SUN_ANGLE_DEG = 0.53
SKY_WIDTH_PX = 256  # without a disc nothing in it is sharper than the haze around the sun
GROUND_ALBEDO = 0.3

# Mid-morning in clear air. glTF models face +Z: the sun stands at their front left, so that the
# 3/4 view from the front right sees both a lit and a shaded side.
DEFAULT_ELEVATION_DEG = 42.0
DEFAULT_AZIMUTH_DEG = 215.0
DEFAULT_TURBIDITY = 2.5


def sky(
    sun_elevation_deg: float = DEFAULT_ELEVATION_DEG,
    sun_azimuth_deg: float = DEFAULT_AZIMUTH_DEG,
    turbidity: float = DEFAULT_TURBIDITY,
) -> tuple[Environment, Light]:
    """A clear sky and its sun.

    Args:
        sun_elevation_deg: Height over the horizon, 0 to 90.
        sun_azimuth_deg: Where the sun stands: 0 is −Z, 90 is +X, 180 is +Z.
        turbidity: Haze, 1 to 10; see :mod:`irradia.scene.atmosphere`.

    Returns:
        Sky radiance in cd/m², the lower half a grey ground lit by both; and the sun in lux. As
        Rec.709 colours, their luminance is the photometric value.

    Raises:
        InputError: A value is outside its range.
    """
    _check("sun elevation", sun_elevation_deg, 0.0, 90.0)
    _check("sun azimuth", sun_azimuth_deg, -360.0, 360.0)
    _check("turbidity", turbidity, 1.0, 10.0)
    atmosphere = Atmosphere(turbidity, GROUND_ALBEDO)
    to_sun = _direction(sun_elevation_deg, sun_azimuth_deg)
    sun_lx = _in_gamut(
        linear_rgb_from_sunlight_share(
            atmosphere.transmittance(np.array([OBSERVER_HEIGHT_M]), to_sun[1:2])[0]
        )
    )
    name = f"sky, sun at {sun_elevation_deg:g}°"
    environment = Environment(_sky_map(atmosphere, to_sun, sun_lx), name)
    light = Light(
        kind="directional",
        intensity=_rgb(sun_lx),
        direction=_rgb(-to_sun),
        angle_deg=SUN_ANGLE_DEG,
        name="sun",
    )
    return environment, light


def _sky_map(atmosphere: Atmosphere, to_sun: F64, sun_lx: F64) -> F32:
    height, width = SKY_WIDTH_PX // 2, SKY_WIDTH_PX
    upward = texel_directions(height, width)[: height // 2]
    spectra = atmosphere.sky_radiance(upward.reshape(-1, 3), to_sun)
    above = _in_gamut(linear_rgb_from_sunlight_share(spectra)).reshape(upward.shape)
    weights = texel_solid_angles(height, width)[: height // 2] * upward[..., 1]
    sky_lx = np.einsum("hw,hwc->c", weights, above)
    ground = GROUND_ALBEDO / np.pi * (sky_lx + sun_lx * to_sun[1])
    below = np.broadcast_to(ground, above.shape)
    return np.concatenate([above, below]).astype(np.float32)


def _direction(elevation_deg: float, azimuth_deg: float) -> F64:
    elevation, azimuth = math.radians(elevation_deg), math.radians(azimuth_deg)
    horizontal = math.cos(elevation)
    return np.array([math.sin(azimuth) * horizontal, math.sin(elevation), -math.cos(azimuth) * horizontal])


def _in_gamut(rgb: F64) -> F64:
    """A spectral red sunset or blue zenith can lie outside Rec.709; its negative parts become 0."""
    return np.maximum(rgb, 0.0)


def _rgb(values: F64) -> Rgb:
    return (float(values[0]), float(values[1]), float(values[2]))


def _check(name: str, value: float, low: float, high: float) -> None:
    if not low <= value <= high:  # also false for NaN
        raise InputError(f"{name} must lie between {low:g} and {high:g}, found {value}", where="sky")
