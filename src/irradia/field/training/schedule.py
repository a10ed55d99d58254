"""Learning rates over a training."""

from __future__ import annotations

from irradia.field.backend import Rates
from irradia.field.training.options import TrainOptions


def progress(options: TrainOptions, step: int, spent_s: float) -> float:
    """How much of a training is done, 0 to 1, by steps or time, whichever is further."""
    by_steps = step / options.steps if options.steps is not None else 0.0
    by_time = spent_s / options.time_s if options.time_s is not None else 0.0
    return min(max(by_steps, by_time), 1.0)


def rates(options: TrainOptions, done: float, factor: float = 1.0) -> Rates:
    """Rates that fall exponentially from those of the start to ``lr_final`` of them.

    Args:
        options: Of the training.
        done: Its :func:`progress`.
        factor: What setbacks have left of the rates.
    """
    left = factor * options.lr_final**done
    return Rates(options.lr_encoding * left, options.lr_network * left)
