"""vectors/: files of every version stay readable, and every backend gives the reference's answers."""

from __future__ import annotations

import importlib.util
import json
from dataclasses import replace
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
import pytest
import zstandard

from irradia.field.backends import available, backend
from irradia.field.files import load_field
from irradia.field.registry import ENCODINGS

ROOT = Path(__file__).resolve().parents[2]
ANSWERS = sorted((ROOT / "vectors").glob("*.json"))
NAMES = sorted(path.stem for path in ANSWERS)


@pytest.fixture(scope="module")
def maker() -> ModuleType:
    """scripts/make_vectors.py."""
    found = importlib.util.spec_from_file_location("make_vectors", ROOT / "scripts" / "make_vectors.py")
    assert found is not None
    assert found.loader is not None
    module = importlib.util.module_from_spec(found)
    import sys

    sys.modules["make_vectors"] = module  # dataclasses look their module up
    found.loader.exec_module(module)
    return module


def answers(name: str) -> dict[str, Any]:
    return json.loads((ROOT / "vectors" / f"{name}.json").read_text(encoding="utf-8"))


@pytest.mark.parametrize("computing", ["numpy", "numba"])
@pytest.mark.parametrize("name", NAMES)
def test_file_gives_the_stored_answers(name: str, computing: str) -> None:
    expected = answers(name)
    field = load_field(ROOT / "vectors" / expected["field"])
    assert computing in available()
    if backend(computing).lacks(field.spec):
        pytest.fail(f"{computing} can't compute {name}")
    field = replace(field, backend_name=computing)
    assert field.frame.scale == expected["scale"]
    positions, normals = (np.array(expected[key], np.float32) for key in ("positions", "normals"))
    found = field.irradiance(positions, normals)
    np.testing.assert_allclose(found, expected["irradiance"], rtol=2e-5, atol=2e-6)
    if "coefficients" in expected:
        np.testing.assert_allclose(
            field.coefficients(positions), expected["coefficients"], rtol=2e-5, atol=2e-6
        )


def test_files_and_answers_are_what_the_script_makes(maker: ModuleType) -> None:
    made = {vector.name: maker.make(vector) for vector in maker.vectors()}
    assert sorted(made) == NAMES
    files = {name for name, _, _ in made.values()} | {f"{name}.json" for name in NAMES} | {"README.md"}
    assert {path.name for path in (ROOT / "vectors").iterdir()} == files
    for name, (file_name, data, expected) in made.items():
        stored = (ROOT / "vectors" / file_name).read_bytes()
        if file_name.endswith(".zst"):  # another version of zstd may pack otherwise
            data, stored = (zstandard.ZstdDecompressor().decompress(each) for each in (data, stored))
        assert data == stored, file_name
        for key, value in answers(name).items():
            if isinstance(value, list):
                np.testing.assert_allclose(expected[key], value, rtol=1e-6, atol=1e-7)
            else:
                assert expected[key] == value


def test_light_of_the_vectors_is_no_constant() -> None:
    for name in NAMES:
        light = np.array(answers(name)["irradiance"])
        assert np.std(light) > 0.01 * np.mean(light) > 0.0, name


def test_every_encoding_is_among_them() -> None:
    def kinds(values: Any) -> set[str]:
        if isinstance(values, dict):
            return {values["type"]} | {kind for part in values.get("parts", ()) for kind in kinds(part)}
        return set()

    fields = [load_field(ROOT / "vectors" / answers(name)["field"]) for name in NAMES]
    found = {kind for field in fields for kind in kinds(field.spec.position.spec())}
    assert found == set(ENCODINGS)
    assert {field.spec.activation for field in fields} == {"relu", "leaky_relu", "silu", "gelu", "sine"}
    assert {field.spec.head for field in fields} == {"exp", "softplus", "linear"}
    assert {field.spec.mode for field in fields} == {"irradiance", "sh1", "sh2"}


def test_packed_file_holds_the_same_field_as_the_plain_one() -> None:
    packed = (ROOT / "vectors" / "hash-int4-packed.safetensors.zst").read_bytes()
    plain = (ROOT / "vectors" / "hash-int4.safetensors").read_bytes()
    assert zstandard.ZstdDecompressor().decompress(packed) == plain
