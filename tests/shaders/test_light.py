"""Texts of shaders give the light of the NumPy references, in every language and on every target."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
import pytest

from .cases import Case, worst

TOLERANCE = 1e-5
TARGETS = ("wgsl", "glsl", "hlsl", "webgl2")
SOURCES = ("field", "lightmap", "directional", "probes", "things")


def expect_references(cases: Iterable[Case], found: dict[str, np.ndarray]) -> None:
    """Every number within the tolerance, as a share of the case's largest."""
    errors = {case.name: worst(found[case.name], case.expected) for case in cases}
    assert errors
    too_large = {name: error for name, error in errors.items() if not error <= TOLERANCE}
    assert not too_large


@pytest.mark.parametrize("target", TARGETS)
@pytest.mark.parametrize("source", SOURCES)
def test_light_is_the_references(answers, cases: tuple[Case, ...], source: str, target: str) -> None:
    asked = [case for case in cases if case.source == source and case.view is None]
    if target in ("glsl", "hlsl"):
        asked = [case for case in asked if case.everywhere]
    expect_references(asked, answers(target))


# What adds the map to indirect light is made for engines of the web alone.
@pytest.mark.parametrize("target", ["wgsl", "glsl", "webgl2"])
def test_direct_map_adds_to_indirect_light(answers, cases: tuple[Case, ...], target: str) -> None:
    expect_references([case for case in cases if case.source == "direct"], answers(target))


@pytest.mark.parametrize("target", ["wgsl", "webgl2"])
def test_views_show_the_references_numbers(answers, cases: tuple[Case, ...], target: str) -> None:
    expect_references([case for case in cases if case.view is not None], answers(target))
