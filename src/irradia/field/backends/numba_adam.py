"""Adam and the running mean in one sweep over memory; :mod:`irradia.field.adam` says what they compute.

The sweep is bound by memory: it reads and writes four values for every parameter, so it also zeroes the
gradient it has used.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from irradia.field.backend import F32, AdamOptions
from irradia.field.backends.numba_compile import inner
from irradia.field.backends.numba_vector import load8, select, splat8, square_root, store8
from irradia.field.backends.numba_vector_type import LANES


class Learned(NamedTuple):
    """Parameters that learn, (P,) each; no running mean, (0,), where none is kept."""

    value: F32
    first: F32
    second: F32
    mean: F32

    def part(self, first: int, stop: int) -> Learned:
        """A range of them, in the same memory."""
        return Learned(*(array[first:stop] for array in self))


class Adam(NamedTuple):
    """What one step multiplies by; bias correction is in it.

    Attributes:
        rate: Learning rate / (1 − β1^step).
        beta1, beta2: Decays of the moments.
        root: √(1 / (1 − β2^step)), by which √second is multiplied.
        epsilon: Added to the denominator.
        mean_decay: Of the running mean; 0 where none is kept.
        skip_zero: Whether values without gradient stay as they are.
    """

    rate: np.float32
    beta1: np.float32
    beta2: np.float32
    root: np.float32
    epsilon: np.float32
    mean_decay: np.float32
    skip_zero: bool


def adam_of_step(options: AdamOptions, step: int, rate: float, mean_decay: float) -> Adam:
    """Adam for one step, counted from 1."""
    numbers = (
        rate / (1.0 - options.beta1**step),
        options.beta1,
        options.beta2,
        (1.0 - options.beta2**step) ** -0.5,
        options.epsilon,
        mean_decay,
    )
    return Adam(*(np.float32(number) for number in numbers), skip_zero=bool(options.skip_zero))


@inner
def _moved(value, g, first, second, adam):
    """Value and moments after a step; of one number or of eight."""
    m = adam.beta1 * first + (np.float32(1.0) - adam.beta1) * g
    v = adam.beta2 * second + (np.float32(1.0) - adam.beta2) * (g * g)
    moved = value - adam.rate * m / (square_root(v) * adam.root + adam.epsilon)
    if not adam.skip_zero:
        return moved, m, v
    still = g == np.float32(0.0)
    return select(still, value, moved), select(still, first, m), select(still, second, v)


@inner
def adam_sweep(learned, start, count, gradient, adam):
    """Steps values ``start`` to ``start + count`` along ``gradient[:count]``, and zeroes that."""
    value, first, second, mean = learned
    keep, add = adam.mean_decay, np.float32(1.0) - adam.mean_decay
    whole = count // LANES * LANES
    for i in range(0, whole, LANES):
        at = start + i
        moved, m, v = _moved(load8(value, at), load8(gradient, i), load8(first, at), load8(second, at), adam)
        store8(value, at, moved)
        store8(first, at, m)
        store8(second, at, v)
        if keep > 0.0:
            store8(mean, at, keep * load8(mean, at) + add * moved)
        store8(gradient, i, splat8(0.0))
    for i in range(whole, count):
        at = start + i
        value[at], first[at], second[at] = _moved(value[at], gradient[i], first[at], second[at], adam)
        if keep > 0.0:
            mean[at] = keep * mean[at] + add * value[at]
        gradient[i] = 0.0
