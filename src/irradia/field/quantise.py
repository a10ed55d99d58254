"""Makes a trained field small: its tables in 8 or 4 bits, and the rest taught to live with that.

In rounds of a few steps each, tables learn from where rounding put them. What they learnt is added to the
values before rounding, so that small changes add up until a code moves: a straight-through estimator (Bengio
et al. 2013) that looks at the codes once a round. Then the tables are frozen, and the perceptron alone goes
on. Its numbers end as half floats.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from irradia.core.errors import InputError
from irradia.core.progress import Progress, Stage, silent_progress
from irradia.core.rng import Seed
from irradia.field.backend import Backend, LossName, Parameters, Rates, StepOptions
from irradia.field.backends import backend as find_backend
from irradia.field.field import Field
from irradia.field.quantised import Bits, QuantisedField, QuantisedTensor, quantise
from irradia.field.spec import FieldFrame
from irradia.field.tensors import encoding_tensors, from_tensors, to_halves, to_tensors
from irradia.field.training.batches import MemorySource
from irradia.field.training.rows import HeldOut, Rows, check_fit, pack, spread
from irradia.field.training.start import inference_parameters, state_of
from irradia.formats.samples import SampleFile

MAX_ROWS = 1 << 22
_LEFT = 0.01  # of learning rates, at the end
# Values of an untouched entry of a hash grid are smaller than this, for they begin there: they become 0.
UNTOUCHED = 1e-4


@dataclass(frozen=True)
class FinishOptions:
    """How a field is taught.

    Attributes:
        block: Values that share a scale; 0 gives each level or plane one.
        rounds: In which tables learn; 0 only rounds them.
        round_steps: Of each.
        steps: With frozen tables.
        batch_size: Samples a step.
        loss: See :mod:`irradia.field.losses`.
        lr_encoding, lr_network: Learning rates; they fall exponentially to a hundredth over all steps.
        average: Decay of the running mean that the perceptron is taken from.
        seed: Root of all randomness.
    """

    block: int = 0
    rounds: int = 20
    round_steps: int = 10
    steps: int = 300
    batch_size: int = 65_536
    loss: LossName = "relative_l2"
    lr_encoding: float = 1e-3
    lr_network: float = 1e-3
    average: float = 0.99
    seed: int = 0

    def __post_init__(self) -> None:
        counts = (self.block, self.rounds, self.steps, self.round_steps - 1, self.batch_size - 1)
        if min(counts) < 0:
            raise InputError(f"expected counts of at least 0, of steps and samples at least 1, found {self}")


def round_tables(field: Field, bits: Bits, block: int = 0) -> QuantisedField:
    """Rounds tables to codes, and everything else to halves, without any learning.

    Args:
        field: With or without tables.
        bits: Of a code, 4 or 8.
        block: As in :class:`FinishOptions`.
    """
    tensors = to_tensors(field.spec, field.parameters)
    coded: dict[str, QuantisedTensor] = {}
    for name in encoding_tensors(field.spec):
        values = np.where(np.abs(tensors[name]) > UNTOUCHED, tensors[name], np.float32(0.0))
        coded[name] = quantise(values, bits, block or _whole(values))
        tensors[name] = coded[name].values()
    for name in tensors.keys() - coded.keys():
        tensors[name] = to_halves(tensors[name], name).astype(np.float32)
    parameters = from_tensors(field.spec, tensors)
    return QuantisedField(replace(field, parameters=parameters), coded)


def finish(
    field: Field,
    bits: Bits,
    samples: SampleFile,
    options: FinishOptions | None = None,
    *,
    kept_back: HeldOut | None = None,
    backend: Backend | str = "auto",
    progress: Progress | None = None,
) -> QuantisedField:
    """Rounds a trained field and lets it learn with what is left.

    The same field, samples and options give the same codes.

    Args:
        field: Trained.
        bits: Of a code, 4 or 8.
        samples: That it was trained from.
        options: How.
        kept_back: What training didn't see, so that it still may judge.
        backend: Computes it, or its name.
        progress: Shows how far it is.

    Raises:
        InputError: The samples aren't the field's, or all of them are kept back.
    """
    options = options or FinishOptions()
    check_fit(samples, field.spec)
    computing = find_backend(backend, field.spec) if isinstance(backend, str) else backend
    tables = frozenset(field.spec.parameter_shapes()) & {"position", "direction"}
    rounds = options.rounds if tables else 0
    total = rounds * options.round_steps + options.steps
    with (progress or silent_progress()).stage(f"Finish in {bits} bits", total, "steps") as stage:
        school = _School(field, _rows(samples, kept_back, field.frame), options, computing, stage, total)
        exact = field.parameters
        for _ in range(rounds):
            rounded = round_tables(replace(field, parameters=exact), bits, options.block).field.parameters
            learnt = school.teach(rounded, options.round_steps, average=0.0)
            exact = {
                name: np.add(exact[name], values - rounded[name]) if name in tables else values
                for name, values in learnt.items()
            }
        coded = round_tables(replace(field, parameters=exact), bits, options.block)
        if options.steps:
            start = {**coded.field.parameters, **_network(exact)}
            learnt = school.teach(start, options.steps, average=options.average, frozen=tables)
            coded = _with_network(coded, learnt)
    return coded


def train_on(
    field: Field,
    samples: SampleFile,
    options: FinishOptions | None = None,
    *,
    backend: Backend | str = "auto",
    progress: Progress | None = None,
) -> Field:
    """The lessons of :func:`finish` without the rounding: what is between both is what few bits cost.

    Arguments are those of :func:`finish`.
    """
    options = options or FinishOptions()
    check_fit(samples, field.spec)
    computing = find_backend(backend, field.spec) if isinstance(backend, str) else backend
    tables = frozenset(field.spec.parameter_shapes()) & {"position", "direction"}
    together = options.rounds * options.round_steps if tables else 0
    total = together + options.steps
    with (progress or silent_progress()).stage("Train on", total, "steps") as stage:
        school = _School(field, _rows(samples, None, field.frame), options, computing, stage, total)
        learnt = school.teach(field.parameters, together, average=0.0) if together else field.parameters
        if options.steps:
            learnt = school.teach(learnt, options.steps, average=options.average, frozen=tables)
    return replace(field, parameters={**field.parameters, **learnt})


def _whole(values: NDArray[np.float32]) -> int:
    """Values of a level (entries, features), or of one of several planes (plane, row, column, feature)."""
    return values[0].size if values.ndim > 2 else values.size


def _rows(samples: SampleFile, kept_back: HeldOut | None, frame: FieldFrame) -> Rows:
    """Up to MAX_ROWS samples, evenly picked, in the field's units."""
    number = spread(len(samples), MAX_ROWS)
    rows = np.array(samples.rows[number])
    if kept_back is not None:
        rows = rows[kept_back.learned(number, rows[:, :3])]
    if not len(rows):
        raise InputError("no sample is left to learn from", where=str(samples.path))
    return Rows(pack(rows, samples.info.n_values, frame), samples.info.has_normals)


