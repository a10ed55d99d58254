"""All sources of light once on their way through web/checks, and a device to run their texts."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from . import wrappers
from .baked_cases import baked_cases
from .cases import Case, Shader, read_shaders
from .field_cases import field_cases
from .lavapipe import Lavapipe, spirv

Ask = Callable[[Case], np.ndarray]


@pytest.fixture(scope="session")
def cases(tmp_path_factory) -> tuple[Case, ...]:
    """Every source of light that the runtime makes shaders of, under names of their own."""
    made = (*field_cases(), *baked_cases(tmp_path_factory.mktemp("baked")))
    assert len({case.name for case in made}) == len(made)
    return made


@pytest.fixture(scope="session")
def shaders(cases, web_check, tmp_path_factory) -> dict[str, Shader]:
    """Their texts and bindings, by name of the case."""
    folder = tmp_path_factory.mktemp("shaders")
    jobs = folder / "jobs.json"
    jobs.write_text(json.dumps([case.job() for case in cases]), encoding="utf-8")
    web_check("shader-cases", folder, jobs)
    return read_shaders(folder)


@pytest.fixture(scope="session")
def lavapipe() -> Lavapipe:
    return Lavapipe()


@pytest.fixture(scope="session")
def in_browser(cases, shaders, web_check, chromium: str) -> dict[str, np.ndarray]:
    """By case what Chromium's WebGL2 answers, all on one page."""
    folder = next(iter(shaders.values())).folder
    asked = []
    for case in cases:
        questions = f"{case.name}.questions.bin"
        (folder / questions).write_bytes(case.questions.packed().tobytes())
        asked.append({"name": case.name, **wrappers.webgl2(shaders[case.name], case.view, questions)})
    (folder / "asked.json").write_text(json.dumps(asked), encoding="utf-8")
    found = web_check("shaders", folder / "asked.json", chromium)
    for name, answers in found.items():
        assert not isinstance(answers, str), f"{name}: {answers}"
    return {name: np.float64(answers).reshape(-1, 4)[:, :3] for name, answers in found.items()}


@pytest.fixture(scope="session")
def ask(shaders, lavapipe, tmp_path_factory) -> dict[str, Ask]:
    """By language, what a case's shader in it answers on lavapipe."""
    folder: Path = tmp_path_factory.mktemp("spirv")

    def by_wgsl(case: Case) -> np.ndarray:
        code = wrappers.wgsl(shaders[case.name], case.view)
        return lavapipe.ask(shaders[case.name], code, case.questions.packed())

    def by_spirv(language: str, wrap: Callable[[Shader, str | None], str]) -> Ask:
        def answer(case: Case) -> np.ndarray:
            code = spirv(wrap(shaders[case.name], case.view), language, folder, case.name)
            return lavapipe.ask(shaders[case.name], code, case.questions.packed())

        return answer

    return {
        "wgsl": by_wgsl,
        "glsl": by_spirv("glsl", wrappers.glsl),
        "hlsl": by_spirv("hlsl", wrappers.hlsl),
    }
