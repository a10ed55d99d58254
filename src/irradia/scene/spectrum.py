"""From spectra to colour: the sun's spectrum, and linear Rec.709 in photometric units.

Colour matching functions: *Simple Analytic Approximations to the CIE XYZ Color Matching
Functions* (Wyman et al. 2013, eq. 4).
"""

from __future__ import annotations

import numpy as np

from irradia.scene.types import F64

WAVELENGTH_NM = np.arange(390.0, 711.0, 20.0)  # written λ in shapes
SUN_ILLUMINANCE_OUTSIDE_LX = 1.333e5  # the solar illuminance constant
SUN_TEMPERATURE_K = 5778.0
_PLANCK_SECOND_CONSTANT_M_K = 1.438777e-2

_RGB_FROM_XYZ = np.array(
    [
        [3.2404542, -1.5371385, -0.4985314],
        [-0.9692660, 1.8760108, 0.0415560],
        [0.0556434, -0.2040259, 1.0572252],
    ]
)


def linear_rgb_from_sunlight_share(share: F64) -> F64:
    """(…, 3) linear Rec.709 of (…, λ) spectra given relative to sunlight outside the atmosphere.

    The luminance of the result is photometric: all ones give ``SUN_ILLUMINANCE_OUTSIDE_LX``.
    Colours outside Rec.709 have negative parts.
    """
    sun, matching = _sun_spectrum(), _colour_matching()
    xyz = (share * sun) @ matching * (SUN_ILLUMINANCE_OUTSIDE_LX / (sun @ matching[:, 1]))
    return xyz @ _RGB_FROM_XYZ.T


def _sun_spectrum() -> F64:
    """(λ,) Planck's law at the sun's temperature, relative."""
    wavelength_m = WAVELENGTH_NM * 1e-9
    exponent = _PLANCK_SECOND_CONSTANT_M_K / (wavelength_m * SUN_TEMPERATURE_K)
    return (1e-6 / wavelength_m) ** 5 / np.expm1(exponent)


def _colour_matching() -> F64:
    """(λ, 3) CIE 1931 x̄, ȳ, z̄."""
    x = _lobe(442.0, 0.0624, 0.0374) * 0.362 + _lobe(599.8, 0.0264, 0.0323) * 1.056
    x -= _lobe(501.1, 0.0490, 0.0382) * 0.065
    y = _lobe(568.8, 0.0213, 0.0247) * 0.821 + _lobe(530.9, 0.0613, 0.0322) * 0.286
    z = _lobe(437.0, 0.0845, 0.0278) * 1.217 + _lobe(459.0, 0.0385, 0.0725) * 0.681
    return np.stack([x, y, z], axis=-1)


def _lobe(centre_nm: float, left_per_nm: float, right_per_nm: float) -> F64:
    """A Gaussian with a width of its own on each side."""
    offset = WAVELENGTH_NM - centre_nm
    return np.exp(-0.5 * (offset * np.where(offset < 0.0, left_per_nm, right_per_nm)) ** 2)
