"""Fields as the Unity project's ``.bin``: written by one choice, read by any, found out from samples."""

from __future__ import annotations

import itertools
import struct
from dataclasses import replace

import numpy as np
import pytest

from irradia.core.errors import InputError
from irradia.field.bin_conventions import PRESETS, BinConventions, conventions_from_options
from irradia.field.bin_reader import decode_bin
from irradia.field.bin_writer import encode_bin
from irradia.field.calibrate import calibrate
from irradia.field.encoding import Encoding
from irradia.field.encodings import Frequency, Identity, OneBlob, SphericalHarmonics, TriPlane
from irradia.field.field import Field
from irradia.formats.field_bin import BinHeader, encode_field_bin

from .foreign_bin import read_as
from .stored_fields import BOX, GRID, PLANES, WAVES, light, made, places

FULL_GRID = replace(GRID, full_levels=True)


def test_bytes_are_golden() -> None:
    """By hand: header, planes by row and column, matrices by rows of outputs, each with its bias after it."""
    field = made(TriPlane(2, 1), "irradiance", width=4, layers=1)
    first, second = field.parameters["mlp.0.weight"], field.parameters["mlp.1.weight"]
    expected = struct.pack("<4I2f2I6f", 1, 2, 0, 1, 0, 0, 4, 1, -1, 0, 0.5, 1, 2, 4.5)
    expected += struct.pack("<12e", *field.parameters["position"])
    for row in first:
        expected += struct.pack("<8e", *row, 0, 0)  # xy, xz, yz, then the normal, then two of padding
    expected += struct.pack("<4e", *field.parameters["mlp.0.bias"])
    for row in second:
        expected += struct.pack("<4e", *row)
    expected += struct.pack("<4e", 0, 0, 0, 0)
    expected += struct.pack("<4e", *field.parameters["mlp.1.bias"], 0)
    assert encode_bin(field) == expected


@pytest.mark.parametrize("encoding", [FULL_GRID, PLANES, WAVES, Frequency(2)])
@pytest.mark.parametrize("mode", ["irradiance", "sh1"])
def test_field_comes_back_bit_by_bit(encoding: Encoding, mode: str) -> None:
    field = made(encoding, mode)
    found = decode_bin(encode_bin(field), BinConventions(quantity="indirect"))
    assert found.spec == field.spec
    assert found.frame.quantity == "indirect"
    np.testing.assert_array_equal(found.frame.aabb, BOX)
    for name, values in field.parameters.items():
        np.testing.assert_array_equal(found.parameters[name], values)


@pytest.mark.parametrize("mode", ["irradiance", "sh1"])
def test_trimmed_levels_become_full_ones_that_mean_the_same(mode: str) -> None:
    field = made(GRID, mode)
    found = decode_bin(encode_bin(field))
    assert found.spec.position == FULL_GRID
    edge = np.array([BOX[1], (BOX[1] + BOX[0]) / 2, (1.0, 0.0, 4.5)], np.float32)  # corners beyond the last
    up = np.tile(np.float32([0, 1, 0]), (3, 1))
    ours, theirs = (
        Field(f.spec, f.frame, f.parameters, "numpy").irradiance(edge, up) for f in (field, found)
    )
    np.testing.assert_array_equal(ours, theirs)
    np.testing.assert_array_equal(light(found), light(field))


@pytest.mark.parametrize(("mode", "rtol"), [("irradiance", 2e-3), ("sh1", 1e-6)])
def test_scale_goes_into_the_last_layer(mode: str, rtol: float) -> None:
    field = made(PLANES, mode, scale=64.0)
    found = decode_bin(encode_bin(field))
    assert found.frame.scale == 1.0
    np.testing.assert_allclose(light(found), light(field), rtol=rtol)


def test_width_is_padded_with_units_that_do_nothing() -> None:
    field = made(PLANES, width=6)
    found = decode_bin(encode_bin(field))
    assert found.spec.width == 8
    np.testing.assert_allclose(light(found), light(field), rtol=1e-6)


def refused(field: Field) -> str:
    with pytest.raises(InputError) as caught:
        encode_bin(field)
    assert caught.value.fix
    return caught.value.message


def with_spec(**changes: object) -> Field:
    spec = replace(made().spec, **changes)  # type: ignore[arg-type]
    parameters = {name: np.zeros(shape, np.float32) for name, shape in spec.parameter_shapes().items()}
    return Field(spec, made().frame, parameters, "numpy")


