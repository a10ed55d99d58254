"""Activations, heads and losses as :mod:`irradia.field` defines them, within a kernel.

CUDA's own sine, tangent and logarithm are approximate where it hurts: the sine far from 0, tanh everywhere
(11 bits), the logarithm near 1. So angles are reduced, tanh is made of exp, and log(1 + x) is a series.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import drjit as dr
import numpy as np

from irradia.core.colour import LUMINANCE_WEIGHTS
from irradia.field.activations import LEAK
from irradia.field.backend import LossName
from irradia.field.heads import EXP_LIMIT
from irradia.field.losses import EPSILON
from irradia.field.spec import ActivationName, Head

F = Any
Function = tuple[Callable[[F], F], Callable[[F], F]]  # value and slope

_GELU_SCALE = math.sqrt(2.0 / math.pi)
_GELU_CUBIC = 0.044715
_TURN = float(np.float32(2.0 * math.pi))
_TURN_REST = 2.0 * math.pi - _TURN


def sigmoid(z: F) -> F:
    """1 / (1 + e^−z), without overflow."""
    small = dr.exp(-dr.abs(z))
    return dr.select(z >= 0.0, 1.0, small) / (1.0 + small)


def log1p_of_unit(x: F) -> F:
    """log(1 + x) for x in [0, 1], as 2 artanh(x / (2 + x)); ten terms give all bits."""
    s = x / (2.0 + x)
    square = s * s
    series = type(x)(0.0)
    for k in reversed(range(10)):
        series = dr.fma(series, square, 1.0 / (2 * k + 1))
    return 2.0 * s * series


def within_a_turn(angle: F) -> F:
    """An angle less its whole turns."""
    turns = dr.round(angle * (1.0 / _TURN))
    return dr.fma(turns, -_TURN_REST, dr.fma(turns, -_TURN, angle))


def _gelu_gate(z: F) -> F:
    """(1 + tanh u) / 2, which is the sigmoid of 2u."""
    return sigmoid(2.0 * _GELU_SCALE * (z + _GELU_CUBIC * z * z * z))


def _gelu_slope(z: F) -> F:
    gate = _gelu_gate(z)
    inner = _GELU_SCALE * (1.0 + 3.0 * _GELU_CUBIC * z * z)
    return gate + 2.0 * z * gate * (1.0 - gate) * inner


def _silu_slope(z: F) -> F:
    gate = sigmoid(z)
    return gate * (1.0 + z * (1.0 - gate))


def _exp(z: F) -> F:
    return dr.exp(dr.clip(z, -EXP_LIMIT, EXP_LIMIT))


def _softplus(z: F) -> F:
    return dr.maximum(z, 0.0) + log1p_of_unit(dr.exp(-dr.abs(z)))


ACTIVATIONS: dict[ActivationName, Function] = {
    "relu": (lambda z: dr.maximum(z, 0.0), lambda z: dr.select(z > 0.0, 1.0, 0.0)),
    "leaky_relu": (lambda z: dr.select(z > 0.0, z, LEAK * z), lambda z: dr.select(z > 0.0, 1.0, LEAK)),
    "silu": (lambda z: z * sigmoid(z), _silu_slope),
    "gelu": (lambda z: z * _gelu_gate(z), _gelu_slope),
    "sine": (lambda z: dr.sin(within_a_turn(z)), lambda z: dr.cos(within_a_turn(z))),
}
HEADS: dict[Head, Function] = {
    "exp": (_exp, _exp),
    "softplus": (_softplus, sigmoid),
    "linear": (lambda z: z, lambda z: type(z)(1.0)),
}


def loss_and_slopes(name: LossName, predictions: list[F], targets: list[F]) -> tuple[F, list[F]]:
    """The sum of a sample's penalties, and half their derivatives, over its outputs."""
    penalty = type(predictions[0])(0.0)
    slopes = []
    weights = _weights(name, predictions)
    for p, t, weight in zip(predictions, targets, weights, strict=True):
        error = _log_error(p, t) if name == "log" else p - t
        penalty += weight * error * error
        slopes.append(error / (p + EPSILON) if name == "log" else weight * error)
    return penalty, slopes


def _weights(name: LossName, predictions: list[F]) -> list[F]:
    """What squared errors are multiplied by."""
    if name == "relative_l2":
        return [1.0 / (p * p + EPSILON) for p in predictions]
    if name == "relative_l2_luminance":
        red, green, blue = (w * p for w, p in zip(LUMINANCE_WEIGHTS, predictions[:3], strict=True))
        luminance = red + green + blue
        return [1.0 / (luminance * luminance + EPSILON)] * len(predictions)
    return [1.0] * len(predictions)


def _log_error(p: F, t: F) -> F:
    return dr.log(p + EPSILON) - dr.log(dr.maximum(t, 0.0) + EPSILON)
