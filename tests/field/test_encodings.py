"""The encodings without a table of their own conventions, against formulas and values by hand."""

from __future__ import annotations

import numpy as np
import pytest

from irradia.core.errors import InputError
from irradia.core.rng import Seed
from irradia.core.sh import fibonacci_sphere, sh_basis
from irradia.field.encodings import (
    Composite,
    Frequency,
    HashGrid,
    Identity,
    OneBlob,
    SphericalHarmonics,
    TriPlane,
)
from irradia.field.init import new_parameters
from irradia.field.network import encode
from irradia.field.spec import FieldSpec

NONE = np.zeros(0)


def test_features_have_the_promised_shape_and_the_precision_of_parameters(small_encoding, rng):
    x = rng.random((5, 3), np.float32)
    for kind in (np.float32, np.float64):
        features = small_encoding.forward(x, rng.normal(size=small_encoding.n_parameters).astype(kind))
        assert features.shape == (5, small_encoding.n_outputs)
        assert features.dtype == kind


def test_tensors_cover_the_parameters(small_encoding, rng):
    start = small_encoding.init(rng)
    assert start.shape == (sum(slot.size for slot in small_encoding.tensors()),)
    assert start.dtype == np.float32
    names = [slot.name for slot in small_encoding.tensors()]
    assert len(set(names)) == len(names)


def test_encodings_of_nothing_are_empty(small_encoding, rng):
    x = np.zeros((0, 3), np.float32)
    start = small_encoding.init(rng)
    assert small_encoding.forward(x, start).shape == (0, small_encoding.n_outputs)
    assert not small_encoding.backward(x, start, np.zeros((0, small_encoding.n_outputs), np.float32)).any()


# Tri-planes


def image(plane: TriPlane) -> np.ndarray:
    """Parameters as (plane, row, column, feature)."""
    return np.zeros(plane.tensors()[0].shape, np.float32)


@pytest.mark.parametrize(("index", "row", "column"), [(0, 2, 1), (1, 3, 1), (2, 3, 2)])
def test_planes_are_xy_xz_yz_with_the_first_axis_along_columns(index, row, column):
    plane = TriPlane(4, 2)
    texels = image(plane)
    texels[index, row, column, 1] = 1.0
    centre = np.array([[1.5, 2.5, 3.5]], np.float32) / 4  # of texel (1, 2, 3)
    expected = np.zeros(6)
    expected[2 * index + 1] = 1.0
    np.testing.assert_array_equal(plane.forward(centre, texels.ravel())[0], expected)


def test_planes_are_filtered_bilinearly():
    plane = TriPlane(4, 1)
    texels = image(plane)
    texels[0, 1, 2, 0] = 1.0
    x = np.array([[2.25 / 4, 2.25 / 4, 0.5]], np.float32)  # texel coordinates (1.75, 1.75)
    assert plane.forward(x, texels.ravel())[0, 0] == pytest.approx(0.75 * 0.25)


@pytest.mark.parametrize("align_corners", [False, True])
def test_planes_are_clamped_at_their_edges(align_corners, rng):
    plane = TriPlane(4, 1, align_corners)
    texels = rng.random(image(plane).shape)
    x = np.array([[0.0, 0.0, 0.0], [1.0, 1.0, 1.0], [-3.0, -3.0, -3.0], [4.0, 4.0, 4.0]], np.float32)
    first, last = texels[:, 0, 0, 0], texels[:, -1, -1, 0]
    np.testing.assert_array_equal(plane.forward(x, texels.ravel()), [first, last, first, last])


def test_aligned_corners_put_texels_on_the_faces():
    plane = TriPlane(5, 1, align_corners=True)
    texels = image(plane)
    texels[0, 2, 1, 0] = 1.0
    assert plane.forward(np.array([[0.25, 0.5, 0.0]], np.float32), texels.ravel())[0, 0] == 1.0


# Frequencies


def test_frequencies_go_by_coordinate_then_octave_then_sine_and_cosine():
    x = np.array([[0.1, 0.2, 0.3]], np.float32)
    features = Frequency(2).forward(x, NONE)[0]
    t = np.pi * x[0].astype(float)
    expected = [f(scale * angle) for angle in t for scale in (1, 2) for f in (np.sin, np.cos)]
    np.testing.assert_allclose(features, expected, atol=1e-15)


def test_frequencies_may_begin_with_the_coordinates():
    x = np.array([[0.1, 0.2, 0.3]], np.float32)
    features = Frequency(2, include_identity=True).forward(x, NONE)
    np.testing.assert_array_equal(features[:, :3], x)
    np.testing.assert_array_equal(features[:, 3:], Frequency(2).forward(x, NONE))


