"""Fields of vectors/, with every encoding, activation and way to store it; wider ones; and views of them."""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np

from irradia.core.rng import Seed
from irradia.field.encodings import HashGrid, SphericalHarmonics
from irradia.field.field import Field
from irradia.field.files import load_field
from irradia.field.init import new_parameters
from irradia.field.native_fields import decode_field, encode_field
from irradia.field.network import evaluate
from irradia.field.spec import FieldFrame, FieldSpec

from .cases import Case, Questions, made_questions

VECTORS = Path(__file__).resolve().parents[2] / "vectors"
NAMES = sorted(path.stem for path in VECTORS.glob("*.json"))
N_QUESTIONS = 200
# Lavapipe compiles constants in a texture in half the time of constants in a uniform array.
NO_UNIFORMS = 0
IN_UNIFORMS = ("hash-int4", "triplane-sh2-int8")
WIDTHS = (20, 64, 100)  # vectors/ have 8; registers hold 16, 32, 64 or 128
VIEWED = ("hash-int8", "hash-sh1")


def field_cases(folder: Path) -> Iterator[Case]:
    """All of vectors/; some again with constants in uniforms; wider ones, whose files go to ``folder``."""
    for name in NAMES:
        yield _case(name)
    for name in IN_UNIFORMS:
        yield replace(_case(name), name=f"{name}-in-uniforms", max_uniform_bytes=None)
    for width in WIDTHS:
        yield _wide_case(folder, width)


def view_cases() -> Iterator[Case]:
    """What fields are inside: raw outputs, light before its limits, the place in the box."""
    for name in VIEWED:
        light = _case(name)
        field, asked = load_field(light.file), light.questions
        expected = {
            "raw": _outputs(field, replace(field.spec, head="linear"), asked),
            "unit-position": field.frame.to_unit(asked.position),
        }
        if field.spec.mode == "irradiance":
            expected["unclamped"] = _outputs(field, field.spec, asked) * field.frame.scale
        for view, numbers in expected.items():
            shown = {"name": f"{name}-{view}", "expected": np.float64(numbers), "view": view}
            yield replace(light, **shown, everywhere=False)


def _outputs(field: Field, spec: FieldSpec, asked: Questions) -> np.ndarray:
    """(Q, 3), the first three of a network's outputs."""
    normal = asked.normal if spec.mode == "irradiance" else None
    return evaluate(spec, field.parameters, field.frame.to_unit(asked.position), normal)[:, :3]


def _wide_case(folder: Path, width: int) -> Case:
    """Three hidden layers of a width that isn't a multiple of registers."""
    spec = FieldSpec(HashGrid(4, 8), SphericalHarmonics(3), width=width, n_hidden_layers=3)
    frame = FieldFrame(np.float32([[-1, 0, 0.5], [1, 2.25, 4.5]]), scale=2.0)
    made = Field(spec, frame, new_parameters(spec, Seed(width)))
    file = folder / f"width-{width}.safetensors"
    file.write_bytes(encode_field(made, precision="fp32"))
    field = replace(decode_field(file.read_bytes()).field, backend_name="numpy")
    asked = _questions(field)
    light = np.float64(field.irradiance(asked.position, asked.normal))
    return Case(file.stem, file, "field", asked, light, everywhere=width == WIDTHS[0])


def _questions(field: Field) -> Questions:
    """Places all over the box and a little around."""
    low, high = field.frame.aabb
    around = 0.1 * (high - low)
    return made_questions(N_QUESTIONS, low - around, high + around)


def _case(name: str) -> Case:
    """The file's own questions first."""
    stored = json.loads((VECTORS / f"{name}.json").read_text(encoding="utf-8"))
    file = VECTORS / stored["field"]
    field = replace(load_field(file), backend_name="numpy")
    made = _questions(field)
    n = len(stored["positions"])
    position, normal = made.position.copy(), made.normal.copy()
    position[:n], normal[:n] = stored["positions"], stored["normals"]
    expected = field.irradiance(position, normal)
    expected[:n] = stored["irradiance"]
    questions = Questions(**{**made.__dict__, "position": position, "normal": normal})
    return Case(name, file, "field", questions, np.float64(expected), max_uniform_bytes=NO_UNIFORMS)
