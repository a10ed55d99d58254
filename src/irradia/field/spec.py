"""What a field is made of, and what scene it was trained for: all that isn't a weight."""

from __future__ import annotations

import itertools
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from irradia.core.errors import InputError
from irradia.field.encoding import Encoding

Mode = Literal["irradiance", "sh1", "sh2"]
Head = Literal["exp", "softplus", "linear"]
ActivationName = Literal["relu", "leaky_relu", "silu", "gelu", "sine"]
Quantity = Literal["full", "indirect"]

N_OUTPUTS: dict[Mode, int] = {"irradiance": 3, "sh1": 12, "sh2": 27}


@dataclass(frozen=True)
class FieldSpec:
    """An architecture: features of position and normal, then a perceptron.

    Attributes:
        position: Of points in the field's box, which is mapped to [0, 1]³.
        direction: Of the unit normal; its features follow those of position. None in SH modes, where
            the normal comes in only when coefficients are evaluated.
        width: Of each hidden layer.
        n_hidden_layers: So there are ``n_hidden_layers + 1`` matrices, each with a bias.
        activation: Of hidden layers.
        head: Of the outputs. Coefficients of SH have signs, so theirs is ``linear``.
        mode: What comes out: E in RGB, or SH coefficients of radiance, (coefficient, channel) flattened.
    """

    position: Encoding
    direction: Encoding | None = None
    width: int = 64
    n_hidden_layers: int = 2
    activation: ActivationName = "relu"
    head: Head = "exp"
    mode: Mode = "irradiance"

    def __post_init__(self) -> None:
        if not (1 <= self.n_hidden_layers <= 6 and 1 <= self.width <= 128):
            found = f"{self.n_hidden_layers} layers of {self.width}"
            raise InputError(f"expected 1 to 6 hidden layers of 1 to 128 units, found {found}")
        if (self.direction is None) != (self.mode != "irradiance"):
            raise InputError("irradiance needs the normal, and SH coefficients don't depend on it")
        if self.mode != "irradiance" and self.head != "linear":
            raise InputError(f"SH coefficients have signs, so their head is linear, not {self.head}")

    @property
    def n_inputs(self) -> int:
        """Features that enter the perceptron."""
        return self.position.n_outputs + (self.direction.n_outputs if self.direction else 0)

    @property
    def n_outputs(self) -> int:
        """Values that leave it."""
        return N_OUTPUTS[self.mode]

    def layer_shapes(self) -> list[tuple[int, int]]:
        """(out, in) of each matrix."""
        widths = [self.n_inputs, *[self.width] * self.n_hidden_layers, self.n_outputs]
        return [(out, into) for into, out in itertools.pairwise(widths)]

    def parameter_shapes(self) -> dict[str, tuple[int, ...]]:
        """Every array of parameters by name; encodings are flat, and absent where they have none."""
        shapes: dict[str, tuple[int, ...]] = {}
        for name, encoding in (("position", self.position), ("direction", self.direction)):
            if encoding is not None and encoding.n_parameters:
                shapes[name] = (encoding.n_parameters,)
        for i, (out, into) in enumerate(self.layer_shapes()):
            shapes[f"mlp.{i}.weight"] = (out, into)
            shapes[f"mlp.{i}.bias"] = (out,)
        return shapes

    @property
    def n_parameters(self) -> int:
        """Of encodings and perceptron together."""
        return sum(int(np.prod(shape)) for shape in self.parameter_shapes().values())


@dataclass(frozen=True)
class FieldFrame:
    """How a field's numbers relate to a scene.

    Attributes:
        aabb: (2, 3) float32 minimum and maximum, metres: the box mapped to [0, 1]³.
        scale: Power of two; the network's outputs times this are E in W·m⁻² (or coefficients of radiance).
        quantity: ``indirect`` leaves out the first bounce of punctual lights; see docs/conventions.md.
    """

    aabb: NDArray[np.float32]
    scale: float = 1.0
    quantity: Quantity = "full"

    def to_unit(self, positions: NDArray[np.float32]) -> NDArray[np.float32]:
        """Positions (N, 3) in metres to [0, 1]³; what lies outside the box is clamped to it."""
        low, high = self.aabb
        extent = np.maximum(high - low, np.float32(1e-12))
        return np.clip((positions - low) / extent, np.float32(0.0), np.float32(1.0))
