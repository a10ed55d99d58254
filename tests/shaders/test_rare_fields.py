"""Fields that no vector covers give the light of the NumPy reference."""

from __future__ import annotations

import json

import pytest

from . import wrappers
from .cases import read_shaders, worst
from .lavapipe import Lavapipe
from .rare_fields import RARE, rare_cases

TOLERANCE = 1e-5


@pytest.fixture(scope="module")
def rare(web_check, tmp_path_factory):
    """A device, and cases and shaders by name."""
    folder = tmp_path_factory.mktemp("rare")
    cases = {case.name: case for case in rare_cases(folder)}
    jobs = folder / "jobs.json"
    jobs.write_text(json.dumps([case.job() for case in cases.values()]), encoding="utf-8")
    web_check("shader-cases", folder, jobs)
    return Lavapipe(), cases, read_shaders(folder)


@pytest.mark.parametrize("name", RARE)
def test_rare_fields_are_those_of_numpy(rare, name: str):
    device, cases, shaders = rare
    case, shader = cases[name], shaders[name]
    found = device.ask(shader, wrappers.wgsl(shader, None), case.questions.packed())
    assert worst(found, case.expected) <= TOLERANCE
