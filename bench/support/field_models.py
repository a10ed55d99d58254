"""The fields that the benchmark trains, and the data that both sides are given."""

from __future__ import annotations

from dataclasses import asdict, dataclass

import numpy as np

from irradia.core.rng import Seed
from irradia.field.backend import AdamOptions, StepOptions
from irradia.field.encodings.frequency import Frequency
from irradia.field.encodings.hash_grid import HashGrid
from irradia.field.encodings.identity import Identity
from irradia.field.encodings.tri_plane import TriPlane
from irradia.field.init import new_parameters
from irradia.field.registry import spec_to_dict
from irradia.field.spec import FieldSpec
from peers.field_worker import Task


@dataclass(frozen=True)
class Model:
    """One row of the benchmark.

    Attributes:
        name: In the table.
        spec: The architecture.
        wanted: How many times the peer's training speed it should reach; None where none was set.
        own_backward: Whether the peer's tables get a gradient written for them, instead of PyTorch's.
    """

    name: str
    spec: FieldSpec
    wanted: float | None = None
    own_backward: bool = False


_HASH_16 = FieldSpec(HashGrid(16, 19, 2, 16, 2048), Identity(), width=64, n_hidden_layers=2)
_HASH_8 = FieldSpec(HashGrid(8, 17, 2, 16, 512), width=32, n_hidden_layers=2, head="linear", mode="sh1")

MODELS = {
    "hash-16x19": Model("hash 16 × 2^19, 64×2", _HASH_16, wanted=10.0),
    "hash-8x17": Model("hash 8 × 2^17, 32×2, SH", _HASH_8, wanted=12.0),
    "triplane": Model(
        "tri-plane 128² × 16, 64×2, SH",
        FieldSpec(TriPlane(128, 16), width=64, n_hidden_layers=2, head="linear", mode="sh1"),
        wanted=2.5,
    ),
    "frequency": Model(
        "frequency 10, 64×2",
        FieldSpec(Frequency(10), Identity(), width=64, n_hidden_layers=2),
        wanted=2.5,
    ),
    "hash-16x19-own": Model("hash 16 × 2^19, peer's own backward", _HASH_16, own_backward=True),
    "hash-8x17-own": Model("hash 8 × 2^17, peer's own backward", _HASH_8, own_backward=True),
}

RATES = {"encoding": 1e-2, "network": 1e-3}


def step_options(average: float) -> StepOptions:
    """What both sides do in a step.

    PyTorch's Adam moves every value of a table; ours would leave those alone that no sample met, which
    is other arithmetic, not faster code. So here it moves all.
    """
    adam = AdamOptions(epsilon=1e-15, skip_zero=False)
    return StepOptions(loss="relative_l2", encoding_adam=adam, average=average)


def make_task(
    model: Model,
    *,
    batch: int,
    n_batches: int,
    average: float,
    seed: Seed,
    threads: int,
    device: str,
) -> Task:
    """Random points and normals with a smooth target, and parameters to start from.

    Points are uniform in the cube, so that caches help either side as little as they can.
    """
    spec = model.spec
    rng = seed.child("samples").numpy()
    x = rng.random((n_batches, batch, 3), dtype=np.float32)
    normal = rng.standard_normal((n_batches, batch, 3), dtype=np.float32)
    normal /= np.linalg.norm(normal, axis=-1, keepdims=True)
    options = step_options(average)
    settings = {
        "spec": spec_to_dict(spec),
        "batch": batch,
        "loss": options.loss,
        "rates": RATES,
        "encoding_adam": asdict(options.encoding_adam),
        "network_adam": asdict(options.network_adam),
        "average": average,
        "own_backward": model.own_backward,
        "threads": threads,
        "device": device,
    }
    return Task(
        settings=settings,
        parameters=new_parameters(spec, seed.child("init")),
        x=x,
        normal=normal if spec.direction is not None else None,
        target=_target(x, normal, spec.n_outputs),
    )


def _target(x: np.ndarray, normal: np.ndarray, n_outputs: int) -> np.ndarray:
    """Positive, of every frequency that a small room has, and different in each output."""
    wave = np.arange(1, n_outputs + 1, dtype=np.float32)
    light = 1.0 + 0.5 * np.sin(4.0 * x[..., :1] * wave) * np.cos(3.0 * x[..., 1:2] + wave)
    facing = 1.0 + 0.5 * normal[..., 1:2] * x[..., 2:]
    return (light * facing).astype(np.float32)
