"""What is generated from shaders/wgsl/ is fresh, whole, and nothing but functions and their constants."""

from __future__ import annotations

import re
import shutil
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
SHADERS = ROOT / "shaders"
PIECES = sorted(path.stem for path in (SHADERS / "wgsl").glob("*.wgsl"))
HALF = {"perceptron-half", "halves-16", "halves-32", "halves-64", "halves-128"}
ENDS = {"glsl": "glsl", "hlsl": "hlsl", "msl": "metal"}
# What whole shaders have and pieces of them mustn't: engines bring their own.
BOILERPLATE = {
    "glsl": r"#version|precision |\bvoid main\(|gl_FragColor|layout\(|_group_\d",
    "hlsl": r"register\(|SamplerState|SamplerHeap|StructuredBuffer|cbuffer|\bmain\(|SV_",
    "msl": r"#include|using |\[\[|\b(?:fragment|vertex|kernel) |struct (?!irradia_)",
}


@pytest.mark.usefixtures("web_check")
def test_generated_files_are_fresh() -> None:
    node = shutil.which("node")
    assert node is not None
    command = [node, ROOT / "web" / "dist" / "shaders" / "generate.js", "--check"]
    done = subprocess.run(list(map(str, command)), capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr


@pytest.mark.parametrize("language", ENDS)
def test_every_piece_is_there_and_says_where_it_comes_from(language: str) -> None:
    for piece in pieces_in(language):
        first = text_of(piece, language).splitlines()[0]
        assert first.startswith(f"// Generated from shaders/wgsl/{piece}.wgsl")


@pytest.mark.parametrize("language", ENDS)
def test_pieces_hold_no_boilerplate(language: str) -> None:
    found = {}
    for path in sorted((SHADERS / language).iterdir()):
        code = re.sub(r"//.*", "", path.read_text(encoding="utf-8"))
        if match := re.search(BOILERPLATE[language], code):
            found[path.name] = match.group()
    assert not found


@pytest.mark.parametrize("language", ENDS)
def test_names_survive(language: str) -> None:
    for piece in pieces_in(language):
        wanted = re.findall(r"^fn (\w+)", (SHADERS / "wgsl" / f"{piece}.wgsl").read_text(), re.MULTILINE)
        text = text_of(piece, language)
        missing = [name for name in wanted if not re.search(rf"\b{name}\(", text)]
        assert not missing, piece


@pytest.mark.parametrize("language", ENDS)
def test_loops_are_of_the_kind_that_compilers_unroll(language: str) -> None:
    for path in sorted((SHADERS / language).iterdir()):
        code = re.sub(r"//.*", "", path.read_text(encoding="utf-8"))
        assert not re.search(r"\bwhile\b|loop_(?:init|bound)", code), path.name


@pytest.mark.usefixtures("web_check")
def test_tidying_keeps_what_texts_mean() -> None:
    node = shutil.which("node")
    assert node is not None
    command = [node, "--test", ROOT / "web" / "dist" / "shaders" / "tidy.test.js"]
    done = subprocess.run(list(map(str, command)), capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr


def test_all_names_begin_with_ours_and_end_in_letters() -> None:
    declared = re.compile(r"^(?:fn|const|struct|var<private>)\s+(\w+)", re.MULTILINE)
    for piece in PIECES:
        for name in declared.findall((SHADERS / "wgsl" / f"{piece}.wgsl").read_text(encoding="utf-8")):
            assert re.fullmatch(r"irradia_\w*[a-z]", name), f"{piece}: {name}"


def pieces_in(language: str) -> list[str]:
    """All but those with half floats, which GLSL ES 3.00 hasn't."""
    return [piece for piece in PIECES if language != "glsl" or piece not in HALF]


def text_of(piece: str, language: str) -> str:
    return (SHADERS / language / f"{piece}.{ENDS[language]}").read_text(encoding="utf-8")
