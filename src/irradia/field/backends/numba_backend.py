"""Fields on the CPU by fused Numba kernels.

A step goes over the batch three times: encodings write features; the perceptron runs forward and backward on
one tile after another, and leaves the features' gradient in their place; encodings scatter that into their
parameters, and Adam sweeps them. Kernels run on threads of their own (see numba_team.py), so they neither use
nor disturb Numba's threading layer. A stepper or evaluator serves one caller at a time.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from irradia.core.errors import InputError
from irradia.field.backend import (
    F32,
    Backend,
    Batch,
    Evaluator,
    Parameters,
    Rates,
    StepOptions,
    Stepper,
    TrainState,
)
from irradia.field.backends.numba_adam import Learned, adam_of_step
from irradia.field.backends.numba_encoding import (
    STRIDE,
    TILE,
    NumbaEncoding,
    accelerate,
    lacks_acceleration,
)
from irradia.field.backends.numba_functions import LOSSES
from irradia.field.backends.numba_network import (
    make_network,
    make_scratch,
    make_totals,
    pack,
    unpack,
    whole_blocks,
)
from irradia.field.backends.numba_perceptron import infer, train, update_network
from irradia.field.backends.numba_team import Team
from irradia.field.checks import check_options, check_parameters
from irradia.field.spec import FieldSpec

_CHUNK = 256  # tiles that inference takes at once


class NumbaBackend(Backend):
    """See the module.

    Attributes:
        team: The threads of everything that this backend makes.
    """

    name: ClassVar[str] = "numba"

    def __init__(self, threads: int | None = None) -> None:
        self.team = Team(threads)

    def lacks(self, spec: FieldSpec) -> str | None:
        """What of a spec has no kernel."""
        encodings = (spec.position, spec.direction)
        missing = (lacks_acceleration(encoding) for encoding in encodings if encoding is not None)
        return next((what for what in missing if what), None)

    def evaluator(self, spec: FieldSpec, parameters: Parameters) -> NumbaEvaluator:
        """Makes ready to evaluate; the parameters are copied."""
        check_parameters(spec, parameters)
        return NumbaEvaluator(spec, parameters, self.team)

    def stepper(self, spec: FieldSpec, state: TrainState, options: StepOptions) -> NumbaStepper:
        """Makes ready to train; the state is copied."""
        check_options(spec, options)
        check_parameters(spec, state.parameters)
        return NumbaStepper(spec, state, options, self.team)


@dataclass(frozen=True)
class _Placed:
    """An encoding and where its features stand.

    Attributes:
        name: Among the parameters: ``position`` or ``direction``.
        fast: Its kernels.
        row: Its first.
        from_cube: Whether normals have to be brought into [0, 1]³.
    """

    name: str
    fast: NumbaEncoding[Any]
    row: int
    from_cube: bool


class _Features:
    """Encodes batches into tiles, in memory that it keeps."""

    def __init__(self, spec: FieldSpec, team: Team) -> None:
        self.placed = [_Placed("position", accelerate(spec.position, team), 0, from_cube=False)]
        if spec.direction is not None:
            in_cube = spec.direction.domain == "cube"
            fast = accelerate(spec.direction, team)
            self.placed.append(_Placed("direction", fast, spec.position.n_outputs, in_cube))
        self._n_rows = whole_blocks(spec.n_inputs)
        self.tiles = np.zeros((0, self._n_rows, STRIDE), np.float32)
        self.points: dict[str, F32] = {}

    def encode(self, x: F32, normal: F32 | None, parameters: Parameters) -> F32:
        """Features (n_tiles, rows, 272) of points (N, 3) and normals; valid until the next call."""
        n_tiles = -(-len(x) // TILE)
        if len(self.tiles) != n_tiles:
            self.tiles = np.zeros((n_tiles, self._n_rows, STRIDE), np.float32)
            self.points = {each.name: np.zeros((3, n_tiles * TILE), np.float32) for each in self.placed}
        for each in self.placed:
            points = self.points[each.name]
            values = x if each.name == "position" else normal
            if values is None:
                raise InputError("a field of irradiance is asked under normals, and there are none")
            points[:, : len(x)] = values.T
            points[:, len(x) :] = values[-1:].T
            if each.from_cube:
                points *= np.float32(0.5)
                points += np.float32(0.5)
            own = parameters.get(each.name, _NONE)
            each.fast.forward(points, own, self.tiles, each.row)
        return self.tiles


_NONE = np.zeros(0, np.float32)


class NumbaEvaluator(Evaluator):
    """A network that only runs forward."""

    def __init__(self, spec: FieldSpec, parameters: Parameters, team: Team) -> None:
        self._spec, self._team = spec, team
        self._parameters = {
            name: np.array(values, np.float32)
            for name, values in parameters.items()
            if not name.startswith("mlp.")
        }
        self._network = make_network(spec, *pack(spec, parameters))
        self._scratch = make_scratch(spec, team.n_threads, training=False)
        self._features = _Features(spec, team)

    def __call__(self, x: F32, normal: F32 | None) -> F32:
        """See the base class."""
        outputs = np.empty((len(x), self._spec.n_outputs), np.float32)
        for first in range(0, len(x), _CHUNK * TILE):
            some = slice(first, first + _CHUNK * TILE)
            normals = None if normal is None else normal[some]
            features = self._features.encode(x[some], normals, self._parameters)
            self._team.run(infer, self._network, features, self._scratch, first, outputs)
        return outputs


class NumbaStepper(Stepper):
    """A training in progress."""

    def __init__(self, spec: FieldSpec, state: TrainState, options: StepOptions, team: Team) -> None:
        self._spec, self._options, self._team = spec, options, team
        self._step = state.step
        self._features = _Features(spec, team)
        placed = self._features.placed
        self._encodings = {p.name: _copied(state, p.name) for p in placed if p.name in state.parameters}
        groups = (state.parameters, state.first, state.second)
        packed = [pack(spec, group) for group in groups]
        packed.append(pack(spec, state.average) if options.average else (_NONE, _NONE))
        self._matrices = Learned(*(matrices for matrices, _ in packed))
        self._biases = Learned(*(biases for _, biases in packed))
        self._network = make_network(spec, self._matrices.value, self._biases.value)
        self._scratch = make_scratch(spec, team.n_threads, training=True)
        self._totals = make_totals(spec)
        frozen = options.frozen
        layers = range(spec.n_hidden_layers + 1)
        self._learns = np.array(
            [[f"mlp.{i}.{kind}" not in frozen for kind in ("weight", "bias")] for i in layers], np.bool_
        )
        n_layers, side, _ = self._network.matrices.shape
        self._gradients = np.zeros((n_layers, side + 1, side), np.float32)
        self._learning = [
            each for each in self._features.placed if each.name in self._encodings and each.name not in frozen
        ]
        self._n_gradients = max(
            (each.row + each.fast.encoding.n_outputs for each in self._learning), default=0
        )

    def step(self, batch: Batch, rates: Rates) -> float:
        """See the base class."""
        self._step += 1
        own = {name: learned.value for name, learned in self._encodings.items()}
        features = self._features.encode(batch.x, batch.normal, own)
        self._network.transposed[:] = self._network.matrices.transpose(0, 2, 1)
        # Any other kind of array, such as a map of a file, would have the kernel compiled anew.
        target = np.require(batch.target, np.float32, ["C", "A", "W", "E"])
        loss = LOSSES.index(self._options.loss)
        self._team.run(
            train,
            self._network,
            features,
            self._n_gradients,
            target,
            loss,
            self._scratch,
            self._totals,
        )
        options = self._options
        adam = adam_of_step(options.encoding_adam, self._step, rates.encoding, options.average)
        for each in self._learning:
            points = self._features.points[each.name]
            each.fast.learn(points, features, each.row, self._encodings[each.name], adam)
        self._update_network(rates.network)
        return float(self._totals.loss.sum()) / batch.target.size

    def state(self) -> TrainState:
        """See the base class."""
        kept = (Learned._fields.index(name) for name in ("value", "first", "second"))
        value, first, second = (self._collect(i) for i in kept)
        average = self._collect(Learned._fields.index("mean")) if self._options.average else {}
        return TrainState(value, average, first, second, self._step)

    def _update_network(self, rate: float) -> None:
        options = self._options
        adam = adam_of_step(options.network_adam, self._step, rate, options.average)
        flat = (Learned(*(array.reshape(-1) for array in each)) for each in (self._matrices, self._biases))
        self._team.run(
            update_network, self._network, self._totals, *flat, self._learns, self._gradients, adam
        )

    def _collect(self, kind: int) -> Parameters:
        """One kind of arrays, such as first moments, by the names of parameters."""
        found = {name: learned[kind].copy() for name, learned in self._encodings.items()}
        return found | unpack(self._spec, self._matrices[kind], self._biases[kind])


def _copied(state: TrainState, name: str) -> Learned:
    groups = (state.parameters, state.first, state.second, state.average)
    return Learned(*(np.array(group.get(name, _NONE), np.float32) for group in groups))
