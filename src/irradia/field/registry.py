"""Encodings by name, and specs as plain values and as the text that reproduces them."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping
from dataclasses import fields
from types import UnionType
from typing import Any, Literal, get_args, get_origin, get_type_hints

from irradia.core.errors import InputError
from irradia.core.names import did_you_mean
from irradia.field.encoding import Encoding
from irradia.field.encodings import (
    Composite,
    Frequency,
    HashGrid,
    Identity,
    OneBlob,
    SphericalHarmonics,
    TriPlane,
)
from irradia.field.spec import FieldSpec

ENCODINGS: dict[str, type[Encoding]] = {
    encoding.name: encoding
    for encoding in (HashGrid, TriPlane, Frequency, OneBlob, SphericalHarmonics, Identity, Composite)
}


def register(encoding: type[Encoding]) -> type[Encoding]:
    """Makes an encoding known by its name; usable as a decorator.

    Raises:
        InputError: If another has the name.
    """
    if ENCODINGS.setdefault(encoding.name, encoding) is not encoding:
        raise InputError(f"there is an encoding {encoding.name!r} already")
    return encoding


def encoding_from_spec(values: Mapping[str, Any], *, where: str = "encoding") -> Encoding:
    """Makes an encoding from what its ``spec()`` gave, also after a way through JSON.

    Args:
        values: ``type`` and the encoding's own fields; fields left out have their defaults.
        where: For errors.

    Raises:
        InputError: On an unknown type or field, or a value out of range.
    """
    if not isinstance(values, Mapping) or not isinstance(values.get("type"), str):
        raise InputError("expected an encoding as an object with a string `type`", where=where)
    kind = values["type"]
    _check_known([kind], ENCODINGS, "encoding", where)
    own = {key: _plain(value, f"{where}/{key}") for key, value in values.items() if key != "type"}
    return _make(ENCODINGS[kind], own, where)


def spec_to_dict(spec: FieldSpec) -> dict[str, Any]:
    """Plain values that :func:`spec_from_dict` makes the spec from again."""
    values = {f.name: getattr(spec, f.name) for f in fields(spec)}
    return {key: value.spec() if isinstance(value, Encoding) else value for key, value in values.items()}


def spec_from_dict(values: Mapping[str, Any], *, where: str = "spec") -> FieldSpec:
    """Makes a spec from plain values; what is left out has its default.

    Raises:
        InputError: On unknown keys, naming the nearest, and on values that don't go together.
    """
    if not isinstance(values, Mapping) or "position" not in values:
        raise InputError("expected an object with at least `position`", where=where)
    return _make(FieldSpec, {key: _plain(value, f"{where}/{key}") for key, value in values.items()}, where)


def print_spec(spec: FieldSpec) -> str:
    """The JSON file that reproduces a spec."""
    return json.dumps(spec_to_dict(spec), indent=2) + "\n"


def read_spec(text: str, *, where: str = "spec") -> FieldSpec:
    """Reads what :func:`print_spec` printed.

    Raises:
        InputError: As :func:`spec_from_dict`, and if it isn't JSON.
    """
    try:
        values = json.loads(text)
    except json.JSONDecodeError as error:
        raise InputError(f"expected JSON, found {error.msg} in line {error.lineno}", where=where) from None
    return spec_from_dict(values, where=where)


def _plain(value: Any, where: str) -> Any:
    """JSON's values as dataclass fields: an object with a type is an encoding, a list a tuple."""
    if isinstance(value, Mapping):
        return encoding_from_spec(value, where=where)
    if isinstance(value, (list, tuple)):
        return tuple(_plain(item, f"{where}/{i}") for i, item in enumerate(value))
    return value


def _make(made: type[Any], values: dict[str, Any], where: str) -> Any:
    _check_known(values, [f.name for f in fields(made)], "key", where)
    hints = get_type_hints(made)
    for key, value in values.items():
        _check_type(value, hints[key], f"{where}/{key}")
    try:
        return made(**values)
    except InputError as error:
        raise InputError(error.message, where=where, fix=error.fix) from None


def _check_type(value: Any, hint: Any, where: str) -> None:
    """Refuses values of a wrong type; a float may be written as a whole number, a bool is no number."""
    options = get_args(hint)
    if get_origin(hint) is Literal:
        if value not in options:
            raise InputError(f"unknown value {value!r}", where=where, fix=did_you_mean(str(value), options))
        return
    kinds = [get_origin(kind) or kind for kind in (options if isinstance(hint, UnionType) else (hint,))]
    accepted = (*kinds, int) if float in kinds else tuple(kinds)
    if not isinstance(value, accepted) or (isinstance(value, bool) and bool not in kinds):
        wanted = " or ".join(kind.__name__ for kind in kinds)
        raise InputError(f"expected {wanted}, found {value!r}", where=where)


def _check_known(names: Iterable[str], known: Iterable[str], what: str, where: str) -> None:
    known = list(known)
    for name in names:
        if name not in known:
            raise InputError(f"unknown {what} {name!r}", where=where, fix=did_you_mean(name, known))
