"""Fields of vectors/: every encoding, every way to store it, every activation and head."""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np

from irradia.field.files import load_field

from .cases import Case, Questions, made_questions

VECTORS = Path(__file__).resolve().parents[2] / "vectors"
NAMES = sorted(path.stem for path in VECTORS.glob("*.json"))
N_QUESTIONS = 200
NO_UNIFORMS = 0


def field_cases() -> Iterator[Case]:
    """All of them; one twice, the second time with its constants in a texture."""
    for name in NAMES:
        yield _case(name)
    yield replace(_case("hash-int4"), name="hash-int4-in-texture", max_uniform_bytes=NO_UNIFORMS)


def _case(name: str) -> Case:
    """The file's own questions first, then places all over the box and a little around."""
    stored = json.loads((VECTORS / f"{name}.json").read_text(encoding="utf-8"))
    file = VECTORS / stored["field"]
    field = replace(load_field(file), backend_name="numpy")
    low, high = field.frame.aabb
    around = 0.1 * (high - low)
    made = made_questions(N_QUESTIONS, low - around, high + around)
    n = len(stored["positions"])
    position, normal = made.position.copy(), made.normal.copy()
    position[:n], normal[:n] = stored["positions"], stored["normals"]
    expected = field.irradiance(position, normal)
    expected[:n] = stored["irradiance"]
    questions = Questions(**{**made.__dict__, "position": position, "normal": normal})
    return Case(name, file, "field", questions, np.float64(expected))
