"""Adam and the running mean in one kernel; :mod:`irradia.field.adam` says what they compute."""

from __future__ import annotations

from dataclasses import dataclass
from types import ModuleType

import drjit as dr

from irradia.field.backend import AdamOptions
from irradia.field.backends.drjit_tiles import F

Learned = list[F]  # value, first and second moment, and the running mean if one is kept


@dataclass
class StepScalars:
    """What changes from step to step, each one value.

    Attributes:
        rate: Learning rate / (1 − β1^step).
        root: √(1 / (1 − β2^step)).
    """

    rate: F
    root: F


def scalars_of(jit: ModuleType, options: AdamOptions, step: int, rate: float) -> StepScalars:
    """For a step, counted from 1."""
    return StepScalars(
        dr.opaque(jit.Float, rate / (1.0 - options.beta1**step)),
        dr.opaque(jit.Float, (1.0 - options.beta2**step) ** -0.5),
    )


def adam_step(
    learned: Learned,
    gradient: F,
    scalars: StepScalars,
    options: AdamOptions,
    average: float,
    learns: F | None = None,
) -> Learned:
    """Parameters, moments and running mean after a step.

    Args:
        learned: Before it.
        gradient: Of the loss.
        scalars: Of the step.
        options: Of Adam.
        average: Decay of the running mean.
        learns: 0 where a value is frozen; None where none is.
    """
    value, first, second = learned[:3]
    new_first = options.beta1 * first + (1.0 - options.beta1) * gradient
    new_second = options.beta2 * second + (1.0 - options.beta2) * (gradient * gradient)
    moved = scalars.rate * new_first / (dr.sqrt(new_second) * scalars.root + options.epsilon)
    after = [value - moved, new_first, new_second]
    if options.skip_zero:
        still = gradient == 0.0
        after = [dr.select(still, old, new) for old, new in zip(learned[:3], after, strict=True)]
    if len(learned) > 3:
        after.append(average * learned[3] + (1.0 - average) * after[0])
    if learns is not None:
        after = [dr.select(learns > 0.0, new, old) for old, new in zip(learned, after, strict=True)]
    return after
