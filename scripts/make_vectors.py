"""Writes vectors/: small field files, questions, and the answers of the NumPy reference.

Whatever reads fields, in Python, TypeScript or a shader, is held to these. The weights are random numbers
that mean nothing; `tests/field/test_vectors.py` sees to it that running this again changes nothing.
"""

from __future__ import annotations

import argparse
import json
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from irradia.core.rng import Seed
from irradia.core.sh import fibonacci_sphere
from irradia.field.bin_reader import decode_bin
from irradia.field.bin_writer import encode_bin
from irradia.field.encoding import Encoding
from irradia.field.encodings import (
    Composite,
    Frequency,
    HashGrid,
    Identity,
    OneBlob,
    SphericalHarmonics,
    TriPlane,
)
from irradia.field.field import Field
from irradia.field.init import new_parameters
from irradia.field.native_fields import Precision, decode_field, encode_field
from irradia.field.quantise import round_tables
from irradia.field.quantised import QuantisedField
from irradia.field.spec import FieldFrame, FieldSpec

FOLDER = Path(__file__).resolve().parents[1] / "vectors"
BOX = np.array([(-1.0, 0.0, 0.5), (1.0, 2.25, 4.5)], np.float32)
N_QUERIES = 12

GRID = HashGrid(n_levels=3, log2_table_size=6, base_resolution=3, max_resolution=12)
PLANES = TriPlane(resolution=6, n_features=4)


@dataclass(frozen=True)
class Vector:
    """A field and how it is stored.

    Attributes:
        name: Of its files.
        spec: Of the field.
        storage: ``fp16``, ``fp32``, ``int8``, ``int4`` or ``bin``.
        scale: Of its frame.
        compress: Packed by zstd.
    """

    name: str
    spec: FieldSpec
    storage: str = "fp16"
    scale: float = 1.0
    compress: bool = False


def vectors() -> Iterator[Vector]:
    """Every encoding, every way to store it, every mode, activation and head at least once."""
    grid, planes = _spec(GRID), _spec(PLANES, SphericalHarmonics(3), head="softplus")
    for storage in ("fp16", "fp32", "int8", "int4"):
        yield Vector(f"hash-{storage}", grid, storage, 4.0)
        yield Vector(f"triplane-{storage}", planes, storage)
    yield Vector("hash-int4-packed", grid, "int4", 4.0, compress=True)
    yield Vector("frequency", _spec(Frequency(3, include_identity=True), activation="leaky_relu"))
    yield Vector("one-blob", _spec(OneBlob(5), OneBlob(3), activation="silu"), scale=0.125)
    yield Vector("sh", _spec(SphericalHarmonics(2), SphericalHarmonics(5), activation="gelu"))
    yield Vector("identity", _spec(Identity(), activation="sine"))
    parts = Composite((Identity(), replace(GRID, n_levels=2), Frequency(2)))
    yield Vector("composite-int8", _spec(parts, Composite((Identity(), SphericalHarmonics(2)))), "int8")
    yield Vector("hash-sh1", _coefficients(GRID, "sh1"), scale=2.0)
    yield Vector("triplane-sh2-int8", _coefficients(PLANES, "sh2"), "int8")
    yield Vector("hash-full-levels", _spec(replace(GRID, full_levels=True)))
    yield Vector("hash-bin", grid, "bin")
    yield Vector("triplane-bin", _spec(PLANES), "bin")
    yield Vector("frequency-bin", _spec(Frequency(3, include_identity=True)), "bin")
    yield Vector("triplane-sh1-bin", _coefficients(PLANES, "sh1"), "bin", 2.0)


def make(vector: Vector) -> tuple[str, bytes, dict[str, Any]]:
    """Name of the field's file, its bytes, and what is asked of it and answered."""
    field = _field(vector)
    if vector.storage == "bin":
        name, data = f"{vector.name}.bin", encode_bin(field)
        stored = decode_bin(data)
    else:
        name = f"{vector.name}.safetensors" + (".zst" if vector.compress else "")
        data = encode_field(_stored(field, vector), precision=_precision(vector), compress=vector.compress)
        stored = decode_field(data).field
    return name, data, {"field": name, "scale": stored.frame.scale, **ask(stored)}


def ask(field: Field) -> dict[str, Any]:
    """Questions, and the answers by NumPy."""
    rng = np.random.default_rng(7)
    positions = rng.uniform(BOX[0], BOX[1], (N_QUERIES, 3)).astype(np.float32)
    positions[0], positions[1] = BOX[0], BOX[1]
    positions[2] = BOX[1] + 0.5  # outside: clamped
    normals = fibonacci_sphere(N_QUERIES).astype(np.float32)
    by_numpy = replace(field, backend_name="numpy")
    found = {
        "positions": positions.tolist(),
        "normals": normals.tolist(),
        "irradiance": by_numpy.irradiance(positions, normals).tolist(),
    }
    if field.spec.mode != "irradiance":
        found["coefficients"] = by_numpy.coefficients(positions).tolist()
    return found


def main() -> None:
    """Writes all of them, and takes away what is no longer made."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--out", type=Path, default=FOLDER)
    out = parser.parse_args().out
    out.mkdir(parents=True, exist_ok=True)
    written = {"README.md"}
    for vector in vectors():
        name, data, answers = make(vector)
        (out / name).write_bytes(data)
        text = json.dumps(answers, indent=1)
        (out / f"{vector.name}.json").write_text(text + "\n", encoding="utf-8")
        written |= {name, f"{vector.name}.json"}
    for path in out.iterdir():
        if path.name not in written:
            path.unlink()
    print(f"{len(written) - 1} files, {sum(path.stat().st_size for path in out.iterdir())} bytes in {out}")


def _spec(position: Encoding, direction: Encoding | None = None, **changes: Any) -> FieldSpec:
    return FieldSpec(position, direction or Identity(), width=8, n_hidden_layers=2, **changes)


def _coefficients(position: Encoding, mode: Any) -> FieldSpec:
    return FieldSpec(position, None, width=12, n_hidden_layers=1, head="linear", mode=mode)


def _field(vector: Vector) -> Field:
    """Weights that make every part of a field matter."""
    seed = Seed(11, (vector.name.removesuffix("-packed"),))
    parameters = new_parameters(vector.spec, seed)
    rng = seed.child("more").numpy()
    for name, values in parameters.items():
        if not name.endswith(".weight"):
            parameters[name] = rng.uniform(-0.5, 0.5, values.shape).astype(np.float32)
    return Field(vector.spec, FieldFrame(BOX, vector.scale, "indirect"), parameters)


def _stored(field: Field, vector: Vector) -> Field | QuantisedField:
    match vector.storage:
        case "int8":
            return round_tables(field, 8, 0)
        case "int4":
            return round_tables(field, 4, 32)
    return field


def _precision(vector: Vector) -> Precision:
    return "fp32" if vector.storage == "fp32" else "fp16"


if __name__ == "__main__":
    main()
