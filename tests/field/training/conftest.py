"""Small datasets and fields, so that a training takes a moment."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from irradia.field.encodings import Frequency, Identity
from irradia.field.spec import FieldSpec
from irradia.field.training import Finished, TrainContext, TrainEvent, TrainOptions, train
from irradia.formats.samples import SampleFile, SampleInfo

BOX = ((0.0, 0.0, 0.0), (1.0, 2.0, 1.0))
N_VALUES = {0: 3, 4: 12, 9: 27}


def make_samples(
    n: int = 600, *, seed: int = 0, kind: str = "surface", n_coefficients: int = 0, variance: float = 0.0
) -> SampleFile:
    """Smooth light in a box, with noise of a known variance."""
    rng = np.random.default_rng(seed)
    low, high = np.array(BOX)
    position = low + rng.random((n, 3)) * (high - low)
    normal = rng.standard_normal((n, 3))
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    n_values = N_VALUES[n_coefficients]
    waves = np.sin(position @ rng.normal(size=(3, n_values)) + np.arange(n_values))
    value = 5.0 * (1.5 + waves) + (normal[:, :1] if kind != "sh" else 0.0)
    value = value + rng.standard_normal(value.shape) * np.sqrt(variance)
    columns = [position, *([normal] if kind != "sh" else []), value, np.full((n, 1), variance)]
    info = SampleInfo(kind, BOX, n_coefficients=n_coefficients)
    return SampleFile(Path("box.samples"), info, np.concatenate(columns, axis=1).astype(np.float32))


@pytest.fixture
def samples() -> SampleFile:
    return make_samples()


@pytest.fixture
def make() -> Callable[..., SampleFile]:
    return make_samples


@pytest.fixture
def spec() -> FieldSpec:
    return FieldSpec(Frequency(2), Identity(), width=8, n_hidden_layers=1)


@pytest.fixture
def run(spec) -> Callable[..., list[TrainEvent]]:
    """Trains with NumPy and returns all events."""

    def trained(samples: SampleFile, options: TrainOptions, **context) -> list[TrainEvent]:
        context = {"backend": "numpy", **context}
        field = context.pop("spec", spec)
        return list(train(samples, field, options, TrainContext(**context)))

    return trained


@pytest.fixture
def finished(run) -> Callable[..., Finished]:
    """Trains with NumPy and returns the last event."""

    def last(samples: SampleFile, options: TrainOptions, **context) -> Finished:
        event = run(samples, options, **context)[-1]
        assert isinstance(event, Finished)
        return event

    return last
