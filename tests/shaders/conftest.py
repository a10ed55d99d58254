"""All sources of light once on their way through web/checks, and once through every target."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pytest

from . import wrappers
from .baked_cases import baked_cases, probe_view_cases
from .cases import Case, Shader, read_shaders
from .field_cases import field_cases, view_cases
from .lavapipe import Lavapipe, spirv

Answers = dict[str, np.ndarray]


@pytest.fixture(scope="session")
def cases(tmp_path_factory) -> tuple[Case, ...]:
    """Every source of light that the runtime makes shaders of, under names of their own."""
    folder = tmp_path_factory.mktemp("sources")
    made = (*field_cases(folder), *baked_cases(folder), *view_cases(), *probe_view_cases(folder))
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
def answers(cases, shaders, web_check, chromium: str, tmp_path_factory) -> Iterator[Callable[[str], Answers]]:
    """What ``wgsl``, ``glsl`` and ``hlsl`` on lavapipe and ``webgl2`` in Chromium answer, by case.

    Drivers compile on one thread each, so the targets work side by side.
    """
    folder = tmp_path_factory.mktemp("spirv")
    with ThreadPoolExecutor() as pool:
        work = {
            "wgsl": pool.submit(by_wgsl, cases, shaders),
            "glsl": pool.submit(by_glslang, "glsl", wrappers.glsl, cases, shaders, folder),
            "hlsl": pool.submit(by_glslang, "hlsl", wrappers.hlsl, cases, shaders, folder),
            "webgl2": pool.submit(by_browser, cases, shaders, web_check, chromium),
        }
        yield lambda target: work[target].result()


def by_wgsl(cases: tuple[Case, ...], shaders: dict[str, Shader]) -> Answers:
    device = Lavapipe()

    def ask(case: Case) -> np.ndarray:
        shader = shaders[case.name]
        return device.ask(shader, wrappers.wgsl(shader, case.view), case.questions.packed())

    return {case.name: ask(case) for case in cases}


def by_glslang(
    language: str,
    wrap: Callable[[Shader, str | None], str],
    cases: tuple[Case, ...],
    shaders: dict[str, Shader],
    folder: Path,
) -> Answers:
    """Through SPIR-V; what a language lacks is left out."""
    device = Lavapipe()

    def ask(case: Case) -> np.ndarray:
        shader = shaders[case.name]
        code = spirv(wrap(shader, None), language, folder, case.name)
        return device.ask(shader, code, case.questions.packed())

    asked = [case for case in cases if case.everywhere and shaders[case.name].text(language)]
    return {case.name: ask(case) for case in asked}


def by_browser(cases: tuple[Case, ...], shaders: dict[str, Shader], web_check, chromium: str) -> Answers:
    """All on one page."""
    folder = next(iter(shaders.values())).folder
    asked = []
    for case in cases:
        questions = f"{case.name}.questions.bin"
        (folder / questions).write_bytes(case.questions.packed().tobytes())
        asked.append({"name": case.name, **wrappers.webgl2(shaders[case.name], case.view, questions)})
    (folder / "asked.json").write_text(json.dumps(asked), encoding="utf-8")
    found = web_check("shaders", folder / "asked.json", chromium)
    for name, numbers in found.items():
        assert not isinstance(numbers, str), f"{name}: {numbers}"
    return {name: np.float64(numbers).reshape(-1, 4)[:, :3] for name, numbers in found.items()}
