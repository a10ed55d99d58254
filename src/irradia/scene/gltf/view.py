"""Checked access to the parsed JSON: every value knows its JSON pointer, so every error can name it."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from irradia.core.errors import InputError

_MISSING = object()


@dataclass(frozen=True)
class JsonView:
    """A JSON value and where it stands.

    Attributes:
        value: The parsed value.
        pointer: RFC 6901 pointer, such as ``/materials/3/pbrMetallicRoughness``.
    """

    value: Any
    pointer: str = ""

    def has(self, key: str) -> bool:
        """Whether this object has ``key``."""
        return key in self._object()

    def object(self, key: str) -> JsonView:
        """The object under ``key``; an empty one where it is absent."""
        child = self._child(key, {})
        child._object()
        return child

    def items(self, key: str) -> list[JsonView]:
        """The elements of the array under ``key``; none where it is absent."""
        array = self._array(key)
        return [JsonView(value, f"{array.pointer}/{index}") for index, value in enumerate(array.value)]

    def entries(self) -> Iterator[tuple[str, JsonView]]:
        """The members of this object."""
        for key in self._object():
            yield key, self._child(key, None)

    def length(self, key: str) -> int:
        """How many elements the array under ``key`` has; 0 where it is absent."""
        return len(self._array(key).value)

    def element(self, key: str, index: int) -> JsonView:
        """Element ``index`` of the array under ``key``.

        Raises:
            InputError: There is no such element.
        """
        array = self._array(key)
        if not 0 <= index < len(array.value):
            raise InputError(
                f"expected an index below {len(array.value)}, found {index}", where=array.pointer
            )
        return JsonView(array.value[index], f"{array.pointer}/{index}")

    def number(self, key: str, default: float, *, minimum: float = -math.inf) -> float:
        """A finite number of at least ``minimum``."""
        child = self._child(key, default)
        value = _finite(child)
        if value < minimum:
            raise self._wrong(child, f"a number of at least {minimum:g}")
        return value

    def fraction(self, key: str, default: float) -> float:
        """A number clamped to [0, 1]: exporters write 1.0000001, which is no reason to stop."""
        return min(max(self.number(key, default), 0.0), 1.0)

    def integer(self, key: str, default: int | None = None, *, minimum: int = 0) -> int:
        """A whole number of at least ``minimum``; an error where it is absent without a default."""
        child = self._child(key, _MISSING if default is None else default)
        if child.value is _MISSING:
            raise InputError(f"'{key}' is missing", where=self.pointer or "/")
        value = child.value
        if isinstance(value, float) and value.is_integer():
            value = int(value)
        if isinstance(value, bool) or not isinstance(value, int) or value < minimum:
            raise self._wrong(child, f"a whole number of at least {minimum}")
        return value

    def index(self, key: str, count: int) -> int | None:
        """An index below ``count``, or None where it is absent."""
        if not self.has(key):
            return None
        value = self.integer(key)
        if value >= count:
            child = self._child(key, None)
            raise InputError(f"expected an index below {count}, found {value}", where=child.pointer)
        return value

    def boolean(self, key: str, default: bool) -> bool:
        """True or false."""
        child = self._child(key, default)
        if not isinstance(child.value, bool):
            raise self._wrong(child, "true or false")
        return child.value

    def string(self, key: str, default: str = "") -> str:
        """A text."""
        child = self._child(key, default)
        if not isinstance(child.value, str):
            raise self._wrong(child, "a string")
        return child.value

    def choice(self, key: str, choices: tuple[str, ...], default: str | None = None) -> str:
        """One of ``choices``."""
        value = self.string(key, "" if default is None else default)
        if value not in choices:
            raise InputError(
                f"expected one of {', '.join(choices)}, found '{value}'", where=f"{self.pointer}/{key}"
            )
        return value

    def numbers(self, key: str, default: tuple[float, ...]) -> tuple[float, ...]:
        """As many finite numbers as ``default`` has."""
        if not self.has(key):
            return default
        values = self.items(key)
        if len(values) != len(default):
            raise InputError(
                f"expected {len(default)} numbers, found {len(values)}", where=f"{self.pointer}/{key}"
            )
        return tuple(_finite(value) for value in values)

    def fractions(self, key: str, default: tuple[float, ...]) -> tuple[float, ...]:
        """As many numbers as ``default`` has, each clamped to [0, 1]."""
        return tuple(min(max(value, 0.0), 1.0) for value in self.numbers(key, default))

    def extension(self, name: str) -> JsonView | None:
        """This object's extension ``name``, or None."""
        extensions = self.object("extensions")
        return extensions.object(name) if extensions.has(name) else None

    def _object(self) -> dict[str, Any]:
        if not isinstance(self.value, dict):
            raise self._wrong(self, "an object")
        return self.value

    def _array(self, key: str) -> JsonView:
        child = self._child(key, [])
        if not isinstance(child.value, list):
            raise self._wrong(child, "an array")
        return child

    def _child(self, key: str, default: Any) -> JsonView:
        escaped = key.replace("~", "~0").replace("/", "~1")
        return JsonView(self._object().get(key, default), f"{self.pointer}/{escaped}")

    @staticmethod
    def _wrong(view: JsonView, expected: str) -> InputError:
        found = type(view.value).__name__ if isinstance(view.value, dict | list) else repr(view.value)
        return InputError(f"expected {expected}, found {found[:60]}", where=view.pointer or "/")


def _finite(view: JsonView) -> float:
    value = view.value
    if isinstance(value, bool) or not isinstance(value, int | float) or not math.isfinite(value):
        raise InputError(f"expected a finite number, found {str(value)[:60]!r}", where=view.pointer)
    return float(value)