class _School:
    """Batches and learning rates of one finishing, and Adam's moments from lesson to lesson."""

    def __init__(
        self, field: Field, rows: Rows, options: FinishOptions, backend: Backend, stage: Stage, total: int
    ) -> None:
        self._source, self._spec, self._options = MemorySource(rows), field.spec, options
        self._backend, self._stage, self._total = backend, stage, total
        self._seed = Seed(options.seed).child("finish")
        self._state = state_of(field.parameters, StepOptions(average=0.0))

    def teach(
        self, parameters: Parameters, steps: int, *, average: float, frozen: frozenset[str] = frozenset()
    ) -> Parameters:
        """What parameters become in so many steps; with ``average`` above 0, their running mean."""
        how = StepOptions(self._options.loss, average=average, frozen=frozen)
        before = self._state.step
        start = state_of(parameters, how)
        moments = {"first": self._state.first, "second": self._state.second}
        stepper = self._backend.stepper(self._spec, replace(start, step=before, **moments), how)
        for step in range(before, before + steps):
            batch = self._source.batch(step, self._options.batch_size, self._seed)
            stepper.step(batch, self._rates(step))
            self._stage.advance()
        self._state = stepper.state()
        # The mean is as old as this lesson.
        return inference_parameters(replace(self._state, step=steps), how)

    def _rates(self, step: int) -> Rates:
        left = _LEFT ** (step / self._total)
        return Rates(self._options.lr_encoding * left, self._options.lr_network * left)


def _network(parameters: Parameters) -> Parameters:
    return {name: values for name, values in parameters.items() if name.startswith("mlp.")}


def _with_network(coded: QuantisedField, learnt: Parameters) -> QuantisedField:
    """The same codes behind another perceptron, rounded to halves."""
    halves = {name: to_halves(values, name).astype(np.float32) for name, values in _network(learnt).items()}
    parameters = {**coded.field.parameters, **halves}
    return replace(coded, field=replace(coded.field, parameters=parameters))
