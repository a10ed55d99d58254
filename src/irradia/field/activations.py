"""Activations of hidden layers: value and slope."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from irradia.field.encoding import Array
from irradia.field.spec import ActivationName

LEAK = 0.01  # slope of leaky ReLU below 0
_GELU_SCALE = math.sqrt(2.0 / math.pi)
_GELU_CUBIC = 0.044715


@dataclass(frozen=True)
class Activation:
    """A function of one variable.

    Attributes:
        value: f(z).
        slope: f′(z).
    """

    value: Callable[[Array], Array]
    slope: Callable[[Array], Array]


def sigmoid(z: Array) -> Array:
    """1 / (1 + e^−z), without overflow on either side."""
    small = np.exp(-np.abs(z))
    return np.where(z >= 0.0, 1.0, small) / (1.0 + small)


def _leaky_slope(z: Array) -> Array:
    return np.where(z > 0.0, 1.0, LEAK).astype(z.dtype)


def _silu_slope(z: Array) -> Array:
    gate = sigmoid(z)
    return gate * (1.0 + z * (1.0 - gate))


def _gelu_gate(z: Array) -> Array:
    return np.tanh(_GELU_SCALE * (z + _GELU_CUBIC * z * z * z))


def _gelu_slope(z: Array) -> Array:
    gate = _gelu_gate(z)
    inner = _GELU_SCALE * (1.0 + 3.0 * _GELU_CUBIC * z * z)
    return 0.5 * (1.0 + gate) + 0.5 * z * (1.0 - gate * gate) * inner


ACTIVATIONS: dict[ActivationName, Activation] = {
    "relu": Activation(lambda z: np.maximum(z, 0.0), lambda z: (z > 0.0).astype(z.dtype)),
    "leaky_relu": Activation(lambda z: _leaky_slope(z) * z, _leaky_slope),
    "silu": Activation(lambda z: z * sigmoid(z), _silu_slope),
    # The tanh form of Hendrycks and Gimpel 2016: shading languages have no error function.
    "gelu": Activation(lambda z: 0.5 * z * (1.0 + _gelu_gate(z)), _gelu_slope),
    # Frequencies of Sitzmann et al. 2020 are in the first weights (see init.py), so this is the bare sine.
    "sine": Activation(np.sin, np.cos),
}
