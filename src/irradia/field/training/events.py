"""What a training tells while it runs, for a command line, a studio or a log to show."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from irradia.field.backend import Parameters
from irradia.field.spec import FieldFrame, FieldSpec
from irradia.field.training.figures import Figures, Judge

Why = Literal["steps", "time", "early stop", "stopped"]


@dataclass(frozen=True)
class Working:
    """A stage before the first step: reading, smoothing, compiling.

    Attributes:
        stage: Its name; the next name, or the first step, ends it.
        done, total: In ``unit``; a total of 0 is not known.
        unit: As shown behind a rate.
    """

    stage: str
    done: float = 0.0
    total: float = 0.0
    unit: str = ""


@dataclass(frozen=True)
class Remark:
    """Something that the user should know, in words."""

    text: str


@dataclass(frozen=True)
class Stepped:
    """A step was done.

    Attributes:
        step: How many there have been.
        loss: Of its batch, before it.
        progress: Of the training, 0 to 1.
        spent_s: Seconds of training so far, those before an interruption too.
        samples: Seen so far.
        samples_per_s: Of the steps since this process began, without validations.
    """

    step: int
    loss: float
    progress: float
    spent_s: float
    samples: int
    samples_per_s: float


@dataclass(frozen=True)
class Validated:
    """The mean parameters were judged.

    Attributes:
        step: After how many.
        figures: On the validation samples.
    """

    step: int
    figures: Figures


@dataclass(frozen=True)
class SteppedBack:
    """The loss or a parameter was no number: the training went back and halved its rates.

    Attributes:
        step: Where it happened.
        to_step: Of the last good state.
        rate_factor: What is left of the learning rates.
    """

    step: int
    to_step: int
    rate_factor: float


@dataclass(frozen=True)
class Saved:
    """A checkpoint was written after ``step``."""

    step: int


@dataclass(frozen=True)
class Judges:
    """Samples that a training is judged by.

    Attributes:
        validation: Drawn apart from those trained on, or single rows that were held out.
        blocks: In blocks of space that were held out; None where none were.
    """

    validation: Judge
    blocks: Judge | None


@dataclass(frozen=True)
class Finished:
    """The last event.

    Attributes:
        why: What ended it; ``stopped`` was asked for and may go on.
        spec, frame: Of the field.
        parameters: For inference: the de-biased running mean.
        step: Steps done.
        loss: Mean over the last hundred steps at most.
        figures: On the validation samples.
        held_out: On the blocks of space that were held out; None where none were.
        spent_s: Seconds of training.
        samples_per_s: Of this process's steps.
        n_samples: Rows that could be drawn at the end.
        n_setbacks: How often it went back.
        judges: Who gave the figures, to judge what is made of the field next.
    """

    why: Why
    spec: FieldSpec
    frame: FieldFrame
    parameters: Parameters
    step: int
    loss: float
    figures: Figures
    held_out: Figures | None
    spent_s: float
    samples_per_s: float
    n_samples: int
    n_setbacks: int
    judges: Judges


TrainEvent = Working | Remark | Stepped | Validated | SteppedBack | Saved | Finished