def test_high_octaves_of_float_positions_are_exact(rng):
    x = rng.random((200, 3), np.float32)
    features = Frequency(20).forward(x, np.zeros(0, np.float32)).reshape(200, 3, 20, 2)
    turns = x.astype(np.longdouble) * 2**19 % 2
    np.testing.assert_allclose(features[:, :, 19, 0], np.sin(np.pi * turns.astype(float)), atol=1e-7)


# One-blob


def test_a_blob_in_the_middle_of_a_bin_spreads_evenly():
    features = OneBlob(4).forward(np.array([[0.375, 0.375, 0.375]]), NONE).reshape(3, 4)
    # ∫ 15/16 (1 − u²)² from −½ to ½ is 203/256; the rest is shared by the neighbours.
    side = (1 - 203 / 256) / 2
    np.testing.assert_allclose(features, [[side, 203 / 256, side, 0.0]] * 3, atol=1e-15)


def test_blobs_inside_the_box_are_whole_and_at_its_faces_half():
    x = np.array([[0.25, 0.5, 0.61], [0.0, 1.0, 0.0]])
    sums = OneBlob(8).forward(x, NONE).reshape(2, 3, 8).sum(axis=2)
    np.testing.assert_allclose(sums, [[1.0] * 3, [0.5] * 3], atol=1e-14)


# Spherical harmonics


def test_harmonics_are_those_of_the_conventions():
    directions = fibonacci_sphere(64)
    features = SphericalHarmonics(3).forward((directions + 1) / 2, NONE)
    np.testing.assert_allclose(features, sh_basis(directions), atol=1e-14)


def test_harmonics_are_orthonormal():
    directions = fibonacci_sphere(20_000)
    features = SphericalHarmonics(5).forward((directions + 1) / 2, NONE)
    product = features.T @ features * (4 * np.pi / len(directions))
    np.testing.assert_allclose(product, np.eye(25), atol=1e-4)


def test_higher_harmonics_have_positive_constants():
    x, y, z = 0.48, 0.6, 0.64
    features = SphericalHarmonics(4).forward((np.array([[x, y, z]]) + 1) / 2, NONE)[0]
    assert features[9] == pytest.approx(0.590044 * y * (3 * x * x - y * y), rel=1e-5)
    assert features[10] == pytest.approx(2.890611 * x * y * z, rel=1e-5)
    assert features[12] == pytest.approx(0.373176 * z * (5 * z * z - 3), rel=1e-5)
    assert features[15] == pytest.approx(0.590044 * x * (x * x - 3 * y * y), rel=1e-5)


# Identity and composition


def test_parts_stand_side_by_side(small_encodings, rng):
    composite = small_encodings["composite"]
    assert isinstance(composite, Composite)
    x = rng.random((4, 3), np.float32)
    start = composite.init(rng)
    features = composite.forward(x, start)
    for part, own, columns in composite.slices():
        np.testing.assert_array_equal(features[:, columns], part.forward(x, start[own]))
    assert [slot.name for slot in composite.tensors()] == ["0.planes", "2.level.0", "2.level.1"]


def test_normals_come_as_the_encoding_wants_them(rng):
    normal = fibonacci_sphere(6).astype(np.float32)
    x = rng.random((6, 3), np.float32)
    for direction, seen in ((Identity(), normal), (Composite((Identity(),)), normal / 2 + 0.5)):
        spec = FieldSpec(Identity(), direction, 4, 1)
        parameters = {name: np.zeros(shape, np.float32) for name, shape in spec.parameter_shapes().items()}
        features = encode(spec, parameters, x, normal)
        np.testing.assert_allclose(features, np.concatenate([x, seen], axis=1), atol=1e-7)


@pytest.mark.parametrize(
    ("encoding", "wrong"),
    [(TriPlane, 1), (Frequency, 0), (Frequency, 40), (OneBlob, 0), (SphericalHarmonics, 6), (Composite, ())],
)
def test_encodings_that_cannot_be_are_refused(encoding, wrong):
    with pytest.raises(InputError, match="expected"):
        encoding(wrong)


def test_an_encoding_that_learns_must_say_how_it_starts():
    class Forgetful(HashGrid):
        init = Identity.init

    with pytest.raises(NotImplementedError, match="how they start"):
        new_parameters(FieldSpec(Forgetful(2, 4), Identity()), Seed(1))
