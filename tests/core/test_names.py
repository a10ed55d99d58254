"""Suggestions for names that don't exist."""

from __future__ import annotations

import pytest

from irradia.core.names import did_you_mean, nearest_name


@pytest.mark.parametrize(
    ("name", "expected"), [("casst", "casts"), ("RECEIVES", "receives"), ("casts", "casts")]
)
def test_nearest_name_is_found_in_any_case(name, expected):
    assert nearest_name(name, ["receives", "casts"]) == expected


def test_nothing_known_suggests_nothing():
    assert nearest_name("x", []) is None
    assert did_you_mean("x", []) == "There are none."


def test_suggestion_quotes_the_name():
    assert did_you_mean("casst", ["casts"]) == "Did you mean 'casts'?"
