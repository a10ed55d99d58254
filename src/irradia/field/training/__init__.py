"""Training of fields: samples in, events and a field out.

:func:`~irradia.field.training.trainer.train` is the way in; the command line and the studio show its
events, each in its own way.
"""

from irradia.field.training.events import (
    Finished,
    Remark,
    Saved,
    Stepped,
    SteppedBack,
    TrainEvent,
    Validated,
    Working,
)
from irradia.field.training.figures import Figures
from irradia.field.training.options import DataOptions, TrainOptions
from irradia.field.training.trainer import TrainContext, train

__all__ = [
    "DataOptions",
    "Figures",
    "Finished",
    "Remark",
    "Saved",
    "Stepped",
    "SteppedBack",
    "TrainContext",
    "TrainEvent",
    "TrainOptions",
    "Validated",
    "Working",
    "train",
]
