"""What an encoding is: the readable definition that every faster version is held to."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass, fields
from math import prod
from typing import Any, ClassVar, Literal

import numpy as np
from numpy.typing import NDArray

Array = NDArray[Any]  # float32 in use, float64 where gradients are tested
Domain = Literal["cube", "any"]


@dataclass(frozen=True)
class TensorSlot:
    """A named part of an encoding's parameters, as files store it.

    Attributes:
        name: Within the encoding, such as ``table``.
        shape: Its axes; row-major in the flat array.
    """

    name: str
    shape: tuple[int, ...]

    @property
    def size(self) -> int:
        """Number of values."""
        return prod(self.shape)


@dataclass(frozen=True)
class Encoding(ABC):
    """Turns points into features. A subclass is a frozen dataclass whose fields are its spec.

    Parameters are one flat array, so that optimisers, files and kernels need to know nothing of them;
    :meth:`tensors` names its parts. Positions come in [0, 1]³, normals as unit vectors.

    Attributes:
        name: In specs, files and on the command line.
        domain: ``cube`` wants its inputs in [0, 1], so normals come as (n + 1) / 2; ``any`` takes both
            as they are.
    """

    name: ClassVar[str]
    domain: ClassVar[Domain] = "cube"

    @property
    @abstractmethod
    def n_outputs(self) -> int:
        """Features a point."""

    def tensors(self) -> tuple[TensorSlot, ...]:
        """The parts of the parameters, in order; none where there is nothing to learn."""
        return ()

    @property
    def n_parameters(self) -> int:
        """Length of the flat array of parameters."""
        return sum(slot.size for slot in self.tensors())

    def init(self, rng: np.random.Generator) -> NDArray[np.float32]:
        """Parameters (P,) to start from."""
        del rng
        if self.n_parameters:
            raise NotImplementedError(f"{type(self).__name__} has parameters and must say how they start")
        return np.zeros(0, np.float32)

    @abstractmethod
    def forward(self, x: Array, parameters: Array) -> Array:
        """Features (N, n_outputs) of points (N, 3), in the parameters' precision."""

    def backward(self, x: Array, parameters: Array, gradient: Array) -> Array:
        """Gradient (P,) of a loss whose gradient with respect to the features is (N, n_outputs)."""
        del x, gradient
        return np.zeros_like(parameters)

    def cost(self) -> tuple[int, int] | None:
        """Operations, and parameters read, of one query; None where nobody has counted them."""
        return None

    def spec(self) -> dict[str, Any]:
        """Plain values that :func:`irradia.field.registry.encoding_from_spec` makes it from again."""
        return {"type": self.name, **{f.name: getattr(self, f.name) for f in fields(self)}}
