"""Activations, heads and losses on tiles; :mod:`irradia.field` has the definitions beside which these stand.

Names travel as numbers, so that one compiled kernel serves all of them.
"""

from __future__ import annotations

import math
from typing import get_args

from irradia.core.colour import LUMINANCE_WEIGHTS
from irradia.field import activations, heads, losses
from irradia.field.backend import LossName
from irradia.field.backends.numba_compile import inner
from irradia.field.backends.numba_encoding import TILE
from irradia.field.backends.numba_math import exp8, log8, sin_cos8
from irradia.field.backends.numba_vector import absolute, lane, load8, select, splat8, store8
from irradia.field.spec import ActivationName, Head

# How much of a sum below 0 goes through, for activations that are straight on either side of 0.
LEAKS: dict[ActivationName, float] = {"relu": 0.0, "leaky_relu": activations.LEAK}
CURVES: tuple[ActivationName, ...] = ("silu", "gelu", "sine")  # by their numbers
STRAIGHT = -1  # the number of those in LEAKS
_SILU, _GELU, _SINE = range(len(CURVES))
HEADS: tuple[Head, ...] = ("exp", "softplus", "linear")
_EXP, _SOFTPLUS, _LINEAR = range(len(HEADS))
LOSSES: tuple[LossName, ...] = get_args(LossName)
_RELATIVE, _LUMINANCE, _L2, _LOG = (
    LOSSES.index(name) for name in ("relative_l2", "relative_l2_luminance", "l2", "log")
)

_GELU_SCALE, _GELU_CUBIC = math.sqrt(2.0 / math.pi), 0.044715
_EXP_LIMIT = heads.EXP_LIMIT
_EPSILON = losses.EPSILON
_RED, _GREEN, _BLUE = (float(weight) for weight in LUMINANCE_WEIGHTS)


# --- activations -----------------------------------------------------------------------------------------


@inner
def bend(tile, slopes, n_rows, curve):
    """Applies a curved activation to a tile and writes its slopes, which backward multiplies by."""
    for i in range(n_rows):
        for s in range(0, TILE, 8):
            z = load8(tile, (i, s))
            if curve == _SINE:
                value, slope = sin_cos8(z)
            else:
                value, slope = _gated(z, curve == _GELU)
            store8(tile, (i, s), value)
            store8(slopes, (i, s), slope)


@inner
def _gated(z, is_gelu):
    """Value and slope of z · sigmoid(u): u is z in SiLU; GELU's (1 + tanh(v)) / 2 is sigmoid(2 v)."""
    u, du = z, splat8(1.0)
    if is_gelu:
        z2 = z * z
        u = (2.0 * _GELU_SCALE) * z * (1.0 + _GELU_CUBIC * z2)
        du = (2.0 * _GELU_SCALE) * (1.0 + (3.0 * _GELU_CUBIC) * z2)
    gate = sigmoid8(u)
    return z * gate, gate * (1.0 + z * du * (1.0 - gate))


@inner
def sigmoid8(z):
    """1 / (1 + e^−z), as exact for large z as for small."""
    small = exp8(0.0 - absolute(z))
    return select(z > 0.0, splat8(1.0), small) / (1.0 + small)


@inner
def multiply_tiles(tile, factors, n_rows):
    """Multiplies a tile by another, element by element."""
    for i in range(n_rows):
        for s in range(0, TILE, 8):
            store8(tile, (i, s), load8(tile, (i, s)) * load8(factors, (i, s)))


# --- heads -----------------------------------------------------------------------------------------------


@inner
def head8(z, head):
    """Output and slope of a head."""
    value, slope = z, splat8(1.0)
    if head == _EXP:
        value = exp8(select(z > _EXP_LIMIT, _EXP_LIMIT, select(z < -_EXP_LIMIT, -_EXP_LIMIT, z)))
        slope = value
    elif head == _SOFTPLUS:
        value = select(z < 0.0, 0.0, z) + _log_of_1_plus(exp8(0.0 - absolute(z)))
        slope = sigmoid8(z)
    return value, slope


@inner
def _log_of_1_plus(u):
    """ln(1 + u) for u from 0 to 1; what 1 + u loses of a small u is made up for."""
    sum_ = 1.0 + u
    kept = sum_ - 1.0
    return select(kept > 0.0, log8(sum_) * (u / kept), u)


# --- losses ----------------------------------------------------------------------------------------------


@inner
def transpose_target(target, first, count, tile):
    """Target samples (N, C) from ``first`` on into rows 0 to C − 1 of a tile; row C says which are there.

    It holds 1 for the ``count`` samples of the batch, and 0 for those that fill up its last tile.
    """
    n_outputs = target.shape[1]
    for s in range(count):
        for c in range(n_outputs):
            tile[c, s] = target[first + s, c]
        tile[n_outputs, s] = 1.0
    for s in range(count, TILE):
        for c in range(n_outputs + 1):
            tile[c, s] = 0.0


@inner
def loss_and_delta(raw, target, n_outputs, head, loss, gradient_scale):
    """Sum of a tile's loss; the raw outputs become its gradient with respect to them.

    Args:
        raw: Tile with the outputs before the head.
        target: Tile from :func:`transpose_target`.
        n_outputs: C.
        head, loss: By number.
        gradient_scale: 2 / (N · C), from the mean of squares.
    """
    total = splat8(0.0)
    for s in range(0, TILE, 8):
        there = load8(target, (n_outputs, s))
        weight = splat8(1.0)
        if loss == _LUMINANCE:
            weight = _relative(_luminance(raw, s, head))
        for c in range(n_outputs):
            t = load8(target, (c, s))
            p, slope = head8(load8(raw, (c, s)), head)
            if loss == _LOG:
                error = log8(p + _EPSILON) - log8(select(t > 0.0, t, 0.0) + _EPSILON)
                slope = slope / (p + _EPSILON)
            else:
                error = p - t
            if loss == _RELATIVE:
                weight = _relative(p)
            error = there * error
            total = total + weight * error * error
            store8(raw, (c, s), gradient_scale * weight * error * slope)
    sum_ = 0.0
    for i in range(8):
        sum_ += lane(total, i)
    return sum_


@inner
def _relative(p):
    """What relative losses multiply a squared error by."""
    return 1.0 / (p * p + _EPSILON)


@inner
def _luminance(raw, s, head):
    red, _ = head8(load8(raw, (0, s)), head)
    green, _ = head8(load8(raw, (1, s)), head)
    blue, _ = head8(load8(raw, (2, s)), head)
    return _RED * red + _GREEN * green + _BLUE * blue