@pytest.mark.parametrize(
    ("field", "complaint"),
    [
        (made(PLANES, "sh2"), "L2"),
        (with_spec(head="softplus"), "head softplus"),
        (with_spec(activation="sine"), "activation sine"),
        (with_spec(direction=SphericalHarmonics(3)), "sh encoding of normals"),
        (with_spec(position=OneBlob(4)), "encoding one_blob"),
        (with_spec(position=Identity()), "encoding identity"),
        (with_spec(position=replace(GRID, hash_all=True)), "rarer conventions"),
        (with_spec(position=replace(PLANES, align_corners=True)), "corners are aligned"),
    ],
)
def test_what_the_file_cannot_express_is_refused(field: Field, complaint: str) -> None:
    assert complaint in refused(field)


def test_too_bright_for_halves_is_refused() -> None:
    field = made(PLANES, "sh1", scale=2.0**20)
    assert "half float" in refused(field)


# ---- Foreign conventions: held to a reader that follows them step by step.


def numbered(encoding: Encoding, mode: str, seed: int = 1) -> bytes:
    """A file of random halves, which any convention makes some field of."""
    rng = np.random.default_rng(seed)
    data = encode_bin(made(encoding, mode, width=8))
    halves = (rng.integers(-64, 64, (len(data) - 56) // 2) / 128).astype("<f2")
    return data[:56] + halves.tobytes()


NETWORK_CHOICES = [
    {"matrix": matrix, "bias": bias}
    for matrix in ("out_in", "in_out")
    for bias in ("after", "before", "last")
]
LIT_CHOICES = [
    {"inputs": inputs, "normal": normal}
    for inputs in ("features_normal", "normal_features")
    for normal in ("signed", "unit")
]
WAVE_CHOICES = [
    {"waves": " ".join(order), "turns": turns, "identity_last": last}
    for order in itertools.permutations(("axis", "frequency", "wave"))
    for turns, last in (("pi", False), ("one", True), ("two_pi", False))
]
PLANE_CHOICES = [
    {"planes": planes, "texels": texels, "centres": centres}
    for planes in ("xy xz yz", "xy yz zx", "zy zx yx", "yz xy xz")
    for texels in ("row_column_feature", "feature_row_column")
    for centres in ("half", "corners")
]
GRID_CHOICES = [
    {"levels": levels, "hash_all": hash_all, "primes": primes, "table": table}
    for levels in ("tiny-cuda-nn", "floor")
    for hash_all in (False, True)
    for primes in ("xyz", "zyx")
    for table in ("entry_feature", "feature_entry")
]
SH_CHOICES = [
    {"coefficients": order, "sh_quantity": quantity}
    for order in ("channel_xyz", "yzx_channel")
    for quantity in ("radiance", "irradiance")
]
CASES = (
    [(WAVES, "irradiance", choice) for choice in NETWORK_CHOICES + LIT_CHOICES + WAVE_CHOICES]
    + [(PLANES, "irradiance", choice) for choice in PLANE_CHOICES]
    + [(FULL_GRID, "irradiance", {"inputs": "normal4_features", "normal": n}) for n in ("signed", "unit")]
    + [(FULL_GRID, "irradiance", choice) for choice in GRID_CHOICES]
    + [(PLANES, "sh1", choice) for choice in SH_CHOICES]
)


@pytest.mark.parametrize(("encoding", "mode", "choice"), CASES)
def test_foreign_convention_is_read_as_its_own_reader_would(
    encoding: Encoding, mode: str, choice: dict
) -> None:
    data = numbered(encoding, mode)
    conventions = BinConventions(**choice)
    expected = read_as(data, conventions, *places())
    np.testing.assert_allclose(light(decode_bin(data, conventions)), expected, rtol=2e-4, atol=2e-4)


@pytest.mark.parametrize(
    ("encoding", "mode", "choice"),
    [
        (WAVES, "irradiance", {"matrix": "in_out", "waves": "wave frequency axis", "turns": "two_pi"}),
        (WAVES, "irradiance", {"bias": "last", "identity_last": True, "turns": "one", "normal": "unit"}),
        (PLANES, "irradiance", {"planes": "zx yx zy", "texels": "feature_row_column", "bias": "before"}),
        (PLANES, "sh1", {"centres": "corners", "coefficients": "yzx_channel", "matrix": "in_out"}),
        (PLANES, "sh1", {"sh_quantity": "irradiance", "bias": "last"}),
        (FULL_GRID, "irradiance", {"levels": "floor", "hash_all": True, "inputs": "normal_features"}),
        (FULL_GRID, "irradiance", {"primes": "zyx", "table": "feature_entry", "matrix": "in_out"}),
        (FULL_GRID, "irradiance", {"inputs": "normal4_features", "normal": "unit"}),
    ],
)
def test_calibration_finds_conventions_that_explain_the_light(
    encoding: Encoding, mode: str, choice: dict
) -> None:
    data = numbered(encoding, mode)
    truth = read_as(data, BinConventions(**choice), *places(96))
    found = calibrate(data, *places(96), truth)
    assert found.best.error < 1e-4
    assert found.is_convincing
    np.testing.assert_allclose(
        replace(found.field, backend_name="numpy").irradiance(*places()),
        read_as(data, BinConventions(**choice), *places()),
        rtol=1e-3,
        atol=1e-3,
    )
    equal = [candidate for candidate in found.ranking if candidate.error < 1e-4]
    assert len(equal) < len(found.ranking) / 4  # the samples do tell


def test_calibration_admits_that_nothing_fits() -> None:
    positions, normals = places()
    noise = np.random.default_rng(5).uniform(0, 9, (len(positions), 3)).astype(np.float32)
    assert not calibrate(numbered(PLANES, "irradiance"), positions, normals, noise).is_convincing


def test_calibration_needs_light() -> None:
    positions, normals = places()
    with pytest.raises(InputError, match="lit"):
        calibrate(numbered(PLANES, "irradiance"), positions, normals, np.zeros_like(normals))


@pytest.mark.parametrize("n_outputs", [3, 12])
def test_files_without_padding_are_read_too(n_outputs: int) -> None:
    n_inputs = 6 + (3 if n_outputs == 3 else 0)
    header = BinHeader(1, 3, 0, 2, (0.0, 0.0), 8, 1, BOX)
    n = n_inputs * 8 + 8 + 8 * n_outputs + n_outputs
    halves = (np.random.default_rng(2).integers(-64, 64, n) / 128).astype(np.float16)
    data = encode_field_bin(header, np.linspace(0, 1, 54, dtype=np.float16), halves)
    found = decode_bin(data)
    assert found.spec.layer_shapes() == [(8, n_inputs), (n_outputs, 8)]
    np.testing.assert_allclose(light(found), read_as(data, BinConventions(), *places()), rtol=1e-4, atol=1e-4)


def test_a_normal_of_four_needs_a_fourth_input() -> None:
    header = BinHeader(1, 3, 0, 2, (0.0, 0.0), 8, 1, BOX)  # 6 features and 3 of a normal, not padded
    halves = (np.arange(9 * 8 + 8 + 8 * 3 + 3) % 7 / 8).astype(np.float16)
    data = encode_field_bin(header, np.linspace(0, 1, 54, dtype=np.float16), halves)
    with pytest.raises(InputError, match="normal4_features"):
        decode_bin(data, BinConventions(inputs="normal4_features"))
    found = calibrate(data, *places(), read_as(data, BinConventions(), *places()))
    assert found.best.error < 1e-4


@pytest.mark.parametrize("preset", PRESETS)
def test_presets_are_named_choices(preset: str) -> None:
    assert conventions_from_options(preset) == PRESETS[preset]
    assert conventions_from_options(preset, {"bias": "last"}).bias == "last"


@pytest.mark.parametrize(
    ("preset", "changes", "fix"),
    [("irradai", {}, "irradia"), ("pytorch", {"matrx": "in_out"}, "matrix")],
)
def test_unknown_names_are_refused_with_the_nearest(preset: str, changes: dict, fix: str) -> None:
    with pytest.raises(InputError) as caught:
        conventions_from_options(preset, changes)
    assert fix in str(caught.value.fix)


@pytest.mark.parametrize(
    ("name", "value"), [("matrix", "sideways"), ("planes", "xy xy xy"), ("hash_all", 2), ("head", "lamp")]
)
def test_unknown_choices_are_refused_with_those_there_are(name: str, value: object) -> None:
    with pytest.raises(InputError, match=f"{name} to be one of"):
        conventions_from_options("irradia", {name: value})
