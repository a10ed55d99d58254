"""Texts of shaders give the light of the NumPy references, in every language and on every target."""

from __future__ import annotations

import pytest

from .cases import Case, worst

TOLERANCE = 1e-5
SOURCES = ("field", "lightmap", "directional", "probes", "things", "direct")


def worst_errors(cases: tuple[Case, ...], source: str, ask) -> dict[str, float]:
    """By case of a source the largest error, as a share of the largest value."""
    asked = [case for case in cases if case.source == source]
    assert asked
    return {case.name: worst(ask(case), case.expected) for case in asked}


@pytest.mark.parametrize("source", SOURCES)
@pytest.mark.parametrize("language", ["wgsl", "glsl"])
def test_on_vulkan(ask, cases: tuple[Case, ...], source: str, language: str) -> None:
    errors = worst_errors(cases, source, ask[language])
    assert max(errors.values()) <= TOLERANCE, errors


# What sums indirect light and a direct map is made for WGSL and GLSL alone.
@pytest.mark.parametrize("source", [source for source in SOURCES if source != "direct"])
def test_hlsl_on_vulkan(ask, cases: tuple[Case, ...], source: str) -> None:
    errors = worst_errors(cases, source, ask["hlsl"])
    assert max(errors.values()) <= TOLERANCE, errors


def test_glsl_in_webgl2(in_browser, cases: tuple[Case, ...]) -> None:
    errors = {case.name: worst(in_browser[case.name], case.expected) for case in cases}
    assert max(errors.values()) <= TOLERANCE, errors
