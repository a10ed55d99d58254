"""What is kept for the next time, and that a bad cache does no harm."""

from __future__ import annotations

import numpy as np
import pytest

from irradia.core.cache import cached_arrays, cached_path


@pytest.fixture(autouse=True)
def own_cache(tmp_path, monkeypatch):
    monkeypatch.setenv("IRRADIA_CACHE", str(tmp_path))


class Maker:
    def __init__(self) -> None:
        self.n_calls = 0

    def __call__(self):
        self.n_calls += 1
        return {"a": np.arange(3.0), "b": np.float32([[self.n_calls]])}


def test_arrays_are_made_once_for_each_key():
    make = Maker()
    first = cached_arrays("things", {"x": 1}, make)
    again = cached_arrays("things", {"x": 1}, make)
    other = cached_arrays("things", {"x": 2}, make)
    assert make.n_calls == 2
    assert {name: value.tolist() for name, value in again.items()} == {
        name: value.tolist() for name, value in first.items()
    }
    assert other["b"] != first["b"]


def test_the_order_of_a_key_does_not_matter_but_its_values_do():
    same = [cached_path("things", key, ".npz") for key in ({"a": 1, "b": [2]}, {"b": [2], "a": 1})]
    assert same[0] == same[1]
    assert cached_path("things", {"a": 1, "b": [3]}, ".npz") != same[0]
    assert cached_path("others", {"a": 1, "b": [2]}, ".npz") != same[0]


@pytest.mark.parametrize("damage", [b"", b"PK\x03\x04nonsense", b"no archive at all"])
def test_a_damaged_file_is_made_again(damage):
    make = Maker()
    cached_arrays("things", {"x": 1}, make)
    path = cached_path("things", {"x": 1}, ".npz")
    path.write_bytes(damage)
    cached_arrays("things", {"x": 1}, make)
    assert make.n_calls == 2
    cached_arrays("things", {"x": 1}, make)
    assert make.n_calls == 2


def test_a_cache_that_cannot_be_written_does_no_harm(tmp_path, monkeypatch):
    blocked = tmp_path / "file"
    blocked.write_text("in the way")
    monkeypatch.setenv("IRRADIA_CACHE", str(blocked))
    assert cached_arrays("things", {"x": 1}, Maker())["a"].tolist() == [0.0, 1.0, 2.0]
