"""Specs as plain values and back, and clear words for what isn't one."""

from __future__ import annotations

import json

import pytest

from irradia.core.errors import InputError
from irradia.field.encodings import Composite, Frequency, HashGrid, Identity, SphericalHarmonics
from irradia.field.registry import (
    ENCODINGS,
    encoding_from_spec,
    print_spec,
    read_spec,
    register,
    spec_from_dict,
    spec_to_dict,
)
from irradia.field.spec import FieldSpec

SPEC = FieldSpec(Composite((HashGrid(4), Composite((Frequency(3),)))), SphericalHarmonics(2), 32, 3, "sine")


def test_encodings_survive_json(small_encoding):
    assert encoding_from_spec(json.loads(json.dumps(small_encoding.spec()))) == small_encoding


def test_a_printed_spec_reproduces_the_spec():
    assert read_spec(print_spec(SPEC)) == SPEC
    assert spec_from_dict(spec_to_dict(SPEC)) == SPEC


def test_a_printed_spec_of_coefficients_reproduces_it_too():
    spec = FieldSpec(Identity(), mode="sh2", head="linear")
    assert read_spec(print_spec(spec)) == spec


def test_what_is_left_out_has_its_default():
    assert spec_from_dict({"position": {"type": "hash"}, "direction": {"type": "identity"}}) == FieldSpec(
        HashGrid(), Identity()
    )


@pytest.mark.parametrize(
    ("path", "value", "message"),
    [
        (("widht",), 64, "unknown key 'widht'\n.*'width'"),
        (("width",), "64", "/width: expected int, found '64'"),
        (("width",), True, "/width: expected int, found True"),
        (("width",), 64.0, "/width: expected int"),
        (("activation",), "rellu", "/activation: unknown value 'rellu'\n.*'relu'"),
        (("position", "type"), "hsah", "/position: unknown encoding 'hsah'\n.*'hash'"),
        (("position", "n_level"), 4, "/position: unknown key 'n_level'\n.*'n_levels'"),
        (("position", "n_levels"), 0, "/position: expected 1–32 levels"),
        (("position", "full_levels"), 1, "/position/full_levels: expected bool"),
        (("position", "convention"), "ceil", "/position/convention: unknown value 'ceil'"),
        (("direction",), "sh", "/direction: expected Encoding or NoneType, found 'sh'"),
        (("direction",), None, "spec: irradiance needs the normal"),
        (("n_hidden_layers",), 9, "spec: expected 1 to 6 hidden layers"),
    ],
)
def test_wrong_values_are_named_with_their_place(path, value, message):
    values = spec_to_dict(FieldSpec(HashGrid(), Identity()))
    place = values
    for key in path[:-1]:
        place = place[key]
    place[path[-1]] = value
    with pytest.raises(InputError, match=f"(?s){message}"):
        spec_from_dict(values)


def test_a_wrong_part_is_found_within_its_composition():
    with pytest.raises(InputError, match="/parts/1: unknown encoding"):
        encoding_from_spec({"type": "composite", "parts": [{"type": "identity"}, {"type": "identty"}]})


@pytest.mark.parametrize(
    "text", ["", "{", "[]", "7", '{"width": 3}', '{"position": {}}', '{"position": {"type": 3}}']
)
def test_what_is_no_spec_is_refused(text):
    with pytest.raises(InputError, match="expected"):
        read_spec(text)


def test_a_name_is_taken_once():
    class Impostor(Identity):
        pass

    with pytest.raises(InputError, match="already"):
        register(Impostor)
    assert register(Identity) is ENCODINGS["identity"]
