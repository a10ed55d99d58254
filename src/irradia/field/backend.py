"""What runs and trains a field: NumPy defines the numbers, other backends are registered speed.

A backend gets a spec and arrays and gives back arrays, so trainers, evaluation and files are the same
for all. :mod:`irradia.field.backends` lists them and finds the fastest that can.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass, field
from typing import ClassVar, Literal

import numpy as np
from numpy.typing import NDArray

from irradia.field.spec import FieldSpec

F32 = NDArray[np.float32]
Parameters = dict[str, F32]  # by the names of FieldSpec.parameter_shapes()
LossName = Literal["relative_l2", "relative_l2_luminance", "l2", "log"]


@dataclass(frozen=True)
class Batch:
    """Samples of one training step.

    Attributes:
        x: (N, 3) positions in [0, 1]³.
        normal: (N, 3) unit; None in SH modes.
        target: (N, n_outputs) in units of the frame's scale.
    """

    x: F32
    normal: F32 | None
    target: F32

    def __len__(self) -> int:
        return len(self.x)


@dataclass(frozen=True)
class AdamOptions:
    """Adam (Kingma and Ba 2015).

    Attributes:
        beta1, beta2, epsilon: As in the paper.
        skip_zero: Values whose gradient is exactly 0 are left alone, moments too: most entries of a table
            are met by no sample of a batch.
    """

    beta1: float = 0.9
    beta2: float = 0.99
    epsilon: float = 1e-8
    skip_zero: bool = False


@dataclass(frozen=True)
class StepOptions:
    """What stays the same over a training.

    Attributes:
        loss: See :mod:`irradia.field.losses`.
        encoding_adam, network_adam: Settings of each kind of parameters.
        average: Decay of the running mean of parameters, from which inference takes its own; 0 keeps none.
        frozen: Names of parameters that don't learn.
    """

    loss: LossName = "relative_l2"
    encoding_adam: AdamOptions = field(default_factory=lambda: AdamOptions(epsilon=1e-15, skip_zero=True))
    network_adam: AdamOptions = field(default_factory=AdamOptions)
    average: float = 0.99
    frozen: frozenset[str] = frozenset()


@dataclass(frozen=True)
class Rates:
    """Learning rates of one step."""

    encoding: float
    network: float


@dataclass(frozen=True)
class TrainState:
    """Everything that a training needs to go on, on the host.

    Attributes:
        parameters: As trained.
        average: Running means, not yet de-biased (divide by 1 − decay^step); empty where none are kept.
        first, second: Adam's moments.
        step: Steps done.
    """

    parameters: Parameters
    average: Parameters
    first: Parameters
    second: Parameters
    step: int


class Evaluator(ABC):
    """A field's network with its parameters in place."""

    @abstractmethod
    def __call__(self, x: F32, normal: F32 | None) -> F32:
        """Outputs (N, n_outputs) after the head, in units of the frame's scale.

        Args:
            x: (N, 3) in [0, 1]³.
            normal: (N, 3) unit; None in SH modes.
        """


class Stepper(ABC):
    """A training in progress; it owns the parameters until :meth:`state` copies them out."""

    @abstractmethod
    def step(self, batch: Batch, rates: Rates) -> float:
        """One step of forward, backward, Adam and running mean; returns the loss before it."""

    @abstractmethod
    def state(self) -> TrainState:
        """A copy of everything."""


class Backend(ABC):
    """One way to compute fields.

    Attributes:
        name: On the command line.
    """

    name: ClassVar[str]

    @abstractmethod
    def lacks(self, spec: FieldSpec) -> str | None:
        """What of a spec it can't do, in words; None where it can do all."""

    @abstractmethod
    def evaluator(self, spec: FieldSpec, parameters: Parameters) -> Evaluator:
        """Makes ready to evaluate."""

    @abstractmethod
    def stepper(self, spec: FieldSpec, state: TrainState, options: StepOptions) -> Stepper:
        """Makes ready to train; the state is copied."""
