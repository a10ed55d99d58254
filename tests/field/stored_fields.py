"""Fields of no meaning whose numbers half floats hold exactly, so that files give back the same."""

from __future__ import annotations

import numpy as np

from irradia.core.sh import fibonacci_sphere
from irradia.field.encoding import Encoding
from irradia.field.encodings import Frequency, HashGrid, Identity, TriPlane
from irradia.field.field import Field
from irradia.field.spec import FieldFrame, FieldSpec

BOX = np.array([(-1.0, 0.0, 0.5), (1.0, 2.0, 4.5)], np.float32)
GRID = HashGrid(n_levels=3, log2_table_size=7, base_resolution=3, max_resolution=11)
PLANES = TriPlane(resolution=5, n_features=3)
WAVES = Frequency(n_frequencies=3, include_identity=True)


def exact(*shape: int) -> np.ndarray:
    """Numbers of no pattern between −0.75 and 0.82, each a multiple of 1/64."""
    size = int(np.prod(shape))
    return (((np.arange(size) * 37 + 11) % 101).reshape(shape) / 64 - 0.75).astype(np.float32)


def made(
    encoding: Encoding = WAVES, mode: str = "irradiance", scale: float = 1.0, width: int = 8, layers: int = 2
) -> Field:
    lit = mode == "irradiance"
    spec = FieldSpec(
        encoding,
        Identity() if lit else None,
        width=width,
        n_hidden_layers=layers,
        head="exp" if lit else "linear",
        mode=mode,  # type: ignore[arg-type]
    )
    parameters = {
        name: exact(*shape) / (4 if name.startswith("mlp.") else 1)
        for name, shape in spec.parameter_shapes().items()
    }
    return Field(spec, FieldFrame(BOX, scale, "indirect"), parameters, "numpy")


def places(n: int = 40) -> tuple[np.ndarray, np.ndarray]:
    """Positions in the box and unit normals."""
    rng = np.random.default_rng(3)
    positions = rng.uniform(BOX[0], BOX[1], (n, 3)).astype(np.float32)
    return positions, fibonacci_sphere(n).astype(np.float32)


def light(field: Field) -> np.ndarray:
    """E at the places, computed by NumPy."""
    return Field(field.spec, field.frame, field.parameters, "numpy").irradiance(*places())


def assert_same(found: Field, expected: Field) -> None:
    assert found.spec == expected.spec
    np.testing.assert_array_equal(found.frame.aabb, expected.frame.aabb)
    assert (found.frame.scale, found.frame.quantity) == (expected.frame.scale, expected.frame.quantity)
    for name, values in expected.parameters.items():
        np.testing.assert_array_equal(found.parameters[name], values)
