"""Losses: the mean over samples and outputs of a penalty, and its gradient.

With p the prediction, t the target and ε = 0.01:

- ``relative_l2``: (p − t)² / (p² + ε). The gradient takes the denominator as constant (Lehtinen et al. 2018),
  so noise in t doesn't shift what is learnt.
- ``relative_l2_luminance``: (p − t)² / (Y² + ε), constant likewise (Müller et al. 2021). Y is the Rec.709
  luminance of a sample's first three outputs: of E, or in SH modes of the L0 coefficient, which is never
  negative for real light and weighs all coefficients of a sample alike.
- ``l2``: (p − t)².
- ``log``: (ln(p + ε) − ln(max(t, 0) + ε))², for heads that are positive. It learns a noisy target's geometric
  mean, which is too dark: for converged targets only.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import get_args

import numpy as np

from irradia.core.colour import LUMINANCE_WEIGHTS
from irradia.core.errors import InputError
from irradia.core.names import did_you_mean
from irradia.field.backend import LossName
from irradia.field.encoding import Array
from irradia.field.heads import POSITIVE_HEADS
from irradia.field.spec import FieldSpec

EPSILON = 0.01


def loss_and_gradient(name: LossName, prediction: Array, target: Array) -> tuple[float, Array]:
    """The mean loss, and its gradient (N, C) with respect to ``prediction`` (N, C)."""
    if name == "log":
        shifted = prediction + EPSILON
        error = np.log(shifted) - np.log(np.maximum(target, 0.0) + EPSILON)
        return _mean(error * error), 2.0 / error.size * error / shifted
    weight = WEIGHTS[name](prediction)
    error = prediction - target
    return _mean(weight * error * error), 2.0 / error.size * weight * error


def check_loss(name: LossName, spec: FieldSpec) -> None:
    """Refuses a loss that doesn't exist or can't go with a spec.

    Raises:
        InputError: Saying what goes.
    """
    if name not in get_args(LossName):
        raise InputError(f"unknown loss {name!r}", where="loss", fix=did_you_mean(name, get_args(LossName)))
    if name == "log" and spec.head not in POSITIVE_HEADS:
        raise InputError(
            f"the log loss needs outputs above zero, and the head {spec.head!r} may give less",
            where="loss",
            fix="Use the head exp or softplus, or the loss relative_l2.",
        )


def _mean(values: Array) -> float:
    return float(values.mean(dtype=np.float64))


def _relative(prediction: Array) -> Array:
    return 1.0 / (prediction * prediction + EPSILON)


def _relative_to_luminance(prediction: Array) -> Array:
    luminance = prediction[:, :3] @ np.array(LUMINANCE_WEIGHTS, prediction.dtype)
    return _relative(luminance)[:, None]


# What a squared error is multiplied by; constant where gradients are taken.
WEIGHTS: dict[LossName, Callable[[Array], Array]] = {
    "relative_l2": _relative,
    "relative_l2_luminance": _relative_to_luminance,
    "l2": np.ones_like,
}
