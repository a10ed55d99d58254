"""What makes a network's raw outputs light: value and slope."""

from __future__ import annotations

import numpy as np

from irradia.field.activations import Activation, sigmoid
from irradia.field.encoding import Array
from irradia.field.spec import Head

EXP_LIMIT = 15.0  # raw outputs beyond ± this are clamped: e^±15 are 3e6 and 3e-7 of the frame's scale


def _exp(z: Array) -> Array:
    """Clamped in value; its slope stays the value, so that an output that went too far can come back."""
    return np.exp(np.clip(z, -EXP_LIMIT, EXP_LIMIT))


def _softplus(z: Array) -> Array:
    return np.maximum(z, 0.0) + np.log1p(np.exp(-np.abs(z)))


HEADS: dict[Head, Activation] = {
    "exp": Activation(_exp, _exp),
    "softplus": Activation(_softplus, sigmoid),
    "linear": Activation(lambda z: z, np.ones_like),
}

POSITIVE_HEADS: frozenset[Head] = frozenset({"exp", "softplus"})
