"""Adam and the running mean of parameters, as every backend computes them."""

from __future__ import annotations

import numpy as np

from irradia.field.backend import AdamOptions
from irradia.field.encoding import Array


def adam(
    value: Array, gradient: Array, first: Array, second: Array, step: int, rate: float, options: AdamOptions
) -> tuple[Array, Array, Array]:
    """One step of Adam (Kingma and Ba 2015, algorithm 1).

    With ``skip_zero`` a value without gradient keeps its moments, while the bias correction goes by the
    steps of all: tiny-cuda-nn instead counts the steps of each value, for 4 bytes more.

    Args:
        value: One array of parameters.
        gradient: Of the loss with respect to it.
        first: Running mean of gradients.
        second: Running mean of their squares.
        step: This one, from 1.
        rate: Learning rate.
        options: Decays and the like.

    Returns:
        The new value and moments.
    """
    new_first = options.beta1 * first + (1.0 - options.beta1) * gradient
    new_second = options.beta2 * second + (1.0 - options.beta2) * gradient * gradient
    first_unbiased = new_first / (1.0 - options.beta1**step)
    second_unbiased = new_second / (1.0 - options.beta2**step)
    new_value = value - rate * first_unbiased / (np.sqrt(second_unbiased) + options.epsilon)
    if not options.skip_zero:
        return new_value, new_first, new_second
    still = gradient == 0.0
    return (
        np.where(still, value, new_value),
        np.where(still, first, new_first),
        np.where(still, second, new_second),
    )


def running_mean(mean: Array, value: Array, decay: float) -> Array:
    """The mean with one more value in it; it starts from 0 and is biased toward it.

    :func:`irradia.field.training.start.inference_parameters` takes the bias away.
    """
    return decay * mean + (1.0 - decay) * value
