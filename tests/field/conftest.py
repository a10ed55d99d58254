"""Small encodings and random points for laws that hold for everything registered."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from irradia.core.sh import fibonacci_sphere
from irradia.field.backend import Batch
from irradia.field.encoding import Encoding
from irradia.field.encodings import Composite, Frequency, HashGrid, Identity, TriPlane
from irradia.field.registry import ENCODINGS
from irradia.field.spec import FieldSpec

# Where the defaults are too large for finite differences; others are tested with their defaults.
SMALL: dict[str, Encoding] = {
    "hash": HashGrid(n_levels=3, log2_table_size=6, base_resolution=3, max_resolution=11),
    "triplane": TriPlane(resolution=5, n_features=2),
    "frequency": Frequency(n_frequencies=3, include_identity=True),
    "composite": Composite((TriPlane(3, 1), Identity(), HashGrid(2, 4, 1, 2, 4), Frequency(2))),
}


@pytest.fixture
def rng() -> np.random.Generator:
    return np.random.default_rng(20)


@pytest.fixture(params=list(ENCODINGS))
def small_encoding(request: pytest.FixtureRequest) -> Encoding:
    """One of every registered encoding."""
    return SMALL.get(request.param) or ENCODINGS[request.param]()


@pytest.fixture
def small_encodings() -> dict[str, Encoding]:
    return SMALL


@pytest.fixture
def make_batch(rng: np.random.Generator) -> Callable[..., Batch]:
    """Random points with targets above 0: ``make_batch(spec, n)``."""

    def make(spec: FieldSpec, n: int = 16) -> Batch:
        x = rng.random((n, 3), np.float32)
        normal = fibonacci_sphere(n).astype(np.float32) if spec.direction else None
        return Batch(x, normal, rng.uniform(0.1, 2.0, (n, spec.n_outputs)).astype(np.float32))

    return make
