"""Maps under each kind of light against what is known of it on paper."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from irradia.formats.ies import IesTable
from irradia.scene.light_profile import profile_from_ies
from irradia.scene.types import Light

from .lit_scenes import bake, laid_out, lit, places

pytestmark = pytest.mark.usefixtures("cpu_device")

_HEIGHT_M = 1.5
_VERTICAL = np.arange(0.0, 91.0, 10.0)
_CANDELA = 100.0 * np.cos(np.radians(_VERTICAL)) ** 3 * (1.0 + 0.5 * np.sin(np.radians(3 * _VERTICAL)))


def _measured() -> Light:
    table = IesTable("C", _VERTICAL, np.zeros(1), _CANDELA[None], 2002, {})
    return _lamp(intensity=(1.0, 0.5, 0.25), profile=profile_from_ies(table))


def _lamp(kind="point", intensity=(10.0, 6.0, 3.0), **fields) -> Light:
    pose = {"position": (0.1, _HEIGHT_M, -0.2), "direction": (0.0, -1.0, 0.0), "up": (1.0, 0.0, 0.0)}
    return Light(kind, intensity, **{**pose, **fields})


def _spot_ramp(cosine):
    inner, outer = math.cos(0.3), math.cos(0.9)
    return np.clip((cosine - outer) / (inner - outer), 0.0, 1.0) ** 2


@pytest.mark.parametrize(
    ("light", "shape"),
    [
        (_lamp(), lambda cosine: 1.0),
        (_lamp(radius_m=0.2), lambda cosine: 1.0),
        (_lamp("spot", inner_cone_rad=0.3, outer_cone_rad=0.9), _spot_ramp),
        (_measured(), lambda cosine: np.interp(np.degrees(np.arccos(cosine)), _VERTICAL, _CANDELA)),
    ],
    ids=["point", "sphere", "spot", "measured"],
)
def test_lamp_over_a_plane_sends_its_intensity_by_cosine_over_distance_squared(light, shape):
    """A table's values are met within what a cubic and straight lines between them may differ by."""
    scene = replace(lit("plane-point"), lights=(light,))
    _, _, positions = places(scene, laid_out(scene, 48))
    towards = np.array(light.position) - positions
    distance = np.linalg.norm(towards, axis=-1)
    cosine = towards[..., 1] / distance
    irradiance = (cosine / distance**2 * shape(cosine)).mean(axis=1)
    expected = irradiance[:, None] * np.array(light.intensity) / np.pi
    found = bake(scene, 48, 64).irradiance_over_pi
    np.testing.assert_allclose(found.mean(axis=0), expected.mean(axis=0), rtol=5e-3)
    np.testing.assert_allclose(found, expected, rtol=0.04, atol=0.02 * expected.max())


@pytest.mark.parametrize("angle_deg", [0.0, 0.53, 20.0])
def test_sun_of_any_size_lights_a_plane_by_its_cosine(angle_deg):
    tilt = math.radians(40.0)
    sun = Light(
        "directional",
        (3.0, 2.0, 1.0),
        direction=(math.sin(tilt), -math.cos(tilt), 0.0),
        angle_deg=angle_deg,
    )
    found = bake(replace(lit("plane-point"), lights=(sun,)), 32, 64).irradiance_over_pi
    expected = math.cos(tilt) * np.array(sun.intensity) / np.pi
    np.testing.assert_allclose(found.mean(axis=0), expected, rtol=2e-3)


def test_light_that_is_off_leaves_the_map_black():
    scene = replace(lit("plane-point"), lights=(_lamp(mode="off"),))
    assert not bake(scene, 32, 4).irradiance_over_pi.any()
