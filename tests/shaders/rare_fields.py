"""Fields whose tables lie in textures as those of vectors/ don't: narrow and wide entries, odd hashes."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from irradia.core.rng import Seed
from irradia.field.encoding import Encoding
from irradia.field.encodings import Composite, Frequency, HashGrid, Identity, SphericalHarmonics, TriPlane
from irradia.field.field import Field
from irradia.field.init import new_parameters
from irradia.field.native_fields import decode_field, encode_field
from irradia.field.quantise import round_tables
from irradia.field.spec import FieldFrame, FieldSpec

from .cases import Case, made_questions

AABB = np.array([[-1, 0, 0.5], [1, 2.25, 4.5]], np.float32)
N_QUESTIONS = 100
IDENTITY = Identity()
GRID = HashGrid(n_levels=3, log2_table_size=6, base_resolution=3, max_resolution=9)


@dataclass(frozen=True)
class RareField:
    """What is rare of it.

    Attributes:
        position: Encoding.
        bits: Of a value in its tables: codes, half floats or floats.
        block: Values that share a scale; 0 gives each level or plane one.
        direction: Encoding of the normal.
        max_size: Of the device's textures, where that is less than usual; constants are uniforms then.
    """

    position: Encoding
    bits: int = 16
    block: int = 0
    direction: Encoding = IDENTITY
    max_size: int | None = None


RARE: dict[str, RareField] = {
    "two-entries-in-a-word": RareField(replace(GRID, n_features=1)),
    "eight-entries-in-a-word": RareField(replace(GRID, n_features=1), bits=4),
    "padded-entries": RareField(replace(GRID, n_features=3), bits=8),
    "entries-of-four-texels": RareField(replace(GRID, n_features=16), bits=32),
    "planes-of-three-texels-an-entry": RareField(TriPlane(5, 40, align_corners=True)),
    "planes-with-entries-below-a-word": RareField(TriPlane(5, 1), bits=4),
    "tables-of-no-power-of-two": RareField(
        replace(GRID, hash_all=True, log2_table_size=12, base_resolution=6)
    ),
    "all-levels-hashed": RareField(replace(GRID, hash_all=True), bits=8),
    "floors": RareField(replace(GRID, convention="floor", max_resolution=30)),
    "other-factors": RareField(replace(GRID, primes=(3674653429, 2654435761, 805459861))),
    "fine-levels": RareField(
        HashGrid(n_levels=3, log2_table_size=12, base_resolution=16, max_resolution=4096)
    ),
    "levels-in-several-layers": RareField(GRID, max_size=8),
    "blocks-of-entries": RareField(GRID, bits=8, block=16),
    "blocks-in-planes": RareField(TriPlane(4, 4), bits=4, block=32),
    "blocks-that-cut-entries": RareField(GRID, bits=8, block=7),
    "blocks-across-planes": RareField(TriPlane(5, 4), bits=4, block=32),
    "several-tables": RareField(
        Composite((GRID, TriPlane(6, 8), Composite((replace(GRID, n_features=4), IDENTITY)))),
        bits=8,
        direction=Composite((replace(GRID, n_features=1), SphericalHarmonics(2))),
    ),
    "high-frequencies": RareField(Frequency(24, include_identity=True), direction=SphericalHarmonics(5)),
}


def rare_cases(folder: Path) -> Iterator[Case]:
    """All of them as files, with the NumPy reference's answers; the corners of the box are asked too."""
    low, high = AABB
    asked = made_questions(N_QUESTIONS, low - 0.1, high + 0.1)
    asked.position[:2] = AABB
    for name, rare in RARE.items():
        file = folder / f"{name}.safetensors"
        file.write_bytes(_encoded(rare))
        field = replace(decode_field(file.read_bytes()).field, backend_name="numpy")
        expected = field.irradiance(asked.position, asked.normal)
        uniform_bytes = None if rare.max_size else 0
        light = np.asarray(expected, np.float64)
        yield Case(name, file, "field", asked, light, None, uniform_bytes, rare.max_size)


def _encoded(rare: RareField) -> bytes:
    spec = FieldSpec(rare.position, rare.direction, width=16, n_hidden_layers=1)
    parameters = new_parameters(spec, Seed(7))
    for owner in ("position", "direction"):
        if owner in parameters:
            values = Seed(7).child(f"{owner}.values").numpy().uniform(-0.5, 0.5, parameters[owner].shape)
            parameters[owner] = values.astype(np.float32)
    field = Field(spec, FieldFrame(AABB, 2.0, "full"), parameters)
    if rare.bits in (4, 8):
        return encode_field(round_tables(field, rare.bits, rare.block))
    return encode_field(field, precision="fp32" if rare.bits == 32 else "fp16")
