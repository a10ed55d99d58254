"""What one may choose about a training, with the defaults of the Unity project's trainer."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Any

from irradia.core.errors import InputError
from irradia.field.backend import AdamOptions, LossName, StepOptions

DEFAULT_STEPS = 5000


@dataclass(frozen=True)
class DataOptions:
    """How samples become batches.

    Attributes:
        jitter_copies: Displaced copies of each sample; see :mod:`irradia.field.training.jitter`.
        jitter_radius_m: How far they may lie from it.
        smooth_k: Values become means over so many nearest samples; 0 leaves them.
        smooth_normal_threshold: Neighbours count where the cosine between normals is above this.
        hold_out_blocks: Share of the box, in cells, that training never sees.
        memory_bytes: Samples kept in memory; a larger file is read in shuffled windows.
    """

    jitter_copies: int = 0
    jitter_radius_m: float = 0.05
    smooth_k: int = 0
    smooth_normal_threshold: float = 0.5
    hold_out_blocks: float = 0.0
    memory_bytes: int = 1 << 30

    def __post_init__(self) -> None:
        copies, radius_m, threshold = self.jitter_copies, self.jitter_radius_m, self.smooth_normal_threshold
        _expect(0 <= copies <= 64, "0 to 64 copies", copies, "--jitter-copies")
        _expect(0.0 < radius_m < math.inf, "a radius over 0", radius_m, "--jitter-radius")
        _expect(0 <= self.smooth_k <= 256, "0 to 256 neighbours", self.smooth_k, "--smooth-k")
        _expect(-1.0 <= threshold <= 1.0, "a cosine of -1 to 1", threshold, "--smooth-normal-thresh")
        share = self.hold_out_blocks
        _expect(0.0 <= share <= 0.5, "a share of 0 to 0.5", share, "--hold-out-blocks")
        _expect(self.memory_bytes > 0, "memory for samples", self.memory_bytes, "--memory")


@dataclass(frozen=True)
class TrainOptions:
    """A training's course.

    Attributes:
        steps: Batches to learn from; None trains until the time is up.
        time_s: Seconds for steps and validations; preparing and compiling don't count. With ``steps``
            too, whichever is reached first.
        batch_size: Samples a step.
        loss: See :mod:`irradia.field.losses`.
        lr_encoding, lr_network: Learning rates at the start.
        lr_final: Share of them that is left at the end; they fall exponentially.
        average: Decay of the running mean of parameters that inference takes; 0 takes them as they are.
        validate_every: Steps between validations; None makes about twenty.
        early_stop: Validations without a better relMSE after which training ends; None never does.
        checkpoint_s: Seconds between checkpoints.
        frozen: Names of parameters that don't learn.
        data: How samples become batches.
        seed: Root of all randomness.
    """

    steps: int | None = DEFAULT_STEPS
    time_s: float | None = None
    batch_size: int = 65_536
    loss: LossName = "relative_l2"
    lr_encoding: float = 0.01
    lr_network: float = 0.001
    lr_final: float = 0.1
    average: float = 0.99
    validate_every: int | None = None
    early_stop: int | None = None
    checkpoint_s: float = 60.0
    frozen: frozenset[str] = frozenset()
    data: DataOptions = field(default_factory=DataOptions)
    seed: int = 0

    def __post_init__(self) -> None:
        steps, time_s = self.steps, self.time_s
        _expect(steps is not None or time_s is not None, "a number of steps or a time", None, "--steps")
        _expect(time_s is None or 0.0 < time_s < math.inf, "a time over 0 s", time_s, "--time")
        for count, where in (
            (steps, "--steps"),
            (self.batch_size, "--batch-size"),
            (self.validate_every, "--validate-every"),
            (self.early_stop, "--early-stop"),
        ):
            _expect(count is None or count >= 1, "at least 1", count, where)
        for rate, where in ((self.lr_encoding, "--lr-encoding"), (self.lr_network, "--lr-network")):
            _expect(0.0 <= rate < math.inf, "a rate of at least 0", rate, where)
        _expect(0.0 < self.lr_final <= 1.0, "a share over 0, up to 1", self.lr_final, "--lr-final")
        _expect(0.0 <= self.average < 1.0, "a decay from 0 to below 1", self.average, "--average")

    def step_options(self) -> StepOptions:
        """What backends need of this."""
        adam = AdamOptions(epsilon=1e-15, skip_zero=True)
        return StepOptions(self.loss, adam, AdamOptions(), self.average, self.frozen)

    def identity(self) -> dict[str, Any]:
        """What must be the same for a stopped training to go on, as plain values.

        How often one looks and saves doesn't matter, and where data lies isn't known here.
        """
        plain = {name: value for name, value in vars(self).items() if name not in _NO_PART_OF_RESULT}
        return {**plain, "frozen": sorted(self.frozen), "data": vars(self.data)}


_NO_PART_OF_RESULT = ("checkpoint_s",)


def _expect(holds: bool, wanted: str, found: object, where: str) -> None:
    if not holds:
        raise InputError(f"expected {wanted}, found {found}", where=where)
