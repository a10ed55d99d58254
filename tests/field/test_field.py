"""What a field gives to those who ask it for light."""

from __future__ import annotations

import numpy as np
import pytest

from irradia.core.errors import InputError
from irradia.core.rng import Seed
from irradia.core.sh import fibonacci_sphere, irradiance
from irradia.field.encodings import Identity
from irradia.field.field import Field
from irradia.field.init import new_parameters
from irradia.field.network import evaluate
from irradia.field.spec import FieldFrame, FieldSpec, Mode

FRAME = FieldFrame(np.array([[-2.0, 0.0, 1.0], [2.0, 1.0, 3.0]], np.float32), scale=8.0)
NORMALS = fibonacci_sphere(20).astype(np.float32)


def field(mode: Mode = "irradiance", head="exp") -> Field:
    spec = FieldSpec(Identity(), Identity() if mode == "irradiance" else None, 8, 1, head=head, mode=mode)
    return Field(spec, FRAME, new_parameters(spec, Seed(5)), "numpy")


@pytest.fixture
def positions(rng) -> np.ndarray:
    return rng.uniform(*FRAME.aabb, (20, 3)).astype(np.float32)


def test_irradiance_is_the_network_at_the_place_in_the_box_times_the_scale(positions):
    known = field()
    x = (positions - FRAME.aabb[0]) / np.float32([4.0, 1.0, 2.0])
    expected = 8.0 * evaluate(known.spec, known.parameters, x, NORMALS)
    np.testing.assert_allclose(known.irradiance(positions, NORMALS), expected, rtol=1e-6)


def test_places_outside_the_box_are_lit_as_its_faces():
    known = field()
    outside, face = np.float32([[-9.0, 0.5, 2.0]]), np.float32([[-2.0, 0.5, 2.0]])
    np.testing.assert_array_equal(known.irradiance(outside, NORMALS[:1]), known.irradiance(face, NORMALS[:1]))


@pytest.mark.parametrize(("mode", "n"), [("sh1", 4), ("sh2", 9)])
def test_irradiance_of_coefficients_is_that_of_the_conventions(mode, n, positions):
    known = field(mode, "linear")
    coefficients = known.coefficients(positions)
    assert coefficients.shape == (20, n, 3)
    padded = np.zeros((20, 9, 3))
    padded[:, :n] = coefficients
    expected = np.maximum(irradiance(padded, NORMALS), 0.0)
    found = known.irradiance(positions, NORMALS)
    np.testing.assert_allclose(found, expected, rtol=1e-5, atol=1e-5)
    assert 0.0 < (expected > 0.0).mean() < 1.0  # so the clamp was met, and not everywhere


def test_no_place_has_negative_light(positions):
    known = field(head="linear")
    assert evaluate(known.spec, known.parameters, FRAME.to_unit(positions), NORMALS).min() < 0.0
    assert known.irradiance(positions, NORMALS).min() == 0.0


def test_a_field_of_irradiance_has_no_coefficients(positions):
    with pytest.raises(InputError, match="not SH coefficients"):
        field().coefficients(positions)


def test_a_field_needs_all_of_its_parameters():
    known = field()
    with pytest.raises(InputError, match=r"mlp\.0\.bias"):
        Field(known.spec, FRAME, {k: v for k, v in known.parameters.items() if k != "mlp.0.bias"})
