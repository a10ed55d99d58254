"""Perceptrons in half precision give the light of the NumPy references, nearly."""

from __future__ import annotations

import json
from dataclasses import replace

import pytest

from . import wrappers
from .cases import read_shaders, worst
from .field_cases import field_cases
from .lavapipe import Lavapipe, spirv

TOLERANCE = 1e-3  # of the case's largest number; 6.2e-4 was found at most
LEAST = 1e-6  # what has two hidden layers can't be as exact as floats
IN_HLSL = ("hash-fp16", "sh", "width-20")


@pytest.fixture(scope="module")
def half(web_check, tmp_path_factory):
    """A device, and cases and shaders by name."""
    folder = tmp_path_factory.mktemp("half")
    cases = {case.name: replace(case, precision="half") for case in field_cases(folder)}
    jobs = folder / "jobs.json"
    jobs.write_text(json.dumps([case.job() for case in cases.values()]), encoding="utf-8")
    web_check("shader-cases", folder, jobs)
    return Lavapipe(), cases, read_shaders(folder)


def test_light_in_halves_is_nearly_the_references(half):
    device, cases, shaders = half
    errors = {}
    for name, case in cases.items():
        code = wrappers.wgsl(shaders[name], None)
        errors[name] = worst(device.ask(shaders[name], code, case.questions.packed()), case.expected)
    assert {name: error for name, error in errors.items() if not error <= TOLERANCE} == {}
    assert max(errors.values()) > LEAST, "nothing was half"


@pytest.mark.parametrize("name", IN_HLSL)
def test_hlsl_of_halves_is_that_of_wgsl(half, name: str, tmp_path):
    device, cases, shaders = half
    shader, questions = shaders[name], cases[name].questions.packed()
    in_wgsl = device.ask(shader, wrappers.wgsl(shader, None), questions)
    compiled = spirv(wrappers.hlsl(shader, None), "hlsl", tmp_path, name)
    assert worst(device.ask(shader, compiled, questions), in_wgsl) <= TOLERANCE


def test_text_needs_the_extension(half):
    _, _, shaders = half
    shader = shaders["hash-fp16"]
    assert wrappers.wgsl(shader, None).startswith("enable f16;\n")
    assert "vec4h" in shader.text("wgsl")
    assert "half4" in shader.text("hlsl")
